# SPDX-License-Identifier: BSD-3-Clause
"""The plant's compiled time loop: positioner, pneumatics, stem, plug, water column, meters.

Everything compiled stays in this one file: numba's cache notices a change of the file of the outermost
function only, so a helper elsewhere could be changed and go on running in its old form.
"""

import numpy as np
from numba import njit

# Columns of the schedule: what may change from second to second. An effect is a change to some of these
# columns.
COLUMNS = (
    "capacity",  # factor on the trim's capacity [1]
    "blend",  # 0: the true trim, 1: another one; between, geometric mean [1]
    "open_max",  # opening above which no capacity is added [1]
    "leak_kv",  # parallel to the trim, never shut [m3/h]
    "bypass_kv",  # round the valve [m3/h]
    "erosion_kv",  # added at the seat, fading over 6 % of the travel [m3/h]
    "fittings",  # sum of loss coefficients beside the valve, on the nominal size [1]
    "fl_factor",  # factor on the recovery factor [1]
    "choking",  # 1: the flow chokes, 0: it never does
    "plug_play",  # between stem and plug, full width [1]
    "link_play",  # between actuator and the recorded stem, full width [1]
    "plug_offset",  # plug against stem [1]
    "sensor_bias",  # of the stem sensor that positioner and recording share [1]
    "supply",  # air supply [Pa, absolute]
    "dead_zone",  # of the positioner, half width [1]
    "dead_time",  # of the command [s]
    "lag",  # of the command, first order [s]
    "stroke_time",  # of a rate limit, 0: none [s]
    "coulomb",  # sliding friction [N]
    "stick",  # breakaway friction [N]
    "meter_gain",  # of the flow meter [1]
    "meter_bias",  # of the flow meter [m3/h]
    "meter_lag",  # of the flow meter, first order [s]
)
CAPACITY, BLEND, OPEN_MAX, LEAK, BYPASS, EROSION, FITTINGS, FL_FACTOR, CHOKING = range(9)
PLUG_PLAY, LINK_PLAY, PLUG_OFFSET, SENSOR_BIAS, SUPPLY, DEAD_ZONE, DEAD_TIME, LAG = range(9, 17)
STROKE_TIME, COULOMB, STICK, METER_GAIN, METER_BIAS, METER_LAG = range(17, 23)

# Scalars of one drawn actuator, and of one drawn line, in the order the loop reads them.
ACTUATOR = (
    "area", "travel", "stiffness", "preload", "mass", "damping", "plug_area", "stribeck",
    "c_fill", "c_vent", "c_tube", "v_tube", "v_chamber", "gain", "reset_time", "converter_lag", "overlap",
)  # fmt: skip
LINE = ("pump_loss", "outlet_loss", "inertance", "size4", "knee", "bypass_fl", "pressure_lag", "position_lag")
CONTROLLER = ("gain", "reset_time", "low", "high")

P_ATM = 101325.0
RT_AIR = 287.05 * 293.15
RHO_ANR = 1.185
CRITICAL = 0.32
FINE = 250
COARSE = 50
SHEAR = np.array([2.0e-5, 6.0e-5, 1.5e-4])
SHARE = np.array([0.5, 0.3, 0.2])


@njit(cache=True)
def _nozzle(conductance, p_a, p_b):
    """Mass flow [kg/s] from a to b by ISO 6358, linear near balance, where the root is too steep."""
    up, down, sign = (p_a, p_b, 1.0) if p_a >= p_b else (p_b, p_a, -1.0)
    ratio = down / up
    if ratio <= CRITICAL:
        shape = 1.0
    elif ratio < 0.99:
        shape = np.sqrt(1.0 - ((ratio - CRITICAL) / (1.0 - CRITICAL)) ** 2)
    else:
        edge = np.sqrt(1.0 - ((0.99 - CRITICAL) / (1.0 - CRITICAL)) ** 2)
        shape = edge * (1.0 - ratio) / 0.01
    return sign * conductance * RHO_ANR * up * shape


@njit(cache=True)
def _play(inside, outside, width):
    return min(max(outside, inside - 0.5 * width), inside + 0.5 * width)


@njit(cache=True)
def _zone(error, half):
    if error > half:
        return error - half
    if error < -half:
        return error + half
    return 0.0


@njit(cache=True)
def _stem_step(h, x, v, force, rub, mass, damping, stiffness, friction, slipping):
    """One step of the stem under generalised Maxwell-slip friction, elastic elements taken implicitly."""
    coulomb, stick, stribeck = rub
    limit = coulomb + (stick - coulomb) * np.exp(-((v / stribeck) ** 2))
    held = 0.0
    elastic = 0.0
    for i in range(3):
        if slipping[i]:
            target = np.sign(v) * SHARE[i] * limit
            friction[i] += 0.5 * (target - friction[i])
        else:
            elastic += SHARE[i] * stick / SHEAR[i]
        held += friction[i]
    v_new = (v + h / mass * (force - held)) / (
        1.0 + h / mass * damping + h * h / mass * (elastic + stiffness)
    )
    turned = v_new * v < 0.0
    if turned:
        v_new = 0.0 if slipping[0] else v_new
    limit = coulomb + (stick - coulomb) * np.exp(-((v_new / stribeck) ** 2))
    for i in range(3):
        if slipping[i]:
            if turned or v_new == 0.0:
                slipping[i] = False
        else:
            friction[i] += SHARE[i] * stick / SHEAR[i] * v_new * h
            cap = SHARE[i] * limit
            if abs(friction[i]) >= cap:
                friction[i] = np.sign(friction[i]) * cap
                slipping[i] = friction[i] * v_new > 0.0
    return x + h * v_new, v_new


@njit(cache=True)
def _table(values, x):
    position = min(max(x, 0.0), 1.0) * (values.size - 1)
    i = min(int(position), values.size - 2)
    return values[i] + (position - i) * (values[i + 1] - values[i])


@njit(cache=True)
def _valve_flow(plug, p1, p2, rho, p_liquid, row, trim, other, fl_table, size4, knee, bypass_fl):
    """Volume flow [m3/h] through trim, leak and bypass; `p_liquid` is the least pressure in the jet."""
    x = min(plug, row[OPEN_MAX])
    kv = _table(trim, x)
    if row[BLEND] > 0.0:
        kv = np.exp((1.0 - row[BLEND]) * np.log(kv + 1e-9) + row[BLEND] * np.log(_table(other, x) + 1e-9))
    kv = kv * row[CAPACITY] + row[LEAK] + row[EROSION] * np.exp(-max(plug, 0.0) / 0.06)
    fl = _table(fl_table, x) * row[FL_FACTOR]
    series = row[FITTINGS] * kv * kv / (1.6e-3 * size4)
    drop = max(p1 - p2, 0.0)
    bypass_drop = drop
    if row[CHOKING] > 0.0:
        room = max(p1 - p_liquid, 1e3)
        # with fittings the drop between the taps at choking is (F_LP / F_P)^2 of the room
        most = fl * fl * (1.0 + series) / (1.0 + 0.5 * fl * fl * series) * room
        drop = drop * (1.0 + (drop / most) ** knee) ** (-1.0 / knee)
        most = bypass_fl * bypass_fl * room
        bypass_drop = bypass_drop * (1.0 + (bypass_drop / most) ** knee) ** (-1.0 / knee)
    kv /= np.sqrt(1.0 + series)
    scale = 0.1 / np.sqrt(rho)
    return scale * (kv * np.sqrt(drop) + row[BYPASS] * np.sqrt(bypass_drop))


@njit(cache=True)
def run_plant(schedule, command, auto, setpoint, source, tank, rho, p_liquid, turbulence, flow_noise,
              trim, other, fl_table, actuator, line, controller):  # fmt: skip
    """March the whole loop, one row a second.

    Returns an array of columns command, stem reading [1], plug [1], p1 [Pa], p2 [Pa], flow at the meter
    without noise [m3/h], turbulent flow at the meter [m3/h].
    """
    area, travel, stiffness, preload, mass, damping, plug_area, stribeck = actuator[:8]
    c_fill, c_vent, c_tube, v_tube, v_chamber, gain, reset_time, converter_lag, overlap = actuator[8:]
    pump_loss, outlet_loss, inertance, size4, knee, bypass_fl, pressure_lag, position_lag = line
    kc, ti, low, high = controller
    n = schedule.shape[0]
    out = np.empty((n, 7))
    history = np.empty(n)
    h = 1.0 / FINE
    hh = 1.0 / COARSE
    bench = stiffness * travel / area

    cv = command[0]
    x = cv * travel
    v = 0.0
    friction = np.zeros(3)
    slipping = np.zeros(3, dtype=np.bool_)
    p_chamber = P_ATM + preload / area + cv * bench
    p_tube = p_chamber
    integral = 0.0
    signal = cv
    limited = cv
    aim = cv
    p_signal = p_chamber
    stem = cv
    plug = cv
    reading = cv
    q = _valve_flow(
        plug,
        source[0],
        tank[0],
        rho[0],
        p_liquid[0],
        schedule[0],
        trim,
        other,
        fl_table,
        size4,
        knee,
        bypass_fl,
    )
    p1 = source[0] - pump_loss * q * q
    p2 = tank[0] + outlet_loss * q * q
    meter = q
    meter_turbulent = q
    m1 = p1
    m2 = p2
    last_error = 0.0

    for k in range(n):
        row = schedule[k]
        clean = row[METER_GAIN] * meter + row[METER_BIAS]
        rough = row[METER_GAIN] * meter_turbulent + row[METER_BIAS]
        error = setpoint[k] - (rough + flow_noise[k])
        if auto[k]:
            if k > 0 and auto[k - 1]:
                cv = min(max(cv + kc * (error - last_error + error / ti), low), high)
        else:
            cv = command[k]
        last_error = error
        history[k] = cv
        out[k, 0] = cv
        out[k, 1] = reading
        out[k, 2] = plug
        out[k, 3] = m1
        out[k, 4] = m2
        out[k, 5] = clean
        out[k, 6] = rough

        after = min(k + 1, n - 1)
        for j in range(COARSE):
            share = j / COARSE
            p_source = source[k] + share * (source[after] - source[k])
            p_tank = tank[k] + share * (tank[after] - tank[k])
            moment = k + share - row[DEAD_TIME]
            wanted = history[max(int(np.floor(moment)), 0)]
            signal += hh / max(row[LAG], hh) * (wanted - signal) if row[LAG] > 0.0 else wanted - signal
            if row[STROKE_TIME] > 0.0:
                step = hh / row[STROKE_TIME]
                limited += min(max(signal - limited, -step), step)
            else:
                limited = signal

            # what asks less than the dead zone leaves the aim, and with it the air, as they are
            aim = _play(limited, aim, 2.0 * row[DEAD_ZONE])
            for _ in range(FINE // COARSE):
                felt = x / travel + row[SENSOR_BIAS]
                e = _zone(limited - felt, row[DEAD_ZONE])
                wish = P_ATM + (preload / area + aim * bench) + bench * (gain * e + integral)
                p_signal += h / converter_lag * (wish - p_signal)
                spool = (p_signal - p_tube) / 2.0e4
                spool = min(max(_zone(spool, overlap), -1.0), 1.0)
                if abs(spool) < 0.5 and reset_time > 0.0:
                    integral = min(max(integral + h * gain * e / reset_time, -0.3), 0.3)
                inflow = (
                    _nozzle(c_fill * spool, row[SUPPLY], p_tube)
                    if spool > 0.0
                    else -_nozzle(-c_vent * spool, p_tube, P_ATM)
                )
                between = _nozzle(c_tube, p_tube, p_chamber)
                p_tube = max(p_tube + h * RT_AIR / v_tube * (inflow - between), P_ATM)
                volume = v_chamber + area * max(x, 0.0)
                p_chamber = max(p_chamber + h * (RT_AIR * between - p_chamber * area * v) / volume, P_ATM)
                force = area * (p_chamber - P_ATM) - preload - stiffness * x + plug_area * (m1 - m2)
                rub = (row[COULOMB], row[STICK], stribeck)
                x, v = _stem_step(h, x, v, force, rub, mass, damping, stiffness, friction, slipping)
                if x <= 0.0 or x >= travel:
                    x = min(max(x, 0.0), travel)
                    v = 0.0
                    slipping[:] = False

            stem = _play(x / travel, stem, row[LINK_PLAY])
            plug = _play(stem, plug, row[PLUG_PLAY])
            seen = min(max(plug + row[PLUG_OFFSET], 0.0), 1.0)
            target = _valve_flow(
                seen, p1, p2, rho[k], p_liquid[k], row, trim, other, fl_table, size4, knee, bypass_fl
            )
            # rigid column of water: its time constant follows from inertance, flow and drop
            column = max(inertance * q / (2.0 * max(p1 - p2, 1e3)), 1.5 * hh)
            q += hh / column * (target - q)
            p1 = p_source - pump_loss * q * q
            p2 = p_tank + outlet_loss * q * q
            m1 += hh / pressure_lag * (p1 - m1)
            m2 += hh / pressure_lag * (p2 - m2)
            meter += hh / row[METER_LAG] * (q - meter)
            meter_turbulent += hh / row[METER_LAG] * (q * (1.0 + turbulence[k]) - meter_turbulent)
            reading += hh / position_lag * (stem + row[SENSOR_BIAS] - reading)
    return out
