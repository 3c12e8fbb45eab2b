# SPDX-License-Identifier: BSD-3-Clause
"""Stem of a pneumatic actuator behind its positioner: one scan along time, compiled."""

from math import exp, sqrt

import numba as nb
import numpy as np

from sklvalve.simulation.nozzles import supply_nozzle, vent_nozzle

# of the pressure's change, and in time: what a step may leave to the straight lines drawn through it
_LARGEST_CHANGE, _LONGEST, _STEP_OF_SLIPPING = 0.01, 2.0, 0.04
# what a stem has gone beyond a share of its bristles' bend is a slip, over in milliseconds
_FREED, _SLIP_TIME = 0.3, 0.005
# longest step while the positioner feels the stem elsewhere [lags], and the distance that hardly counts
_OFTEN, _HARDLY = 1.0, 0.003
_BRISTLE, _STRIBECK, _VISCOUS, _DEAD_VOLUME = 60.0, 0.03, 0.005, 5.0


@nb.njit(cache=True, inline="always")
def _beyond(value, band):
    return value - min(max(value, -band), band)


@nb.njit(cache=True, inline="always")
def _displacement(push, tight, held, stiff):
    # d where  push = tight d + held (1 - exp(-stiff d)); and what of `held` is left there, as a share.
    # Begun where a bristle that fades as 1 / (1 + u) would come to rest, two or three Newton steps suffice.
    steep = held * stiff
    b = push * stiff - tight - steep
    c = tight * stiff
    root = sqrt(b * b + 4.0 * c * push)
    d = 2.0 * push / (root - b) if b < 0.0 else 0.5 * (b + root) / c
    fade = 1.0
    for _ in range(4):
        fade = exp(-stiff * d)
        off = (push - tight * d - held * (1.0 - fade)) / (tight + steep * fade)
        d += off
        off *= stiff
        fade *= 1.0 - off + 0.5 * off * off
        if abs(off) < 3e-3:
            break
    return d, fade


# no check for division by zero in the innermost loop: no divisor there can be zero
@nb.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def positioner_and_actuator(
    command, step, x0, spring, atmosphere, supply, coulomb, extra_stick, dead_band, faults, filter_time, gain,
    reset, rate, feedback, vent, lag=0.0,
):  # fmt: skip
    r"""Stem of a spring-loaded diaphragm actuator behind a positioner, driven by the command.

    All in travels: a pressure of one carries the spring over one travel. The positioner opens a spool by the
    error, by its integral (`reset`), and, by `feedback`, by how far the pressure is from the one that carries
    the spring to the command: so it holds a stuck stem with a pressure in proportion to the error; without,
    pressure builds up until the stem comes loose. The spool fills the chamber or vents it, by nozzles that
    choke; the stem moves where pressure, spring and bristle friction with a Stribeck fall balance.

    .. math::

        \dot m = c\, s\, p_s \psi(p / p_s) \;\text{or}\; c\, s\, p\, \psi(p_a / p), \quad m = p (V_0 + x)

        p - p_0 - x = \sigma z + b \dot x, \quad \dot z = \dot x - |\dot x| \sigma z / F(\dot x)

    What the positioner feels of the stem passes a lag, :math:`\tau \dot x' = x - x'`: relays and converters
    take their time, so a quick stem goes beyond where it is sent, and one that rubs stays there.

    Parameters
    ----------
    command : ndarray of shape (n,)
        Wanted opening [1]. A gap (NaN) holds the value before it.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    x0 : float
        Opening at the beginning [1].
    spring, atmosphere : float
        Absolute pressure at which the spring begins to give way, and that of the air [travels of spring].
    supply, coulomb, extra_stick, dead_band : ndarray of shape (n,)
        Absolute supply pressure; sliding friction; how far friction at rest exceeds it [all in travels of
        spring]; half width of the positioner's dead band [1].
    faults : ndarray of shape (n, 10), or (0, 10) in a sound actuator
        Columns as `sklvalve.simulation.faults.FAULTS` has them.
    filter_time, gain, reset, rate, feedback, vent, lag : float
        Time constant of the input [s], spool opening for an error [1], spool for the error's integral [1/s],
        capacity of the spool that fills [1/s], the error that a pressure of one counts for [1], the capacity
        of the spool that vents, as a multiple of `rate` [1], and the time constant of the lag [s].

    Returns
    -------
    opening : ndarray of shape (n,)
        Position of the stem [1].

    Notes
    -----
    One equation a step for how far the stem goes, implicit in pressure and error, weighted between trapezoid
    (short steps) and backward Euler (long ones), so that a fast positioner settles and does not ring. Steps
    are as long as the pressure's rate allows; their length follows the state without jumps, so the opening
    is smooth in every parameter. Where a stem hunts it is not, for hunting is chaotic.
    """
    n = len(command)
    out = np.empty(n)
    faulty = len(faults) > 0
    per_filter_time = 1.0 / max(filter_time, 1e-6)
    per_lag = 1.0 / max(lag, 1e-6)
    x = min(max(x0, 0.0), 1.0)
    wanted = command[0]
    if wanted != wanted:
        wanted = x
    target = wanted
    # a stem that stands at its end of travel may be pressed against it by any pressure
    mass = (x + spring) * (_DEAD_VOLUME + x)
    lever = x
    bristle, capacity = _BRISTLE, rate
    integral, bend, speed = 0.0, 0.0, 0.0
    known, eased, old, drag = -1.0, 0.0, 0.0, 0.0
    felt, caught, followed = x, 1.0, 1.0
    for k in range(n):
        if command[k] == command[k]:
            target = command[k]
        # whatever happened before the last 40 s has settled
        remaining = min(step[k], 40.0)
        ps, stick, band = supply[k], extra_stick[k], dead_band[k]
        slide = max(coulomb[k], 1e-4)
        limit, ground = slide + stick, slide
        softening, hardening, pre, leak, play = 0.0, 0.0, spring, 0.0, 0.0
        if faulty:
            pre = spring + faults[k, 0] + faults[k, 6]
            softening, hardening = faults[k, 1], faults[k, 2]
            leak, play = faults[k, 3], 0.5 * faults[k, 7]
            bristle = faults[k, 8] if faults[k, 8] > 0.0 else _BRISTLE
            capacity = rate * (1.0 + faults[k, 9])
        while remaining > 1e-9:
            volume = 1.0 / (_DEAD_VOLUME + x)
            pressure = mass * volume
            air = pressure * volume
            seen = x
            if play > 0.0:
                lever = min(max(lever, x - play), x + play)
                seen = lever
            if lag <= 0.0:
                felt = seen
            behind = seen - felt
            far, near = target - felt, wanted - felt
            # the air that the positioner's aim asks for, less the air that its gauge shows
            short = feedback * (spring + wanted - pressure)

            # how fast the pressure may change in this step decides on its length
            wish = gain * _beyond(near + short, band) + integral
            filling = wish >= 0.0
            if filling:
                inlet, slope = supply_nozzle(pressure, ps)
            else:
                inlet, slope = vent_nozzle(pressure, atmosphere, vent)
            busy = capacity * min(max(wish, -1.0), 1.0) * inlet
            lost, lost_slope = 0.0, 0.0
            if leak > 0.0:
                lost, lost_slope = vent_nozzle(pressure, atmosphere, leak * capacity)
                busy -= lost
            busy = abs(busy) * volume
            if target != wanted:
                # it will not outrun the filter, which carries pressure and spring along
                wish = gain * _beyond(far + feedback * (spring + target - pressure), band) + integral
                wide = capacity * min(abs(wish), 1.0) * (inlet if (wish >= 0.0) == filling else ps)
                busy = max(busy, min(wide * volume, 2.0 * abs(target - wanted) * per_filter_time))
            h = min(_LONGEST, remaining)
            if stick > 0.0:
                # a stem about to slip is watched closely; it goes on sliding no faster than air drives it
                speed = min(speed, busy)
                limit = slide + stick * exp(-((speed * (1.0 / _STRIBECK)) ** 2))
                margin = 0.5 * (limit - abs(bristle * bend))
                if h * busy > margin:
                    h = min(h, max(_STEP_OF_SLIPPING, margin / busy))
            loose = 0.0
            if play > 0.0:
                # until the stem has taken up the play nothing checks it: it must not go far on its own
                gap = play - (x - lever if filling else lever - x)
                if h * busy > gap:
                    h = min(h, max(0.05, gap / busy))
                loose = min(gap / (h * busy + 1e-9), 1.0)
            if h * busy > _LARGEST_CHANGE:
                h = _LARGEST_CHANGE / busy
            if lag > 0.0:
                # while the positioner feels the stem where it was, it must not be asked too seldom
                h = min(h, lag * (_OFTEN + _HARDLY / (abs(behind) + 1e-9)))
            remaining -= h
            if h != known:
                known = h
                drag = _VISCOUS / h
                q = h * per_filter_time
                eased = 1.0 - exp(-q) if q > 1e-3 else q * (1.0 - 0.5 * q)
                # twice the weight that the filter's beginning has in the step's mean
                old = 2.0 * (1.0 - 1.0 / eased + 1.0 / q) if q > 1e-3 else 1.0
                if lag > 0.0:
                    q = h * per_lag
                    caught = 1.0 - exp(-q) if q > 1e-3 else q * (1.0 - 0.5 * q)
                    # of a way made in this step so much is felt at its end
                    followed = 1.0 - caught / q if q > 1e-3 else 0.5 * q

            moved = eased * (target - wanted)
            spool = (
                gain * _beyond(near + short + 0.6 * ((1.0 + feedback) * moved - caught * behind), band)
                + integral
            )
            if (spool >= 0.0) != filling:
                if filling:
                    inlet, slope = vent_nozzle(pressure, atmosphere, vent)
                else:
                    inlet, slope = supply_nozzle(pressure, ps)
            if faulty:
                ground = slide + max(faults[k, 4] * (x - faults[k, 5]), 0.0)
                limit = ground + stick * exp(-((speed * (1.0 / _STRIBECK)) ** 2))
            stiff = bristle / limit
            tight = 1.0 + air
            force = pressure - pre - x
            if faulty:
                force -= x * (softening + hardening * x * x)
                tight += softening + 3.0 * hardening * x * x
            # friction that a stem at rest has still in hand holds it as a spring does
            hold = tight
            bent = bristle * bend if spool > 0.0 else -bristle * bend
            if bent < limit:
                hold += (limit - bent) * stiff
            y = h * volume * capacity * (inlet * gain * followed + abs(slope * spool) * hold)
            theta = (hold + y) / (2.0 * hold + y)

            there = (1.0 - (1.0 - theta) * old) * moved
            near -= theta * caught * behind
            asked = near + short + (1.0 + feedback) * there
            error = _beyond(near + there, band)
            grip, gauge = (gain + theta * h * reset) * (1.0 - loose) * followed, 0.0
            if abs(asked) > band:
                spool = gain * _beyond(asked, band) + theta * h * reset * error + integral
                if abs(spool) > 1.0:
                    spool = 1.0 if spool > 0.0 else -1.0
                    grip = 0.0
                else:
                    gauge = capacity * inlet * gain * feedback
            else:
                # within its dead band a positioner leaves the air as it is
                grip, spool = 0.0, 0.0
            fall = capacity * abs(slope * spool) + lost_slope + gauge
            share = h / (1.0 + h * theta * fall * volume)
            inflow = (capacity * inlet * spool - lost) * share
            back = theta * (capacity * grip * inlet - fall * air) * share

            left = force - bristle * bend + inflow * volume
            side = 1.0 if left > 0.0 else -1.0
            way = 0.0
            speed = 0.0
            if (x < 1.0) if side > 0.0 else (x > 0.0):
                push = side * left
                through = tight + back * volume + drag
                if faulty and faults[k, 4] * (x - faults[k, 5]) > 0.0:
                    through += max(side * faults[k, 4], 0.0)
                before, first = side * bend, np.inf
                for _slip in range(8):
                    held = limit - bristle * before
                    if held > 0.0:
                        way, fade = _displacement(push, through, held, stiff)
                    elif push > held:
                        # friction has fallen below what the bristles hold
                        way = (push - held) / through
                        fade = exp(-stiff * way)
                    else:
                        break
                    bend = side * (limit - held * fade) / bristle
                    if stick <= 0.0:
                        break
                    # friction falls under way: by the speed at which air drives what bristles hold no more,
                    # and where that frees a way beyond the bristles' own, before the positioner knows
                    fast = max(inflow * volume * side, 0.0) / (h * (through + stiff * max(held, 0.0) * fade))
                    if (way - first) * bristle > _FREED * limit:
                        fast = (way - first) * (1.0 / _SLIP_TIME)
                    first = min(first, way)
                    falling = ground + stick * exp(-((fast * (1.0 / _STRIBECK)) ** 2))
                    if falling > 0.99 * limit:
                        break
                    limit, stiff = falling, bristle / falling
                    through -= back * volume
                    back = 0.0
                x += side * way
                if 0.0 <= x <= 1.0:
                    speed = way / h
                else:
                    end = 1.0 if x > 1.0 else 0.0
                    way -= abs(x - end)
                    x = end
            mass += inflow - side * back * way
            if grip > 0.0:
                error -= side * theta * followed * way
            felt += caught * behind + followed * side * way
            integral = min(max(integral + h * reset * error, -0.2), 0.2)
            wanted += moved
        out[k] = x
    return out
