# SPDX-License-Identifier: BSD-3-Clause
"""Effects of plug, trim, fluid and line, between the recorded opening and the flow."""

import numpy as np

from benchmarks.concealed.plant.effects.base import Effect, add, line, multiply, own, rated


def _choked(columns, size, active, plant):
    columns["fl_factor"] *= 1.0 - size * active


def _clogging(columns, size, active, plant):
    columns["open_max"] -= size * active


def _settling(columns, size, active, plant):
    columns["capacity"] *= 1.0 - size * active


def _thick_when_cold(columns, size, active, plant):
    """Oil whose viscosity, of this size at 20 degC, falls as it warms."""
    columns["viscosity"] += size * active
    columns["viscosity_fall"][:] = plant.share(0.03, 0.06)


def _per_hour(size, plant):
    """Growth to this size, from the onset to the last row."""
    return size * 3600.0 / max(plant.grown_for, 1.0)


def _kv(name):
    return own(name, "m3/h", of=lambda size, plant: size * rated(plant))


EFFECTS = (
    Effect(
        "plug_backlash",
        "backlash",
        "valve",
        add("plug_play"),
        0.15,
        free=0.01,
        parameter=own("width", of=lambda size, plant: size + plant.sound["plug_play"]),
    ),
    Effect(
        "capacity_error",
        "capacity_error",
        "valve",
        multiply("capacity"),
        0.5,
        signed=True,
        free=0.1,
        parameter=own("gain"),
        when="within",
    ),
    Effect(
        "wrong_characteristic", "wrong_characteristic", "valve", add("bend"), 0.8, signed=True, when="start"
    ),
    Effect(
        "clogging",
        "clogging",
        "valve",
        _clogging,
        0.9,
        limits=True,
        parameter=own("limit", of=lambda size, plant: 1.0 - size - plant.sound["plug_offset"]),
    ),
    Effect(
        "sedimentation",
        "sedimentation",
        "valve",
        _settling,
        0.5,
        grows=True,
        parameter=own("rate", "1/h", of=_per_hour),
    ),
    Effect(
        "erosion", "erosion", "valve", add("erosion_kv", rated), 0.3, "kv_rated", parameter=_kv("wear_kv")
    ),
    Effect(
        "seat_leakage",
        "seat_leakage",
        "valve",
        add("leak_kv", rated),
        0.2,
        "kv_rated",
        parameter=_kv("leak_kv"),
    ),
    Effect(
        "bypass_open",
        "bypass_open",
        "valve",
        add("bypass_kv", rated),
        0.3,
        "kv_rated",
        parameter=_kv("bypass_kv"),
    ),
    Effect(
        "leak_before_trim",
        "external_leakage",
        "valve",
        add("leak_before", rated),
        0.2,
        "kv_rated",
        parameter=_kv("leak_kv"),
    ),
    Effect(
        "leak_behind_trim",
        "external_leakage",
        "valve",
        add("leak_behind", rated),
        0.2,
        "kv_rated",
        parameter=_kv("leak_kv"),
    ),
    Effect(
        "choked_flow",
        "choked_flow",
        "valve",
        _choked,
        0.6,
        free=0.1,
        limits=True,
        parameter=own("fl", of=lambda size, plant: float(np.median(plant.fl)) * (1.0 - size)),
    ),
    Effect("cavitation", "cavitation", "valve", add("cavitation_loss"), 0.4),
    Effect(
        "flashing", "flashing", "valve", add("swelling"), 10.0, fluid="hot_water", parameter=own("swelling")
    ),
    Effect(
        "viscous_flow",
        "viscous_flow",
        "valve",
        add("viscosity"),
        2e-3,
        "m2/s",
        when="start",
        fluid="oil",
        parameter=own("viscosity", "m2/s"),
    ),
    Effect(
        "viscosity_change",
        "viscosity_change",
        "valve",
        _thick_when_cold,
        5e-3,
        "m2/s",
        when="start",
        fluid="oil",
        parameter=own("viscosity", "m2/s"),
    ),
    Effect(
        "density_change",
        "density_change",
        "valve",
        multiply("density_ratio"),
        0.6,
        signed=True,
        when="within",
        parameter=own("ratio", of=lambda size, plant: 1.0 + size),
    ),
    Effect("density_thermal", "density_change", "valve", add("density_slope"), 0.006, "1/K", fluid="oil"),
    Effect("piping_reducers", "piping_reducers", "line", add("fittings"), 15.0),
    Effect("line_loss", "line_loss", "line", add("line_zeta"), 10.0, parameter=own("loss")),
    Effect(
        "flow_inertia",
        "flow_inertia",
        "line",
        add("tap_inertia", line),
        1000.0,
        "m",
        parameter=own("length_over_area", "1/m", of=lambda size, plant: size * line(plant)),
    ),
    Effect("two_phase", "two_phase", "line", add("gas_share"), 0.4, parameter=own("gas_share")),
)
