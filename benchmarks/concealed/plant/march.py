# SPDX-License-Identifier: BSD-3-Clause
"""The whole loop, its actuator alone, and its valve alone, marched through time.

Alone, each is driven by what the loop did: so an effect can be switched off where it acts, while all else
stays as it was. Every march gives one row each fifth of a second.
"""

import numpy as np
from numba import njit

from benchmarks.concealed.plant.loop import (
    AREA,
    FELT,
    INERTANCE,
    INTEGRAL,
    KV,
    LIMITED,
    METER_BIAS,
    METER_GAIN,
    METER_LAG,
    OUTLET_LOSS,
    P_ATM,
    P_CHAMBER,
    P_TUBE,
    PLUG_PLAY,
    POSITION_LAG,
    PRELOAD,
    PRESSURE_LAG,
    SEIZED,
    SIGNAL,
    SOURCE_LOSS,
    STEM,
    STIFFNESS,
    TAP_INERTIA,
    TICK,
    TICKS,
    TRAVEL,
    X,
    actuator_tick,
    at_the_meter,
    follow,
    valve_flow,
    wanted,
)

EVERY = 2  # ticks from one row to the next
A_SECOND = TICKS // EVERY
COMMAND, STEM_READ, PLUG, P1_READ, P2_READ, METER, LEVEL = range(7)


# no cache in this file: a change of loop.py would go unnoticed
@njit
def _start(cv, hard):
    state = np.zeros(11)
    state[X] = cv * hard[TRAVEL]
    state[P_CHAMBER] = P_ATM + (hard[PRELOAD] + hard[STIFFNESS] * state[X]) / hard[AREA]
    state[P_TUBE] = state[P_CHAMBER]
    state[FELT] = state[SIGNAL] = state[LIMITED] = state[STEM] = cv
    state[INTEGRAL] = 0.0
    return state


@njit
def _share_of_way(step, free, q, drop, rho, row):
    """How far a column between the taps lets the flow go to where it would be free, within a step."""
    if row[TAP_INERTIA] <= 0.0:
        return 1.0
    wait = rho * row[TAP_INERTIA] * max(free, q) / (3600.0 * 2.0 * max(drop, 1e3))
    return 1.0 - np.exp(-step / max(wait, 1e-3))


@njit
def _line_flow(plug, q0, source, tank, fluid, row, hard, trim, fl_table):
    """Flow after one tick, and pressures at the taps, the water column taken implicitly."""
    celsius, rho, p_vapour, floor = fluid
    q = q0
    step = 1e-4 * hard[KV]
    for _ in range(4):
        rest = np.empty(2)
        for i in range(2):
            trial = q + i * step
            push = hard[INERTANCE] * (trial - q0) / TICK
            p1 = source - hard[SOURCE_LOSS] * trial * abs(trial) - 0.5 * push
            p2 = tank + hard[OUTLET_LOSS] * trial * abs(trial) + 0.5 * push
            free = valve_flow(plug, p1, p2, celsius, rho, p_vapour, floor, q0, row, hard, trim, fl_table)
            rest[i] = q0 + _share_of_way(TICK, free, q0, p1 - p2, rho, row) * (free - q0) - trial
        change = -rest[0] * step / (rest[1] - rest[0])
        q = max(q + change, 0.0)
        if abs(change) < 1e-6 * hard[KV]:
            break
    push = hard[INERTANCE] * (q - q0) / TICK
    return q, source - hard[SOURCE_LOSS] * q * q - 0.5 * push, tank + hard[OUTLET_LOSS] * q * q + 0.5 * push


@njit
def march_loop(schedule, given, auto, setpoint, weather, meter_noise, hard, trim, fl_table, controller):
    """The loop under its own controllers.

    `weather`: rows of source, tank, celsius, rho, p_vapour, floor, outflow of the vessel behind. `auto`: 0 by
    hand, 1 flow control, 2 level control over it. `controller`: gain, reset time, lowest and highest output,
    level gain, level reset time, area of the vessel; its first column may change by the second.
    """
    n = schedule.shape[0]
    out = np.empty((n * A_SECOND, 7))
    history = np.empty(n)
    cv, level, outer, before = given[0], 0.5, 0.0, 0.0
    state = _start(cv, hard)
    plug = cv
    q, p1, p2 = 0.0, weather[0, 0], weather[0, 1]
    for _ in range(200):
        fluid = (weather[0, 2], weather[0, 3], weather[0, 4], weather[0, 5])
        q, p1, p2 = _line_flow(
            plug, q, weather[0, 0], weather[0, 1], fluid, schedule[0], hard, trim, fl_table
        )
    meter, read, m1, m2 = q, cv, p1, p2
    target = q
    for k in range(n):
        row = schedule[k]
        gain, reset, low, high, level_gain, level_reset, vessel = controller[k]
        seen = row[METER_GAIN] * meter + row[METER_BIAS] + meter_noise[k]
        if auto[k] == 0:
            cv = given[k]
        else:
            target = setpoint[k]
            if auto[k] == 2:
                wrong = setpoint[k] - level
                outer = min(max(outer + level_gain * wrong / level_reset, 0.0), 1.6 * hard[KV])
                target = min(max(outer + level_gain * wrong, 0.05 * hard[KV]), 1.6 * hard[KV])
            error = target - seen
            if k == 0 or auto[k - 1] == 0:
                outer = seen
            else:
                cv = min(max(cv + gain * (error - before + error / reset), low), high)
            before = error
        history[k] = cv
        after = min(k + 1, n - 1)
        for j in range(TICKS):
            share = j / TICKS
            if j % EVERY == 0:
                i = k * A_SECOND + j // EVERY
                out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = cv, read, plug, m1, m2
                out[i, 5], out[i, 6] = meter, level if auto[k] == 2 else target
            source = weather[k, 0] + share * (weather[after, 0] - weather[k, 0])
            tank = weather[k, 1] + share * (weather[after, 1] - weather[k, 1])
            if row[SEIZED] == 0.0:
                aim = wanted(state, history, k, share, row)
                actuator_tick(state, aim, p1 - p2, row, hard)
            plug = follow(state[STEM], plug, row[PLUG_PLAY])
            fluid = (weather[k, 2], weather[k, 3], weather[k, 4], weather[k, 5])
            q, p1, p2 = _line_flow(plug, q, source, tank, fluid, row, hard, trim, fl_table)
            passing = at_the_meter(q, p1, p2, weather[k, 3], weather[k, 4], row)
            meter += (1.0 - np.exp(-TICK / row[METER_LAG])) * (passing - meter)
            m1 += TICK / (hard[PRESSURE_LAG] + TICK) * (p1 - m1)
            m2 += TICK / (hard[PRESSURE_LAG] + TICK) * (p2 - m2)
            read += TICK / (hard[POSITION_LAG] + TICK) * (state[STEM] - read)
            if auto[k] == 2:
                level += TICK * (q - weather[k, 6]) / (3600.0 * vessel)
    return out


@njit
def march_actuator(schedule, command, drop, hard):
    """Stem as its sensor follows it, and as it stands, under a command of every second [1]."""
    n = schedule.shape[0]
    out = np.empty((n * A_SECOND, 2))
    state = _start(command[0], hard)
    read = command[0]
    for k in range(n):
        row = schedule[k]
        for j in range(TICKS):
            if j % EVERY == 0:
                out[k * A_SECOND + j // EVERY, 0] = read
                out[k * A_SECOND + j // EVERY, 1] = state[STEM]
            if row[SEIZED] == 0.0:
                aim = wanted(state, command, k, j / TICKS, row)
                actuator_tick(state, aim, drop[k * A_SECOND + j // EVERY], row, hard)
            read += TICK / (hard[POSITION_LAG] + TICK) * (state[STEM] - read)
    return out


@njit
def march_valve(schedule, stem, p1, p2, weather, hard, trim, fl_table):
    """Flow as its meter follows it [m3/h], at this stem [1] and these pressures [Pa]."""
    n = schedule.shape[0]
    out = np.empty(n * A_SECOND)
    plug, q, meter, step = stem[0], 0.0, 0.0, TICK * EVERY
    for i in range(n * A_SECOND):
        k = i // A_SECOND
        row = schedule[k]
        plug = follow(stem[i], plug, row[PLUG_PLAY])
        celsius, rho, p_vapour, floor = weather[k, 2], weather[k, 3], weather[k, 4], weather[k, 5]
        free = valve_flow(plug, p1[i], p2[i], celsius, rho, p_vapour, floor, q, row, hard, trim, fl_table)
        q = free if i == 0 else q + _share_of_way(step, free, q, p1[i] - p2[i], rho, row) * (free - q)
        passing = at_the_meter(q, p1[i], p2[i], rho, p_vapour, row)
        if i == 0:
            meter = passing
        out[i] = meter
        meter += (1.0 - np.exp(-step / row[METER_LAG])) * (passing - meter)
    return out
