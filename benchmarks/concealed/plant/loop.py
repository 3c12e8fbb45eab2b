# SPDX-License-Identifier: BSD-3-Clause
"""The plant's compiled march through time.

Everything compiled stays in this one file: numba's cache notices a change of the file of the outermost
function only. Every function takes `row`, the columns of one second, and `hard`, the scalars of one drawn
plant, in the orders of `COLUMNS` and `HARDWARE`.
"""

import numpy as np
from numba import njit

from benchmarks.concealed.plant.columns import COLUMNS

TICK = 0.1  # of line, controllers and command [s]
TICKS = 10  # a second
SCANS = 5  # of the digital positioner, a tick
FINE = 5  # steps of air and stem, a scan
P_ATM = 101325.0

HARDWARE = (
    "travel", "area", "stiffness", "preload", "mass", "damping", "stribeck", "bristle_damping",
    "fill", "vent", "tube", "v_tube", "v_chamber", "gain", "rate_gain", "overlap", "integral_time",
    "source_loss", "outlet_loss", "inertance", "kv", "size4", "knee", "fd", "position_lag", "pressure_lag",
    "erosion_reach",
)  # fmt: skip
(
    TRAVEL, AREA, STIFFNESS, PRELOAD, MASS, DAMPING, STRIBECK, BRISTLE_DAMPING,
    FILL, VENT, TUBE, V_TUBE, V_CHAMBER, GAIN, RATE_GAIN, OVERLAP, INTEGRAL_TIME,
    SOURCE_LOSS, OUTLET_LOSS, INERTANCE, KV, SIZE4, KNEE, FD, POSITION_LAG, PRESSURE_LAG, EROSION_REACH,
) = range(len(HARDWARE))  # fmt: skip
(
    DEAD_TIME, LAG, STROKE_TIME, INPUT_GAIN, INPUT_BIAS, CURVATURE, CUT_LOW, CUT_HIGH, DEAD_ZONE,
    FEEDBACK_GAIN, FEEDBACK_BIAS, FEEDBACK_PLAY, WANDER_IN, SPOOL_SHARE, SUPPLY, AIR_LEAK, LOST_AREA,
    SPRING_STRENGTH, HARDENING, COULOMB, STICK, REACH, BEND_FRICTION, BEND_BEGIN, PLUG_AREA, SEIZED, BLOCKED,
    LINK_PLAY, PLUG_PLAY, PLUG_OFFSET, CAPACITY, BEND, OPEN_MAX, LEAK_KV, EROSION_KV, BYPASS_KV,
    FITTINGS, LINE_ZETA, FL_FACTOR, CAVITATION_LOSS, CAVITATION_BEGIN, VISCOSITY, VISCOSITY_FALL, THINNING,
    DENSITY_RATIO, DENSITY_SLOPE, GAS_SHARE, TAP_INERTIA, LEAK_BEFORE, LEAK_BEHIND, BACK_KV, BACK_FROM,
    METER_GAIN, METER_BIAS, METER_LAG, SWELLING, HUM, BEAT, X_GAIN, X_BIAS, LOOP_GAIN, LOOP_BIAS,
    P1_BIAS, P2_BIAS,
) = range(len(COLUMNS))  # fmt: skip

# state of the actuator
X, V, BRISTLE, P_TUBE, P_CHAMBER, FELT, INTEGRAL, SIGNAL, LIMITED, STEM, STANDS = range(11)
RT = 287.05 * 295.0
RHO_ANR = 1.185
POLYTROPIC = 1.15


@njit(cache=True)
def table(values, x):
    place = min(max(x, 0.0), 1.0) * (values.size - 1)
    i = min(int(place), values.size - 2)
    return values[i] + (place - i) * (values[i + 1] - values[i])


@njit(cache=True)
def follow(inside, outside, width):
    """Play: the driven part rests until the driving one takes it along."""
    return min(max(outside, inside - 0.5 * width), inside + 0.5 * width)


@njit(cache=True)
def nozzle(conductance, p_a, p_b):
    """Mass flow [kg/s] from a to b after ISO 6358 with b = 0.35, its steep end made straight."""
    up, down, sign = (p_a, p_b, 1.0) if p_a >= p_b else (p_b, p_a, -1.0)
    ratio = down / up
    if ratio <= 0.35:
        shape = 1.0
    else:
        shape = np.sqrt(max(1.0 - ((ratio - 0.35) / 0.65) ** 2, 0.0))
        shape = min(shape, (1.0 - ratio) * 20.0)
    return sign * conductance * RHO_ANR * up * shape


@njit(cache=True)
def wanted(state, history, k, share, row):
    """What the positioner aims at: the command after delay, damping, limit and its functions [1]."""
    moment = max(k + share - row[DEAD_TIME], 0.0)
    asked = history[min(int(moment), k)]
    asked = row[INPUT_GAIN] * asked + row[INPUT_BIAS]
    if row[LAG] > 0.0:
        state[SIGNAL] += (1.0 - np.exp(-TICK / row[LAG])) * (asked - state[SIGNAL])
    else:
        state[SIGNAL] = asked
    if row[STROKE_TIME] > 0.0:
        most = TICK / row[STROKE_TIME]
        state[LIMITED] += min(max(state[SIGNAL] - state[LIMITED], -most), most)
    else:
        state[LIMITED] = state[SIGNAL]
    aim = state[LIMITED]
    if row[CURVATURE] != 0.0:
        inside = min(max(aim, 0.0), 1.0)
        aim = np.expm1(row[CURVATURE] * inside) / np.expm1(row[CURVATURE])
    if aim < row[CUT_LOW]:
        aim = -0.05
    if aim > 1.0 - row[CUT_HIGH]:
        aim = 1.05
    return aim + row[WANDER_IN]


@njit(cache=True)
def stem_step(h, state, force, stiffness, row, hard):
    """One step of the stem under LuGre friction, bristles and spring taken implicitly.

    Canudas de Wit et al. 1995: dz/dt = v - sigma0 |v| z / g(v), F = sigma0 z + sigma1 dz/dt, with Tustin's
    g(v) = F_c + (F_s - F_c) exp(-|v| / v_s), which falls from rest on: a slow stem moves by jumps.
    """
    travel = hard[TRAVEL]
    more = row[BEND_FRICTION] * max(state[X] / travel - row[BEND_BEGIN], 0.0) / (1.0 - row[BEND_BEGIN])
    coulomb, stick = row[COULOMB] + more, row[STICK] + more
    v, z = state[V], state[BRISTLE]
    sigma0 = stick / (row[REACH] * travel)
    sigma1 = hard[BRISTLE_DAMPING] * np.sqrt(sigma0 * hard[MASS])
    sliding = coulomb + (stick - coulomb) * np.exp(-abs(v) / hard[STRIBECK])
    decay = 1.0 + h * sigma0 * abs(v) / sliding
    # z_new = (z + h v_new) / decay, so that the friction is a line in v_new
    held = sigma0 * z / decay + sigma1 * (z / decay - z) / h
    slope = (sigma0 * h + sigma1) / decay
    inertia = hard[MASS] / h
    v_new = (inertia * v + force - held) / (inertia + hard[DAMPING] + slope + h * stiffness)
    state[BRISTLE] = (z + h * v_new) / decay
    state[V] = v_new
    state[X] += h * v_new


@njit(cache=True)
def actuator_tick(state, aim, drop, row, hard):
    """A tenth of a second of positioner, air and stem; `drop` acts on the plug [Pa]."""
    h = TICK / (SCANS * FINE)
    travel, bench = hard[TRAVEL], hard[STIFFNESS] * hard[TRAVEL]
    for _ in range(SCANS):
        before = state[FELT]
        place = state[X] / travel
        seen = row[LOOP_GAIN] * place + row[LOOP_BIAS]
        seen = row[FEEDBACK_GAIN] * seen + row[FEEDBACK_BIAS]
        state[FELT] = follow(seen, before, row[FEEDBACK_PLAY]) if row[FEEDBACK_PLAY] > 0.0 else seen
        error = aim - state[FELT]
        speed = (state[FELT] - before) * SCANS / TICK
        # an error within the dead zone is left alone until it has grown out of it
        if abs(error) < row[DEAD_ZONE]:
            spool = 0.0
        else:
            if hard[INTEGRAL_TIME] > 0.0 and abs(error) < 0.05:
                state[INTEGRAL] += TICK / SCANS * error / hard[INTEGRAL_TIME]
                state[INTEGRAL] = min(max(state[INTEGRAL], -0.02), 0.02)
            spool = hard[GAIN] * (error + state[INTEGRAL]) - hard[RATE_GAIN] * speed
            spool = min(max(spool, -1.0), 1.0)
            inner = max(abs(spool) - hard[OVERLAP], 0.0)
            spool = row[SPOOL_SHARE] * np.sign(spool) * inner
        for _ in range(FINE):
            tube, chamber = state[P_TUBE], state[P_CHAMBER]
            if spool >= 0.0:
                air = nozzle(hard[FILL] * spool, row[SUPPLY], tube)
            else:
                air = -nozzle(-hard[VENT] * spool, tube, P_ATM)
            through = nozzle(hard[TUBE], tube, chamber)
            lost = nozzle(hard[FILL] * row[AIR_LEAK], chamber, P_ATM)
            state[P_TUBE] = max(tube + h * RT / hard[V_TUBE] * (air - through), P_ATM)
            volume = hard[V_CHAMBER] + hard[AREA] * max(state[X], 0.0)
            change = RT * (through - lost) - chamber * hard[AREA] * state[V]
            state[P_CHAMBER] = max(chamber + h * POLYTROPIC * change / volume, P_ATM)
            x = state[X]
            push = hard[AREA] * (1.0 - row[LOST_AREA]) * (state[P_CHAMBER] - P_ATM)
            cube = row[HARDENING] * bench * (x / travel) ** 3
            spring = row[SPRING_STRENGTH] * (hard[PRELOAD] + hard[STIFFNESS] * x) + cube
            force = push - spring + row[PLUG_AREA] * drop
            if row[SEIZED] > 0.0:
                state[V] = 0.0
                continue
            stem_step(h, state, force, row[SPRING_STRENGTH] * hard[STIFFNESS], row, hard)
            low = row[BLOCKED] * travel
            if state[X] < low or state[X] > travel:
                state[X] = min(max(state[X], low), travel)
                state[V] = 0.0
    state[STEM] = follow(state[X] / travel, state[STEM], row[LINK_PLAY])


@njit(cache=True)
def least_of(a, b, sharpness):
    """The lesser of a drop and its limit, rounded where they meet."""
    y = a / b
    if y < 1.0:
        return b * (y - np.log1p(np.exp(sharpness * (y - 1.0))) / sharpness)
    return b * (1.0 - np.log1p(np.exp(-sharpness * (y - 1.0))) / sharpness)


@njit(cache=True)
def bubbly(share, p1, p2):
    """Factor on the flow, of the liquid's, with bubbles that expand: largest over the throat's pressure."""
    best, drop = 0.0, max(p1 - p2, 1.0)
    for i in range(17):
        p = p1 - drop * i / 16.0
        work = (1.0 - share) * (p1 - p) + share * p1 * np.log(p1 / p)
        best = max(best, np.sqrt(work / ((1.0 - share) * drop)) / (share * p1 / p + 1.0 - share))
    return best


@njit(cache=True)
def valve_flow(plug, p1, p2, celsius, rho, p_vapour, floor, last, row, hard, trim, fl_table):
    """Volume flow [m3/h] through trim, leak and bypass; `floor` is the least pressure in the jet [Pa]."""
    x = min(plug + row[PLUG_OFFSET], row[OPEN_MAX])
    kv = table(trim, x)
    if row[BEND] != 0.0:
        kv *= max(kv / hard[KV], 1e-4) ** row[BEND]
    kv = kv * row[CAPACITY] + row[LEAK_KV] + row[EROSION_KV] * np.exp(-max(x, 0.0) / hard[EROSION_REACH])
    drop = max(p1 - p2, 0.0)
    ratio = drop / max(p1 - p_vapour, 1e3)
    if ratio > row[CAVITATION_BEGIN]:
        far = (ratio - row[CAVITATION_BEGIN]) / (1.0 - row[CAVITATION_BEGIN])
        kv *= 1.0 - row[CAVITATION_LOSS] * min(far, 1.0)
    fl = table(fl_table, x) * row[FL_FACTOR]
    beside = row[FITTINGS] * kv * kv / (1.6e-3 * hard[SIZE4])
    series = beside + row[LINE_ZETA] * (kv / hard[KV]) ** 2
    most = fl * fl * (1.0 + series) / (1.0 + 0.5 * fl * fl * beside) * max(p1 - floor, 1e3)
    used = max(least_of(drop, most, hard[KNEE]), 0.0)
    kv /= np.sqrt(1.0 + series)
    density = rho * row[DENSITY_RATIO] * np.exp(-row[DENSITY_SLOPE] * (celsius - 20.0))
    scale = 0.1 / np.sqrt(density)
    q = scale * kv * np.sqrt(used)
    if row[VISCOSITY] > 0.0:
        nu = row[VISCOSITY] * np.exp(-row[VISCOSITY_FALL] * (celsius - 20.0))
        if row[THINNING] > 0.0:
            nu *= (max(last, 0.01 * hard[KV]) / hard[KV]) ** -row[THINNING]
        free, n2 = q, 1.6e-3 * hard[SIZE4] / hard[KV] ** 2
        for _ in range(4):
            reynolds = 7.07e-2 * hard[FD] * max(q, 1e-6) / (nu * np.sqrt(max(kv, 1e-6) * fl))
            laminar = 0.026 / fl * np.sqrt(n2 * reynolds)
            # from the laminar line over to one, as wide as the standard's transition
            q = free * (1.0 + laminar**-1.5) ** (-1.0 / 1.5)
    if row[GAS_SHARE] > 0.0:
        q *= bubbly(row[GAS_SHARE], p1, max(p2, 0.3 * p1))
    if row[BYPASS_KV] > 0.0:
        q += scale * row[BYPASS_KV] * np.sqrt(max(least_of(drop, 0.55 * max(p1 - floor, 1e3), 12.0), 0.0))
    return q


@njit(cache=True)
def at_the_meter(q, p1, p2, rho, p_vapour, row):
    """Flow that passes the meter [m3/h], its own errors left out but for what boils."""
    scale = 0.1 / np.sqrt(rho)
    seen = q + row[LEAK_BEFORE] * scale * np.sqrt(max(p1 - P_ATM, 0.0))
    seen -= row[LEAK_BEHIND] * scale * np.sqrt(max(p2 - P_ATM, 0.0))
    seen -= row[BACK_KV] * scale * np.sqrt(max(p2 - row[BACK_FROM], 0.0))
    if p2 < p_vapour:
        seen *= 1.0 + row[SWELLING] * (p_vapour - p2) / p_vapour
    return seen * (1.0 + row[BEAT])
