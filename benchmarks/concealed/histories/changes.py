# SPDX-License-Identifier: BSD-3-Clause
"""What may be changed between history and record and is no fault, each within what a plant may do.

A change is made to the plant as it was before, since nothing of the record may depend on its history. Each
function gives what is told of the change, record less history, and what of the plant was another before
(`Plant.another_hour`).
"""

import numpy as np

# of the fluid's temperature, where another season is allowed: a liquid stays one [degC]
_SEASONS = {"water": (8.0, 75.0), "hot_water": (110.0, 150.0), "oil": (8.0, 75.0)}


def before(rng, plant, change):
    """What of a plant was another before an allowed change, and what is told of the change.

    Parameters
    ----------
    rng : Generator
    plant : Plant
        Of the record.
    change : str or None
        Of `CHANGES`.

    Returns
    -------
    settings : dict
        For `Plant.another_hour`.
    told : dict or None
    """
    if change is None:
        return {}, None
    step, before = CHANGES[change](rng, plant)
    return before, {"change": change, **step}


def _step(by, unit):
    """Record less history."""
    return {"by": float(by), "unit": unit}


def _flow_zero(rng, plant):
    """The meter's zero was set, from one side of the truth towards the other: both within the sheet."""
    zero = plant.sound["meter_bias"]
    by = np.copysign(rng.uniform(0.002, 0.005) * plant.span, zero)
    return _step(by / plant.span, "span"), {"sound": {"meter_bias": zero - by}}


def _position_zero(rng, plant):
    by = rng.choice([-1.0, 1.0]) * rng.uniform(0.002, 0.005)
    return _step(by, "1"), {"sound": {"x_bias": plant.sound["x_bias"] - by}}


def _pressure_zero(rng, plant):
    role = str(rng.choice([r for r in ("p1", "p2") if f"no_{r}" not in plant.nasty]))
    zero = plant.noise["zeros"][role]
    by = np.copysign(rng.uniform(1.0e3, 2.5e3), zero)
    return _step(by, "Pa") | {"role": role}, {"zeros": {role: zero - by}}


def _season(rng, plant):
    middle, swing = plant.kept["climate"]
    low, high = _SEASONS[plant.fluid]
    by = rng.uniform(10.0, 25.0)
    room = {1.0: high - middle, -1.0: middle - low}
    # before it was warmer or colder, whichever the fluid has room for
    side = rng.choice([s for s in room if room[s] >= by] or [max(room, key=room.get)])
    by = max(min(by, room[side]), 10.0)
    return _step(-side * by, "K"), {"kept": {"climate": (middle + side * by, swing)}}


def _source_pressure(rng, plant):
    by = rng.choice([-1.0, 1.0]) * rng.uniform(40e3, 120e3)
    return _step(by, "Pa"), {"kept": {"source": plant.kept["source"] - by}}


def _tuning(rng, plant):
    by = rng.choice([0.5, 0.7, 1.4])
    return _step(by, "times the gain"), {"kept": {"gain": plant.kept["gain"] / by}}


CHANGES = {
    "flow_zero": _flow_zero,
    "position_zero": _position_zero,
    "pressure_zero": _pressure_zero,
    "season": _season,
    "source_pressure": _source_pressure,
    "tuning": _tuning,
}
