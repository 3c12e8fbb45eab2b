# SPDX-License-Identifier: BSD-3-Clause
"""One step of a stem in time: positioner, chamber and friction, compiled.

A step asks the positioner how wide its spool is open, the chamber how much air that lets in or out, and
friction how far the stem goes by it.
"""

from math import exp, sqrt
from typing import NamedTuple

import numpy as np

from sklvalve.simulation.nozzles import supply_nozzle, vent_nozzle
from sklvalve.simulation.stem_state import DEAD_VOLUME, Pace, State, compiled

# of the pressure's change, and in time: what a step may leave to the straight lines drawn through it
_LARGEST_CHANGE, _LONGEST, _STEP_OF_SLIPPING = 0.01, 2.0, 0.04
# what a stem has gone beyond a share of its bristles' bend is a slip, over in milliseconds
_FREED, _SLIP_TIME = 0.3, 0.005
# longest step while the positioner feels the stem elsewhere [lags], and the distance that hardly counts
_OFTEN, _HARDLY = 1.0, 0.003
# play that counts as taken up, share of the way left that a stem without play goes, and shortest step [s]
_TAKEN_UP, _OF_THE_WAY_LEFT, _STEP_OF_PLAY = 1e-4, 0.25, 0.05
_STRIBECK, _VISCOUS = 0.03, 0.005
# whatever happened before the last 40 s has settled
_SETTLED = 40.0


class _Seen(NamedTuple):
    """What a positioner goes by: lever, felt stem, its lag; unfiltered and filtered error; air it lacks."""

    lever: float
    felt: float
    behind: float
    far: float
    near: float
    short: float


class _Chamber(NamedTuple):
    """Pressure, what a way of the stem takes from it, one over the volume, and the flow through a leak."""

    pressure: float
    stiffness: float
    per_volume: float
    lost: float
    lost_slope: float


class _Air(NamedTuple):
    """Inflow in a step, and what of it a way of the stem takes back; the positioner's grip and its error."""

    inflow: float
    back: float
    grip: float
    error: float
    theta: float


@compiled
def _beyond(value, band):
    return value - min(max(value, -band), band)


@compiled
def _share(q):
    """Of its way what a lag covers in q of its time constants."""
    return 1.0 - exp(-q) if q > 1e-3 else q * (1.0 - 0.5 * q)


@compiled
def _pace(h, own):
    q = h * own.per_filter_time
    eased = _share(q)
    old = 2.0 * (1.0 - 1.0 / eased + 1.0 / q) if q > 1e-3 else 1.0
    caught, followed = 1.0, 1.0
    if own.lag > 0.0:
        q = h * own.per_lag
        caught = _share(q)
        followed = 1.0 - caught / q if q > 1e-3 else 0.5 * q
    return Pace(h, eased, old, _VISCOUS / h, caught, followed)


@compiled
def _stribeck(speed):
    """Share of the extra friction at rest that is left at a speed."""
    ratio = speed * (1.0 / _STRIBECK)
    return exp(-(ratio * ratio))


@compiled
def _nozzle(filling, pressure, drive, own):
    if filling:
        return supply_nozzle(pressure, drive.supply)
    return vent_nozzle(pressure, own.atmosphere, own.vent)


@compiled
def after_a_sample(state, pace, target, step, drive, own):
    """State and pace one sample later, the input standing at `target` [1] for `step` [s]."""
    remaining = min(step, _SETTLED)
    if not drive.low <= state.x <= drive.high:
        state = _at_the_stop(state, drive)
    while remaining > 1e-9:
        state, pace = _after_a_step(state, pace, target, remaining, drive, own)
        remaining -= pace.length
    return state, pace


@compiled
def _at_the_stop(state, drive):
    """State of a stem that a stop, new in this row, takes along from beyond it, its air shut in."""
    x = min(max(state.x, drive.low), drive.high)
    return State(x, state.mass, state.bend, 0.0, state.lever, state.felt, state.wanted, state.integral)


@compiled
def _after_a_step(state, pace, target, remaining, drive, own):
    chamber = _chamber(state, drive, own)
    seen = _seen(state, target, chamber.pressure, drive, own)
    filling = own.gain * _beyond(seen.near + seen.short, drive.band) + state.integral >= 0.0
    inlet, slope = _nozzle(filling, chamber.pressure, drive, own)
    busy = _busy(state, seen, target, chamber, inlet, filling, drive, own)
    way_left = _way_left(seen, target, chamber.pressure, own) if drive.play > 0.0 else 0.0
    h, speed, loose = _length(state, seen, busy, way_left, filling, remaining, drive, own)
    if h != pace.length:
        pace = _pace(h, own)

    moved = pace.eased * (target - state.wanted)
    ahead = 0.6 * ((1.0 + own.feedback) * moved - pace.caught * seen.behind)
    spool = own.gain * _beyond(seen.near + seen.short + ahead, drive.band) + state.integral
    if (spool >= 0.0) != filling:
        inlet, slope = _nozzle(not filling, chamber.pressure, drive, own)
    ground, limit = _friction(state, speed, drive)
    stiff = drive.bristle / limit
    tight, hold = _stiffness(state, chamber, limit, stiff, spool > 0.0, drive)
    air = _air(state, pace, seen, chamber, moved, inlet, slope, spool, hold, loose, drive, own)

    force = _force(state, chamber, drive) - drive.bristle * state.bend + air.inflow * chamber.per_volume
    side = 1.0 if force > 0.0 else -1.0
    way, bend, back, speed = _way(
        state, pace, chamber, air, side * force, side, tight, ground, limit, stiff, drive
    )
    x, way, speed = _within_travel(state.x + side * way, way, speed, drive)
    mass = state.mass + air.inflow - side * back * way
    error = air.error - (side * air.theta * pace.followed * way if air.grip > 0.0 else 0.0)
    integral = min(max(state.integral + pace.length * own.reset * error, -0.2), 0.2)
    felt = seen.felt + pace.caught * seen.behind + pace.followed * side * way
    return State(x, mass, bend, speed, seen.lever, felt, state.wanted + moved, integral), pace


@compiled
def _chamber(state, drive, own):
    per_volume = 1.0 / (DEAD_VOLUME + state.x)
    pressure = state.mass * per_volume
    lost, lost_slope = 0.0, 0.0
    if drive.leak > 0.0:
        lost, lost_slope = vent_nozzle(pressure, own.atmosphere, drive.leak * drive.capacity)
    return _Chamber(pressure, pressure * per_volume, per_volume, lost, lost_slope)


@compiled
def _seen(state, target, pressure, drive, own):
    lever, seen = state.lever, state.x
    if drive.play > 0.0:
        lever = min(max(lever, state.x - drive.play), state.x + drive.play)
        seen = lever
    felt = state.felt if own.lag > 0.0 else seen
    short = _short(state.wanted, pressure, own)
    return _Seen(lever, felt, seen - felt, target - felt, state.wanted - felt, short)


@compiled
def _short(aim, pressure, own):
    """The air that a positioner's aim asks for, less the air that its gauge shows."""
    return own.feedback * (own.spring + aim - pressure)


@compiled
def _busy(state, seen, target, chamber, inlet, filling, drive, own):
    """How fast the pressure may change in this step."""
    wish = own.gain * _beyond(seen.near + seen.short, drive.band) + state.integral
    flow = drive.capacity * min(max(wish, -1.0), 1.0) * inlet
    busy = abs(flow - chamber.lost) * chamber.per_volume
    if target != state.wanted:
        # it will not outrun the filter, which carries pressure and spring along
        wish = seen.far + _short(target, chamber.pressure, own)
        wish = own.gain * _beyond(wish, drive.band) + state.integral
        wide = (
            drive.capacity * min(abs(wish), 1.0) * (abs(inlet) if (wish >= 0.0) == filling else drive.supply)
        )
        eases = 2.0 * abs(target - state.wanted) * own.per_filter_time
        busy = max(busy, min(wide * chamber.per_volume, eases))
    return busy


@compiled
def _way_left(seen, target, pressure, own):
    """Way that the positioner drives the stem before it may turn: the lesser of errors now and to come."""
    now = seen.near + seen.short
    to_come = seen.far + _short(target, pressure, own)
    return min(abs(now), abs(to_come)) if now * to_come > 0.0 else 0.0


@compiled
def _length(state, seen, busy, way_left, filling, remaining, drive, own):
    """Length of the step, speed of the stem at its beginning, and share of it that play leaves loose.

    It is as long as the pressure's rate allows, and follows the state without jumps.
    """
    h, speed, loose = min(_LONGEST, remaining), state.speed, 0.0
    if drive.stick > 0.0:
        # a stem about to slip is watched closely; it goes on sliding no faster than air drives it
        speed = min(speed, busy)
        margin = 0.5 * (drive.slide + drive.stick * _stribeck(speed) - abs(drive.bristle * state.bend))
        if h * busy > margin:
            h = min(h, max(_STEP_OF_SLIPPING, margin / busy))
    if drive.play > 0.0:
        # until the stem has taken up the play nothing checks it: it must not go far on its own. Once it
        # has, it may turn within a step, and be loose again, so it goes a share of the way that is left
        gap = drive.play - (state.x - seen.lever if filling else seen.lever - state.x)
        untaken = gap / (gap + _TAKEN_UP)
        free = untaken * gap + (1.0 - untaken) * _OF_THE_WAY_LEFT * way_left
        if h * busy > free:
            h = min(h, max(_STEP_OF_PLAY, free / busy))
        loose = min(gap / (h * busy + 1e-9), 1.0)
    if h * busy > _LARGEST_CHANGE:
        h = _LARGEST_CHANGE / busy
    if own.lag > 0.0:
        # while the positioner feels the stem where it was, it must not be asked too seldom
        h = min(h, own.lag * (_OFTEN + _HARDLY / (abs(seen.behind) + 1e-9)))
    return h, speed, loose


@compiled
def _friction(state, speed, drive):
    """Sliding friction here, and with what a stem at this speed has beyond it."""
    ground = drive.slide + max(drive.rod * (state.x - drive.rod_from), 0.0)
    return ground, (ground + drive.stick * _stribeck(speed) if drive.stick > 0.0 else ground)


@compiled
def _force(state, chamber, drive):
    x = state.x
    return chamber.pressure - drive.preload - x - x * (drive.softening + drive.hardening * x * x)


@compiled
def _stiffness(state, chamber, limit, stiff, rising, drive):
    """What resists a way, without friction and with what friction has still in hand: as a spring does."""
    x = state.x
    tight = 1.0 + chamber.stiffness + drive.softening + 3.0 * drive.hardening * x * x
    bent = drive.bristle * state.bend if rising else -drive.bristle * state.bend
    hold = tight
    if bent < limit:
        hold = tight + (limit - bent) * stiff
    return tight, hold


@compiled
def _air(state, pace, seen, chamber, moved, inlet, slope, spool, hold, loose, drive, own):
    """Air of a step, implicit in pressure and error, between trapezoid (short) and backward Euler (long)."""
    h = pace.length
    # against a supply that takes air back a wider spool does not help, and the positioner has no grip
    pull = max(inlet, 0.0)
    grip = pull * own.gain * pace.followed
    y = h * chamber.per_volume * drive.capacity * (grip + abs(slope * spool) * hold)
    theta = (hold + y) / (2.0 * hold + y)
    there = (1.0 - (1.0 - theta) * pace.old) * moved
    near = seen.near - theta * pace.caught * seen.behind
    asked = near + seen.short + (1.0 + own.feedback) * there
    error = _beyond(near + there, drive.band)
    grip, gauge = (own.gain + theta * h * own.reset) * (1.0 - loose) * pace.followed, 0.0
    if abs(asked) > drive.band:
        spool = own.gain * _beyond(asked, drive.band) + theta * h * own.reset * error + state.integral
        if abs(spool) > 1.0:
            spool = 1.0 if spool > 0.0 else -1.0
            grip = 0.0
        else:
            gauge = drive.capacity * pull * own.gain * own.feedback
    else:
        # within its dead band a positioner leaves the air as it is
        grip, spool = 0.0, 0.0
    fall = drive.capacity * abs(slope * spool) + chamber.lost_slope + gauge
    share = h / (1.0 + h * theta * fall * chamber.per_volume)
    inflow = (drive.capacity * inlet * spool - chamber.lost) * share
    back = theta * (drive.capacity * grip * pull - fall * chamber.stiffness) * share
    return _Air(inflow, back, grip, error, theta)


@compiled
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
            return d, fade
    # still under way, perhaps to nowhere: no push drives a stem back
    if not d > 0.0:
        return 0.0, 1.0
    return d, exp(-stiff * d)


@compiled
def _way(state, pace, chamber, air, push, side, tight, ground, limit, stiff, drive):
    """How far a force moves the stem, the bristles' bend then, what of the air comes back, and the speed."""
    bend, back = state.bend, air.back
    way, speed = 0.0, 0.0
    if not ((state.x < drive.high) if side > 0.0 else (state.x > drive.low)):
        return way, bend, back, speed
    through = tight + back * chamber.per_volume + pace.drag
    if drive.rod * (state.x - drive.rod_from) > 0.0:
        through += max(side * drive.rod, 0.0)
    before, first = side * bend, np.inf
    for _ in range(8):
        held = limit - drive.bristle * before
        if held > 0.0:
            way, fade = _displacement(push, through, held, stiff)
        elif push > held:
            # friction has fallen below what the bristles hold
            way = (push - held) / through
            fade = exp(-stiff * way)
        else:
            break
        bend = side * (limit - held * fade) / drive.bristle
        if drive.stick <= 0.0:
            break
        # friction falls under way: by the speed at which air drives what bristles hold no more,
        # and where that frees a way beyond the bristles' own, before the positioner knows
        rate = max(air.inflow * chamber.per_volume * side, 0.0)
        fast = rate / (pace.length * (through + stiff * max(held, 0.0) * fade))
        if (way - first) * drive.bristle > _FREED * limit:
            fast = (way - first) * (1.0 / _SLIP_TIME)
        first = min(first, way)
        falling = ground + drive.stick * _stribeck(fast)
        if falling > 0.99 * limit:
            break
        limit, stiff = falling, drive.bristle / falling
        through -= back * chamber.per_volume
        back = 0.0
    return way, bend, back, way / pace.length


@compiled
def _within_travel(x, way, speed, drive):
    """Opening after a way, the way up to the end of travel, and the speed, which ends there."""
    if not drive.low <= x <= drive.high:
        end = drive.high if x > drive.high else drive.low
        way, speed = way - abs(x - end), 0.0
        x = end
    return x, way, speed
