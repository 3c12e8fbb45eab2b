# SPDX-License-Identifier: BSD-3-Clause
"""The actuator in steps of 0.0025 s, compiled: positioner, chamber and stem, with their faults.

Within a step things follow each other as in the benchmark's own library: spring and end stops see the stem of
the step before, the nozzle the chamber's pressure of the step before, and the positioner samples every
fourteenth step. The relations and constants are those of the library's help text (Bartys and Syfert, 2002)
and of Bartys and de las Heras, "Actuator simulation of the DAMADICS benchmark actuator system",
SAFEPROCESS 2003. `par` is always what `actuator.Actuator.packed` gives, `f` the strengths of the faults with
fault 1 at place 1.
"""

import numpy as np
from numba import njit

from sklvalve.damadics.flow import clip, closing, jet_force, mass_flow, table

# places in the array of what is carried from step to step
(
    LAG1, LAG2, GAS_MASS, PRESSURE, SPEED, RAW, STEM, FED_BACK, OUTPUT, VALVE, PS_BEFORE, STEM_BEFORE,
    STOPPED,
) = range(13)  # fmt: skip
N_STATES = 13
STEP = 0.0025
#: What a row of a march tells: stem [m], flow [t/h], force of the jet [N], pressure of the chamber [Pa,
#: gauge], output of the positioner's controller [1], command [1], P1 and P2 [Pa] and T1 [degC] at the valve,
#: supply [Pa, gauge] before its fault; behind these stand the strengths of the profiles' faults.
COLUMNS = ("x", "F_tph", "Fvc", "Ps", "CVI", "CV", "P1", "P2", "T1", "Pz")

_TRANSDUCER_AT = np.array([-1.0, -0.94, -0.54, 0.46, 0.86, 1.0])
_TRANSDUCER = np.array([-0.55, -0.55, -0.02, 0.02, 1.0, 1.0])


@njit(cache=True, nogil=True)
def _play(before, x, width):
    """Output of a play of a width, that follows x as soon as x has crossed it."""
    return min(max(before, x - 0.5 * width), x + 0.5 * width)


@njit(cache=True, nogil=True)
def _force(p, x, jet, area, f, par):
    """Force [N] on the stem towards closed, friction and end stops aside."""
    spring = par.spring * (x + par.preload) * (1.0 - f[11])
    return par.mass * 9.81 + area * (p - par.atmosphere) - jet - spring


@njit(cache=True, nogil=True)
def _held(x, stop, force):
    return (x <= 0.0 and force <= 0.0) or (x >= stop and force > 0.0)


@njit(cache=True, nogil=True)
def speed_with_friction(v, force, friction, par):
    """Speed [m/s] a step later under dry friction [N], which holds a stem at rest until it is overcome.

    Karnopp's law (ASME J. Dynamic Systems, Measurement, and Control 107 (1985) 100). The step is an implicit
    one, so that a stem comes to rest exactly and needs no band of speeds that count as rest.
    """
    pushed = par.mass * v / STEP + force
    if abs(pushed) <= (par.breakaway * friction if v == 0.0 else friction):
        return 0.0
    return (pushed - np.sign(pushed) * friction) / (par.mass / STEP + par.viscous)


@njit(cache=True, nogil=True)
def _slopes(y, setpoint, inflow, x, stop, jet, area, f, par):
    """Rates of the six states: two lags, gas mass, pressure, speed, raw position."""
    lag1, lag2, mass, p, v, _ = y
    volume = par.dead_volume + area * x
    squeezed = area * clip(v, -0.02, 0.02) / volume
    force, gains = _force(p, x, jet, area, f, par), 0.0
    if par.stick_slip == 0.0 and not _held(x, stop, force):
        gains = (force - par.viscous * v) / par.mass
    return (
        (setpoint - lag1) / par.setpoint_lag,
        (lag1 - lag2) / par.setpoint_lag,
        inflow,
        par.polytropic * p * (inflow / mass - squeezed),
        gains,
        v,
    )


@njit(cache=True, nogil=True)
def _ahead(y, k, h):
    return (
        y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2], y[3] + h * k[3], y[4] + h * k[4], y[5] + h * k[5]
    )  # fmt: skip


@njit(cache=True, nogil=True)
def _runge_kutta(state, setpoint, inflow, x, stop, jet, area, f, par):
    """Move the first six states on by a step."""
    y = (state[0], state[1], state[2], state[3], state[4], state[5])
    k1 = _slopes(y, setpoint, inflow, x, stop, jet, area, f, par)
    k2 = _slopes(_ahead(y, k1, 0.5 * STEP), setpoint, inflow, x, stop, jet, area, f, par)
    k3 = _slopes(_ahead(y, k2, 0.5 * STEP), setpoint, inflow, x, stop, jet, area, f, par)
    k4 = _slopes(_ahead(y, k3, STEP), setpoint, inflow, x, stop, jet, area, f, par)
    for j in range(6):
        state[j] = y[j] + STEP / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])


@njit(cache=True, nogil=True)
def strengths(t, profiles, f):
    """Signed strengths of the faults at a time, into f[1..19]; of fault, from, to, slope, most and sign."""
    f[:] = 0.0
    for k in range(len(profiles)):
        fault, begins, ends, slope, most, sign = profiles[k]
        if begins <= t < ends:
            f[int(fault)] = sign * min(most, slope * (t - begins))


@njit(cache=True, nogil=True)
def medium(p1, p2, celsius, f):
    """Pressures [Pa] and temperature [degC] as the faults of the surroundings leave them."""
    if f[17] > 0.0:
        p2 *= 1.0 - f[17]
    elif f[17] < 0.0:
        p1 *= 1.0 + f[17]
    if f[7] > 0.0:
        celsius = clip(clip(celsius, 0.0, 200.0) + 200.0 + 100.0 * f[7], 0.0, 300.0)
    return clip(p1, 0.0, 4e6), clip(p2, 0.0, 4e6), celsius


@njit(cache=True, nogil=True)
def upper_stop(f, par):
    """Position [m] of the stop at the closed end."""
    return par.stroke * (1.0 - 0.2 * f[2]) * (1.0 - f[1]) * (1.0 + 0.1 * f[3])


@njit(cache=True, nogil=True)
def _hysteresis(x, f, par):
    """Width [m] of the hysteresis between diaphragm and stem."""
    width = clip(par.stroke * (par.play + f[4]), 0.0, par.stroke)
    return min(par.stroke, width * (1.0 + 0.5 * f[8] * (1.0 - x / par.stroke)))


@njit(cache=True, nogil=True)
def _positioner(step, x, f, state, par):
    """Feedback of the stem at every step, controller and transducer where the positioner samples."""
    half, least, most = 0.5 * par.stroke, -0.25 * par.stroke, 1.25 * par.stroke
    sensed = clip(clip(x * (1.0 + 1.25 * f[13]), least, most), -0.010, 0.050)
    state[FED_BACK] = _play(state[FED_BACK], sensed, f[15] * par.stroke)
    if step % max(1, round(par.hold / STEP)) == 0:
        angle = np.arcsin((state[FED_BACK] - half) / par.stroke) * 180.0 / np.pi
        state[OUTPUT] = clip(par.gain * (state[LAG2] - 0.5 - angle / 60.0), -1.0, 1.0)
        opened = table(state[OUTPUT], _TRANSDUCER_AT, _TRANSDUCER) * (1.0 - f[12])
        state[VALVE] = clip(opened, -1.0, 1.0)


@njit(cache=True, nogil=True)
def _inflow(supply, f, state, par):
    """Air into the chamber [kg/s], which sees the pressure of the step before."""
    u, before = state[VALVE], state[PS_BEFORE]
    air = supply * (1.0 - f[16])
    # a supply that falls just to the least one is not lost by rounding
    enough = air >= par.least_supply * (1.0 - 1e-9)
    drop = (air if u > 0.0 and enough else 0.0) - before
    inflow = par.nozzle * abs(u) * np.sign(drop) * np.sqrt(abs(drop))
    return inflow - par.leak * (f[9] + f[10]) * np.sqrt(abs(before))


@njit(cache=True, nogil=True)
def advance(step, command, p1, p2, celsius, supply, f, state, par):
    """Go a step on, and say how things stood at its beginning.

    Parameters
    ----------
    step : int
        Its number since the beginning.
    command, p1, p2, celsius, supply : float
        As the positioner sees it [1]; at the valve [Pa], [degC]; air before its fault [Pa, gauge].
    f : ndarray of shape (20,)
    state : ndarray of shape (N_STATES,)
        Changed.
    par : Constants

    Returns
    -------
    x : float
        Stem at the beginning of the step [m].
    closed : float
        Share of closing that the flow meets [1].
    jet : float
        [N].
    pressure : float
        Of the chamber [Pa, gauge].
    """
    stop, seen = upper_stop(f, par), state[STEM_BEFORE]
    width = _hysteresis(seen, f, par)
    x = clip(_play(state[STEM], state[RAW], 0.0 if par.stick_slip > 0.0 else width), 0.0, stop)
    closed = closing(x, f, par)
    jet, pressure = jet_force(closed, p1, p2, celsius, par), state[PRESSURE] - par.atmosphere
    state[STEM] = x
    _positioner(step, x, f, state, par)

    area = par.effective_area * (1.0 - f[10])
    force = _force(state[PRESSURE], seen, jet, area, f, par)
    # whatever the stem's speed: an end stop feels the other forces
    stopped = _held(seen, stop, force)
    if stopped != (state[STOPPED] > 0.5):
        state[SPEED] = 0.0
        state[STOPPED] = 1.0 if stopped else 0.0
    if par.stick_slip > 0.0 and not stopped:
        # the force that bends the spring by half the width of the play
        state[SPEED] = speed_with_friction(state[SPEED], force, 0.5 * width * par.spring, par)
    setpoint = clip(command, 0.0, 1.024)
    _runge_kutta(state, setpoint, _inflow(supply, f, state, par), seen, stop, jet, area, f, par)
    state[GAS_MASS] = clip(state[GAS_MASS], 1e-6, par.most_air)
    state[PRESSURE] = clip(state[PRESSURE], 0.0, 7e5)
    state[RAW] = clip(state[RAW], -0.05 * par.stroke, 1.25 * par.stroke)
    state[PS_BEFORE], state[STEM_BEFORE] = pressure, x
    return x, closed, jet, pressure


@njit(cache=True, nogil=True)
def record(row, now, flow, output, drivers, f, profiles):
    """Fill a row with what `COLUMNS` says, of what `advance` returned and the drivers as they act."""
    row[0], row[1], row[2], row[3], row[4] = now[0], flow, now[2], now[3], output
    row[5], row[6], row[7], row[8], row[9] = drivers
    for k in range(len(profiles)):
        row[10 + k] = f[int(profiles[k, 0])]


@njit(cache=True, nogil=True)
def march(first, inputs, noise, state, par, profiles, every, out):
    """Go on from a state through some steps.

    Parameters
    ----------
    first : int
        Number of the first step since the beginning.
    inputs : ndarray of shape (n, 5)
        Command [1], inlet and outlet pressure [Pa], temperature [degC] and supply [Pa, gauge] at every step.
    noise : ndarray of shape (n,)
        Of the command within the positioner [1].
    state : ndarray of shape (N_STATES,)
        Changed.
    par : Constants
    profiles : ndarray of shape (n_faults, 6)
        Of `strengths`.
    every : int
        Steps between rows of `out`, the first at a step that is a multiple of it.
    out : ndarray of shape (rows or more, 10 + n_faults)
        Filled with what `COLUMNS` says.
    """
    f, rows = np.zeros(20), 0
    for i in range(len(inputs)):
        step, command, supply = first + i, inputs[i, 0], inputs[i, 4]
        if len(profiles) > 0:
            strengths(step * STEP, profiles, f)
        p1, p2, celsius = medium(inputs[i, 1], inputs[i, 2], inputs[i, 3], f)
        now = advance(step, command + noise[i], p1, p2, celsius, supply, f, state, par)
        if step % every == 0:
            flow = mass_flow(now[1], p1, p2, celsius, f, par)
            record(out[rows], now, flow, state[OUTPUT], (command, p1, p2, celsius, supply), f, profiles)
            rows += 1
