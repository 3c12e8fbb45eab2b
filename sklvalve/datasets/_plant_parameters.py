# SPDX-License-Identifier: BSD-3-Clause
"""Concealed sizes as the catalogue's own parameters, where the two are one quantity.

What a healthy plant has of the same (some play, some dead time) is counted in. Left out, since a diagnosis
that is right gives another number:

- wrong_characteristic: the plant blends two curves, the catalogue bends one;
- capacity_error, flow_meter_gain, flow_meter_bias and position_sensor_bias from the start: the part within
  the sheet's tolerance is calibration, and how much of it nobody can say;
- what no catalogue holds.
"""

import numpy as np

from sklvalve.datasets._plant_effects import EFFECTS

_FROM_AN_ONSET = ("capacity_error", "flow_meter_gain", "flow_meter_bias", "position_sensor_bias")


def catalogue_parameters(plant, strengths, onset):
    """Main parameters of the concealed effects, as diagnosis.json would give them.

    Parameters
    ----------
    plant : Plant
    strengths : dict
        Effect of the plant -> size.
    onset : float

    Returns
    -------
    parameters : dict
        Name in the truth -> ``{"parameter", "value", "unit"}``; effects that have none are left out.
    """
    found = {}
    for name, size in strengths.items():
        given = None if onset <= 0.0 and name in _FROM_AN_ONSET else _parameter(plant, name, size, onset)
        if given is not None and size != 0.0:
            parameter, value, unit = given
            found[EFFECTS[name].told] = {"parameter": parameter, "value": float(value), "unit": unit}
    return found


def _parameter(plant, name, size, onset):
    healthy, kv = plant.healthy, plant.kv
    _, travel, stiffness = plant.actuator[:3]
    spring = stiffness * travel  # force over the whole travel [N]
    # what grows reaches its size on the last row, and from the start it began in the warm-up
    hours = (plant.n + 120.0 if onset <= 0.0 else plant.n - np.ceil(onset)) / 3600.0
    fl = float(plant.fl[plant.fl.size // 2])
    return {
        "backlash": ("width", healthy["plug_play"] + size, "1"),
        "linkage_backlash": ("width", healthy["link_play"] + size, "1"),
        "stiction": ("static_friction", size / spring, "1"),
        "friction": ("friction", size / spring, "1"),
        "positioner_deadband": ("half_width", healthy["dead_zone"] + size, "1"),
        "supply_pressure_drop": ("drop", size, "1"),
        "dead_time": ("delay", healthy["dead_time"] + size, "s"),
        "actuator_lag": ("time_constant", size, "s"),
        "slew_limit": ("speed", 1.0 / size if size else np.inf, "1/s"),
        "choked_flow": ("fl", fl * (1.0 - size), "1"),
        "seat_leakage": ("leak_kv", size * kv, "m3/h"),
        "bypass_open": ("bypass_kv", size * kv, "m3/h"),
        "erosion": ("wear_kv", size * kv, "m3/h"),
        "clogging": ("limit", 1.0 - size - healthy["plug_offset"], "1"),
        "piping_reducers": ("loss", size * kv**2 / (1.6e-3 * plant.sheet["nominal_size"] ** 4), "1"),
        "capacity_error": ("gain", size, "1"),
        "sedimentation": ("rate", size / hours, "1/h"),
        "position_sensor_bias": ("bias", size, "1"),
        "flow_meter_gain": ("gain", size, "1"),
        "flow_meter_bias": ("bias", 1.5 * kv * size, "m3/h"),
        "flow_meter_drift": ("drift", 1.5 * kv * size / hours, "m3/h/h"),
        "sensor_lag": ("lag", healthy["meter_lag"] + size, "s"),
    }.get(name)
