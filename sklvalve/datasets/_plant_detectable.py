# SPDX-License-Identifier: BSD-3-Clause
"""The size from which on an effect could be seen in one record, by the plant alone.

No code of the diagnosis has a part in it. The same plant runs twice on the same draws, with the effect and
without it; what calibration could take up goes, and what is left is held against the noise.
"""

from dataclasses import dataclass, replace

import numpy as np

from sklvalve.datasets import _plant_noise as noises
from sklvalve.datasets import _plant_tolerance as tolerances
from sklvalve.datasets._plant_draw import WARM_UP
from sklvalve.datasets._plant_effects import EFFECTS
from sklvalve.datasets._plant_loop import COLUMNS, run_plant
from sklvalve.datasets._plant_rig import FLOW, P1, P2, READING

DISTANCE = 25.0  # five standard deviations of what is the best test of one known change
SHARE = 0.005  # of the largest flow, or of travel: from there on a change matters in practice

# What acts between the recorded opening and the recorded flow; the rest acts between command and opening.
FLOW_SIDE = (
    "capacity", "blend", "open_max", "leak_kv", "bypass_kv", "erosion_kv", "fittings", "fl_factor", "choking",
    "plug_play", "plug_offset", "meter_gain", "meter_bias", "meter_lag",
)  # fmt: skip

# Beyond these a valve is another valve: a blend is whole, an actuator without air stands, rough sizes else.
MOST = {
    "backlash": 0.15, "linkage_backlash": 0.15, "stiction": 1500.0, "friction": 1500.0,
    "positioner_deadband": 0.1, "supply_pressure_drop": 0.93, "dead_time": 30.0, "actuator_lag": 60.0,
    "slew_limit": 300.0, "choked_flow": 0.5, "seat_leakage": 0.15, "bypass_open": 0.15, "erosion": 0.25,
    "clogging": 0.9, "wrong_characteristic": 1.0, "piping_reducers": 10.0, "capacity_error": 0.6,
    "sedimentation": 0.6, "position_sensor_bias": 0.12, "flow_meter_gain": 0.6, "flow_meter_bias": 0.2,
    "flow_meter_drift": 0.3, "sensor_lag": 60.0, "trim_rotation": 0.3, "thermal_bow": 0.1,
    "hydrate_pulses": 0.5,
}  # fmt: skip

# Times [s] shorter than what lies between two rows are asked of no record, later onsets included.
ROW = {"dead_time": 1.0, "actuator_lag": 1.0, "slew_limit": 2.0, "sensor_lag": 1.0}


@dataclass(frozen=True)
class Detectable:
    """Smallest size of an effect that one record could tell, and what it rests on.

    Attributes
    ----------
    size : float
        In the unit of the effect, with its sign; infinite where no possible size could be told.
    most : float
        Largest possible size, with its sign.
    distance : float
        Squared sum of the whitened change at `size`, after calibration.
    share : float
        The change at `size`, after calibration, rms where it acts: share of the largest flow or of travel.
    """

    size: float
    most: float
    distance: float
    share: float


def seen_change(plant, name, size, onset, seed, level, rows):
    """How far an effect of this size stands out of a record.

    Opening is compared with that of the healthy actuator under the command of the faulty loop, flow with
    that of the healthy valve at the opening and the pressures of the faulty loop: what a simulation driven by
    recorded signals has to set against the recording. A controller hides nothing that way.

    Parameters
    ----------
    plant : Plant
    name : str
    size, onset : float
    seed : int
        Of the effect's own draws.
    level : float
        Factor on the noise.
    rows : int
        Rows of the recording; what comes later is not seen.

    Returns
    -------
    distance, share : float
    """
    faulty = plant.schedule({name: size}, onset, seed)
    sound = plant.schedule({}, onset, seed)
    loop = _march(plant, faulty, plant.command, plant.auto, plant.source, plant.tank)
    given = (loop[:, 0], np.zeros_like(plant.auto), loop[:, P1], loop[:, P2])
    # the same pressures without the losses of the line: they do not answer the flow any more
    both = _march(plant, faulty, *given, fixed=True)
    seen = slice(WARM_UP, WARM_UP + rows)
    opening, p1, p2 = both[seen, READING], loop[seen, P1], loop[seen, P2]

    valve_sound = faulty.copy()
    for column in FLOW_SIDE:
        valve_sound[:, COLUMNS.index(column)] = sound[:, COLUMNS.index(column)]
    # where the recorded opening is wrong, a healthy plug stands where the recording says
    bias = COLUMNS.index("sensor_bias")
    valve_sound[:, COLUMNS.index("plug_offset")] += faulty[:, bias] - sound[:, bias]

    distance = share = 0.0
    if not np.array_equal(valve_sound, faulty):
        flow = _march(plant, valve_sound, *given, fixed=True)[seen, FLOW]
        change = both[seen, FLOW] - flow
        drop = 1e-3 * (p1 - p2)
        own = tolerances.slopes(plant, opening, p1, p2, plant.rho[seen], plant.floor[seen])
        columns, low, high = tolerances.flow_columns(plant, flow, opening, *own, drop)
        white = noises.whitened_flow(np.column_stack([change, columns]), level, plant, flow, own[0], drop)
        found = _judge(change, columns, low, high, white, both[seen, FLOW].max(), onset)
        distance, share = distance + found[0], max(share, found[1])
    actuator = [i for i, column in enumerate(COLUMNS) if column not in FLOW_SIDE]
    if not np.array_equal(faulty[:, actuator], sound[:, actuator]):
        healthy = _march(plant, sound, *given, fixed=True)[seen, READING]
        sound[:, COLUMNS.index("lag")] += tolerances.RESPONSE
        slow = _march(plant, sound, *given, fixed=True)[seen, READING]
        change = opening - healthy
        columns, low, high = tolerances.opening_columns(healthy, slow)
        white = noises.whitened_opening(np.column_stack([change, columns]), level)
        found = _judge(change, columns, low, high, white, 1.0, onset)
        distance, share = distance + found[0], max(share, found[1])
    return distance, share


def _judge(change, columns, low, high, white, span, onset):
    """Distance of what calibration leaves of a change, and its rms where it acts as share of the span."""
    taken = tolerances.left_over(white[:, 0], white[:, 1:], low, high)
    rest = white[:, 0] - white[:, 1:] @ taken
    left = np.abs(change - columns @ taken)[int(np.ceil(onset)) :] / span
    acting = left > 0.2 * np.quantile(left, 0.99)
    return float(rest @ rest), float(np.sqrt(np.mean(left[acting] ** 2))) if acting.any() else 0.0


def _march(plant, schedule, command, auto, source, tank, fixed=False):
    line = (0.0, 0.0, *plant.line[2:]) if fixed else plant.line
    weather = (source, tank, plant.rho, plant.floor, plant.turbulence, plant.noise["F"])
    hardware = (plant.trim, plant.other, plant.fl, plant.actuator, line, plant.controller)
    return run_plant(schedule, command, auto, plant.setpoint, *weather, *hardware)


def detectable(plant, name, onset, seed, level, rows, sign=1.0, factor=1.0):
    """Smallest size that one record tells: five standard deviations, and enough to matter in practice.

    Parameters
    ----------
    plant : Plant
    name : str
        Of `sklvalve.datasets.CONCEALABLE`.
    onset : float
    seed : int
    level : float
    rows : int
        See `seen_change`.
    sign : float, default=1.0
        Of the size, for effects that have one.
    factor : float, default=1.0
        How many times as large the change must be, both against the noise and in practice.

    Returns
    -------
    found : Detectable
        To 3 per cent of the size.
    """
    most, least = MOST[name], _least(plant, name, onset, rows)
    none = Detectable(np.inf, sign * most, 0.0, 0.0)
    if least >= most:
        return none

    def at(size):
        found = seen_change(plant, name, sign * size, onset, seed, level, rows)
        # one where it is just told; of about second order in the size
        return min(found[0] / DISTANCE, (found[1] / SHARE) ** 2) / factor**2, found

    reached, best = at(most)
    if reached < 1.0:
        return none
    low, high, limit = 0.0, most, EFFECTS[name].limit
    tried = least if limit else max(0.5 * factor * EFFECTS[name].low, least)
    for _ in range(14):
        reached, found = at(tried)
        low, high, best = (low, tried, found) if reached >= 1.0 else (tried, high, best)
        if high <= least or high - low < (0.002 if limit else 0.03 * high):
            break
        # the law of second order leads near; halving leads on where it fails
        guess = tried / np.sqrt(np.clip(reached, 0.05, 20.0)) * (1.015 if reached < 1.0 else 0.985)
        bisect = limit or not 1.01 * low < guess < 0.99 * high
        tried = max(0.5 * (low + high) if bisect else guess, least)
    return replace(none, size=sign * high, distance=best[0], share=best[1])


def _least(plant, name, onset, rows):
    """Least size that is asked about: tolerance from the start, later what a row a second can show."""
    if EFFECTS[name].limit:
        healthy, _ = plant.run({}, 0.0, 0)
        top = float(healthy[int(onset) : rows, READING].max())
        # what limits the travel does so; of 340 kPa of supply the spring needs 20 to 100
        return 1.0 - (20.0 + 80.0 * top) / 340.0 if name == "supply_pressure_drop" else 1.0 - top
    return tolerances.within(plant, name) if onset <= 0.0 else ROW.get(name, 0.0)


def beyond(plant, name, onset, seed, level, rows, times):
    """Draw a size of so many times what is detectable.

    What limits the travel does nothing up to some size, and all of a sudden much: there, the change is so
    many times as large, and not the size.

    Parameters
    ----------
    plant, name, onset, seed, level, rows
        See `detectable`.
    times : tuple of float
        Least and largest factor, between which one is drawn by `seed`; less where the size that it leads to
        is not possible.

    Returns
    -------
    size : float or None
        None where the least factor is not possible.
    factor : float
    found : Detectable
    """
    rng = np.random.default_rng([seed, 1000, list(EFFECTS).index(name)])
    sign = float(rng.choice([-1.0, 1.0])) if EFFECTS[name].signed else 1.0
    share = rng.uniform()
    given = (plant, name, onset, seed, level, rows, sign)
    found = detectable(*given)
    if not np.isfinite(found.size):
        return None, 0.0, found
    if EFFECTS[name].limit:
        change = seen_change(plant, name, found.most, onset, seed, level, rows)
        largest = min(np.sqrt(change[0] / DISTANCE), change[1] / SHARE)
    else:
        largest = found.most / found.size
    if largest < times[0]:
        return None, largest, found
    factor = times[0] + share * (min(times[1], largest) - times[0])
    size = detectable(*given, factor).size if EFFECTS[name].limit else factor * found.size
    return (size if np.isfinite(size) else None), factor, found
