# SPDX-License-Identifier: BSD-3-Clause
"""The actuator in steps of 0.0025 s, compiled: positioner, chamber, stem and valve, with their faults.

Within a step things follow each other as in the benchmark's own library: spring and end stops see the stem of
the step before, the nozzle the chamber's pressure of the step before, and the positioner samples every
fourteenth step. The relations and constants are those of the library's help text (Bartys and Syfert, 2002)
and of Bartys and de las Heras, "Actuator simulation of the DAMADICS benchmark actuator system",
SAFEPROCESS 2003.
"""

import numpy as np
from numba import njit

# places in the array of parameters; `actuator.Actuator.packed` fills it
(
    AREA, DEAD_VOLUME, POLYTROPIC, ATMOSPHERE, NOZZLE, LEAST_SUPPLY, LEAK,
    MASS, SPRING, PRELOAD, VISCOUS, STROKE, PLAY, COULOMB, SLIP_SPEED,
    GAIN, HOLD, SETPOINT_LAG, KV, SLOPE, PLUG, BYPASS_KV, LEAKAGE_ADDS,
) = range(23)  # fmt: skip
N_PARAMETERS = 23
# places in the array of what is carried from step to step
(
    LAG1, LAG2, GAS_MASS, PRESSURE, SPEED, RAW, STEM, FED_BACK, OUTPUT, VALVE, PS_BEFORE, STEM_BEFORE,
    STOPPED,
) = range(13)  # fmt: skip
N_STATES = 13
STEP = 0.0025

_CRITICAL_AT = np.array([0.0, 1723763.0, 3447527.0, 6895055.0, 13790111.0, 17237639.0, 20685166.0])
_CRITICAL = np.array([0.94, 0.87, 0.84, 0.79, 0.75, 0.725, 0.685])
_RECOVERY_AT = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.0])
_RECOVERY = np.array([1.0, 0.95, 0.9, 0.85, 0.785, 0.725, 0.67, 0.61, 0.555, 0.5, 0.45, 0.4])
_BYPASS_AT = np.linspace(0.0, 1.0, 11)
_BYPASS = np.array([0.45, 0.5, 0.555, 0.61, 0.67, 0.725, 0.785, 0.85, 0.9, 0.95, 1.0])
_TRANSDUCER_AT = np.array([-1.0, -0.94, -0.54, 0.46, 0.86, 1.0])
_TRANSDUCER = np.array([-0.55, -0.55, -0.02, 0.02, 1.0, 1.0])
_COMPRESSED_AT = np.array([0.0, 10.0, 20.0, 50.0, 110.0])
_COMPRESSED = np.array([5.26e-10, 5.02e-10, 4.81e-10, 4.69e-10, 4.42e-10])


@njit(cache=True, nogil=True)
def _table(x, at, values):
    """Linear between the points of a table, constant beyond."""
    if x <= at[0]:
        return values[0]
    for k in range(1, len(at)):
        if x <= at[k]:
            return values[k - 1] + (values[k] - values[k - 1]) * (x - at[k - 1]) / (at[k] - at[k - 1])
    return values[-1]


@njit(cache=True, nogil=True)
def _clip(x, low, high):
    return min(max(x, low), high)


@njit(cache=True, nogil=True)
def _play(before, x, width):
    """Output of a play of a width, that follows x as soon as x has crossed it."""
    return min(max(before, x - 0.5 * width), x + 0.5 * width)


@njit(cache=True, nogil=True)
def density(celsius, p1):
    """Density of water [kg/m3] as the benchmark has it, by temperature [degC] and pressure [Pa]."""
    t = _clip(celsius, 0.0, 110.0)
    if t < 30.0:
        rho = 1000.0 - (t - 4.0) ** 2 / 503570.0 * (t + 283.0) * 1000.0 / (t + 67.2)
    else:
        fall = (t - 4.0) ** 2 / 466700.0 * (t + 273.0) * 1000.0 * (350.0 - t)
        rho = 1000.0 - fall / ((t + 67.0) * (365.0 - t))
    return rho / (1.0 - _table(t, _COMPRESSED_AT, _COMPRESSED) * p1)


@njit(cache=True, nogil=True)
def _drop(p1, p2, pv, recovery, critical):
    """What of the pressure drop makes flow: all of it, or what choking lets through."""
    allowed = max(0.0, recovery * (p1 - critical * pv))
    return p1 - p2 if allowed > p1 - p2 else allowed


@njit(cache=True, nogil=True)
def valve_flow(x, p1, p2, celsius, f, par):
    """Mass flow [t/h] through valve and bypass, and the force [N] of the jet on the plug."""
    closed = _clip(x / par[STROKE], 0.0, 1.0)
    if f[2] > 0.0:
        closed = min(1.0, closed + 0.2 * f[2])
    if f[3] > 0.0:
        closed = max(0.0, closed - 0.1 * f[3])
    relative = np.exp(-par[SLOPE] * min(closed, 0.975))
    if closed > 0.975:
        relative *= (1.0 - closed) / 0.025
    relative *= 1.0 - 0.2 * f[2]
    relative = min(1.0, relative * (1.0 + 0.1 * f[3]))
    relative = relative + 0.1 * f[6] if par[LEAKAGE_ADDS] > 0.0 else relative * (1.0 + 0.1 * f[6])
    pv = 10.0 ** (10.7167 - 2141.0 / (celsius + 273.15))
    upstream = max(p1, pv)
    recovery = _table(closed, _RECOVERY_AT, _RECOVERY)
    critical = _table(upstream, _CRITICAL_AT, _CRITICAL)
    rho = density(celsius, upstream)
    drop = _drop(upstream, p2, pv, recovery, critical)
    flow = 100.0 * par[KV] * relative * np.sqrt(abs(drop) * 1e-6 / rho) * rho / 1000.0
    force = (upstream - p2) / recovery * np.pi * par[PLUG] ** 2 / 4.0
    bypass = 0.0
    if f[18] > 0.0:
        shut = 1.0 - f[18]
        recovery = _table(shut, _BYPASS_AT, _BYPASS)
        critical = _table(p1, _CRITICAL_AT, _CRITICAL)
        drop = _drop(upstream, p2, pv, recovery, critical)
        # the original adds m3/h to t/h
        bypass = 100.0 * par[BYPASS_KV] * (1.0 - shut) * np.sqrt(abs(drop) * 1e-6 / 1000.0)
    return flow * (1.0 - 0.05 * f[5]) + bypass, force


@njit(cache=True, nogil=True)
def _forces(p, v, x, force, area, f, par):
    """Net force [N] on the stem, end stops aside."""
    spring = par[SPRING] * (x + par[PRELOAD]) * (1.0 - f[11])
    return par[MASS] * 9.81 + area * (p - par[ATMOSPHERE]) - force - spring - par[VISCOUS] * v


@njit(cache=True, nogil=True)
def _held(x, stop, net):
    return (x <= 0.0 and net <= 0.0) or (x >= stop and net > 0.0)


@njit(cache=True, nogil=True)
def _slopes(y, setpoint, inflow, x, stop, force, area, f, par, dy):
    """Rates of the six states: two lags, gas mass, pressure, speed, raw position."""
    lag1, lag2, mass, p, v = y[0], y[1], y[2], y[3], y[4]
    dy[0] = (setpoint - lag1) / par[SETPOINT_LAG]
    dy[1] = (lag1 - lag2) / par[SETPOINT_LAG]
    dy[2] = inflow
    volume = par[DEAD_VOLUME] + area * x
    dy[3] = par[POLYTROPIC] * p * (inflow / mass - area * _clip(v, -0.02, 0.02) / volume)
    net = _forces(p, v, x, force, area, f, par)
    if _held(x, stop, net + par[VISCOUS] * v):
        net = 0.0
    elif par[COULOMB] > 0.0:
        driving = net + par[VISCOUS] * v
        if abs(v) < par[SLIP_SPEED]:
            # at rest friction takes up what it can
            net = 0.0 if abs(driving) <= par[COULOMB] else driving - np.sign(driving) * par[COULOMB]
            net -= par[VISCOUS] * v
        else:
            net -= np.sign(v) * par[COULOMB]
    dy[4] = net / par[MASS]
    dy[5] = v


@njit(cache=True, nogil=True)
def strengths(t, profiles, f):
    """Signed strengths of the faults at a time, into f[1..19]; of fault, from, to, slope, most and sign."""
    f[:] = 0.0
    for k in range(len(profiles)):
        fault, begins, ends, slope, most, sign = profiles[k]
        if begins <= t < ends:
            f[int(fault)] = sign * min(most, slope * (t - begins))


@njit(cache=True, nogil=True)
def medium(p1, p2, celsius, supply, f, par):
    """Pressures [Pa], temperature [degC] and supply [Pa] as the faults of the surroundings leave them."""
    if f[17] > 0.0:
        p2 *= 1.0 - f[17]
    elif f[17] < 0.0:
        p1 *= 1.0 + f[17]
    p1, p2 = _clip(p1, 0.0, 4e6), _clip(p2, 0.0, 4e6)
    if f[7] > 0.0:
        celsius = _clip(_clip(celsius, 0.0, 200.0) + 200.0 + 100.0 * f[7], 0.0, 300.0)
    supply *= 1.0 - f[16]
    return p1, p2, celsius, supply if supply >= par[LEAST_SUPPLY] else 0.0


@njit(cache=True, nogil=True)
def upper_stop(f, par):
    """Position [m] of the stop at the closed end."""
    return par[STROKE] * (1.0 - 0.2 * f[2]) * (1.0 - f[1]) * (1.0 + 0.1 * f[3])


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
    par : ndarray of shape (N_PARAMETERS,)
    profiles : ndarray of shape (n_faults, 6)
        Of `strengths`.
    every : int
        Steps between rows of `out`, the first at a step that is a multiple of it.
    out : ndarray of shape (rows, 27)
        Filled: stem [m], flow of valve and bypass [t/h], force of the jet [N], pressure of the chamber
        [Pa, gauge], output of the positioner's controller [1], P1 and P2 [Pa] and T1 [degC] as they are at
        the valve, then the strengths of the nineteen faults.

    Returns
    -------
    rows : int
    """
    f, y, rows = np.zeros(20), np.zeros(6), 0
    k1, k2, k3, k4, z = np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6)
    hold = max(1, round(par[HOLD] / STEP))
    for i in range(len(inputs)):
        step = first + i
        if len(profiles) > 0:
            strengths(step * STEP, profiles, f)
        p1, p2, celsius, supply = medium(inputs[i, 1], inputs[i, 2], inputs[i, 3], inputs[i, 4], f, par)
        stroke, stop = par[STROKE], upper_stop(f, par)
        width = _clip(par[PLAY] + stroke * f[4], 0.0, stroke)
        width = min(stroke, width * (1.0 + 0.5 * f[8] * (1.0 - state[STEM_BEFORE] / stroke)))
        x = _clip(_play(state[STEM], state[RAW], width), 0.0, stop)
        state[STEM] = x
        flow, force = valve_flow(x, p1, p2, celsius, f, par)
        sensed = _clip(x * (1.0 + 1.25 * f[13]), -0.25 * stroke, 1.25 * stroke)
        state[FED_BACK] = _play(state[FED_BACK], _clip(sensed, -0.010, 0.050), f[15] * stroke)
        if step % hold == 0:
            angle = np.arcsin((state[FED_BACK] - 0.5 * stroke) / stroke) * 180.0 / np.pi
            state[OUTPUT] = _clip(par[GAIN] * (state[LAG2] - 0.5 - angle / 60.0), -1.0, 1.0)
            opened = _table(state[OUTPUT], _TRANSDUCER_AT, _TRANSDUCER) * (1.0 - f[12])
            state[VALVE] = _clip(opened, -1.0, 1.0)
        pressure = state[PRESSURE] - par[ATMOSPHERE]
        if step % every == 0:
            row = out[rows]
            row[0], row[1], row[2], row[3], row[4] = x, flow, force, pressure, state[OUTPUT]
            row[5], row[6], row[7] = p1, p2, celsius
            row[8:27] = f[1:20]
            rows += 1
        u, before = state[VALVE], state[PS_BEFORE]
        drop = (supply if u > 0.0 else 0.0) - before
        inflow = par[NOZZLE] * abs(u) * np.sign(drop) * np.sqrt(abs(drop))
        inflow -= par[LEAK] * (f[9] + f[10]) * np.sqrt(abs(before))
        area, setpoint = par[AREA] * (1.0 - f[10]), _clip(inputs[i, 0] + noise[i], 0.0, 1.024)
        seen = state[STEM_BEFORE]
        # whatever the stem's speed: an end stop feels the other forces
        stopped = _held(seen, stop, _forces(state[PRESSURE], 0.0, seen, force, area, f, par))
        if stopped != (state[STOPPED] > 0.5):
            state[SPEED] = 0.0
            state[STOPPED] = 1.0 if stopped else 0.0
        y[:] = state[:6]
        _slopes(y, setpoint, inflow, seen, stop, force, area, f, par, k1)
        z[:] = y + 0.5 * STEP * k1
        _slopes(z, setpoint, inflow, seen, stop, force, area, f, par, k2)
        z[:] = y + 0.5 * STEP * k2
        _slopes(z, setpoint, inflow, seen, stop, force, area, f, par, k3)
        z[:] = y + STEP * k3
        _slopes(z, setpoint, inflow, seen, stop, force, area, f, par, k4)
        state[:6] = y + STEP / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        state[GAS_MASS] = _clip(state[GAS_MASS], 1e-6, 0.1)
        state[PRESSURE] = _clip(state[PRESSURE], 0.0, 7e5)
        state[RAW] = _clip(state[RAW], -0.05 * stroke, 1.25 * stroke)
        state[PS_BEFORE], state[STEM_BEFORE] = pressure, x
    return rows
