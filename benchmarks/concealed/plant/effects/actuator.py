# SPDX-License-Identifier: BSD-3-Clause
"""Effects between the command and the recorded opening."""

import numpy as np

from benchmarks.concealed.plant.effects.base import Effect, add, multiply, own, rise, spring
from benchmarks.concealed.plant.loop import P_ATM


def _stiction(columns, size, active, plant):
    force = size * spring(plant)
    rise("stick")(columns, force, active, plant)
    rise("coulomb")(columns, plant.share(0.35, 0.7) * force, active, plant)


def _friction(columns, size, active, plant):
    force = size * spring(plant)
    rise("stick")(columns, 1.03 * force, active, plant)
    rise("coulomb")(columns, force, active, plant)


def _presliding(columns, size, active, plant):
    """Soft packing: bristles of this reach, and friction that goes with it."""
    rise("reach")(columns, size, active, plant)
    _friction(columns, min(3.0 * size, 0.15), active, plant)


def _bent(columns, size, active, plant):
    columns["bend_friction"] += size * spring(plant) * active
    columns["bend_begin"][:] = plant.share(0.3, 0.7)


def _supply(columns, size, active, plant):
    columns["supply"][:] = P_ATM + (columns["supply"] - P_ATM) * (1.0 - size * active)


def _slow(columns, size, active, plant):
    columns["stroke_time"][:] = np.where(active > 0.0, size, 0.0)


def _seized(columns, size, active, plant):
    columns["seized"][:] = active > 0.0


EFFECTS = (
    Effect("stiction", "stiction", "actuator", _stiction, 0.8, parameter=own("static_friction")),
    Effect("friction", "friction", "actuator", _friction, 0.8, parameter=own("friction")),
    Effect(
        "link_backlash",
        "backlash",
        "actuator",
        add("link_play"),
        0.15,
        free=0.01,
        parameter=own("width", of=lambda size, plant: size + plant.sound["link_play"]),
    ),
    Effect("presliding", "presliding", "actuator", _presliding, 0.15),
    Effect(
        "positioner_deadband",
        "positioner_deadband",
        "actuator",
        add("dead_zone"),
        0.1,
        free=0.005,
        parameter=own("half_width", of=lambda size, plant: size + plant.sound["dead_zone"]),
    ),
    Effect(
        "spring_fault",
        "spring_fault",
        "actuator",
        multiply("spring_strength"),
        1.9,
        limits=True,
        parameter=own("strength", of=lambda size, plant: 1.0 + size),
    ),
    Effect(
        "supply_pressure_drop",
        "supply_pressure_drop",
        "actuator",
        _supply,
        0.93,
        limits=True,
        parameter=own("drop"),
    ),
    Effect("actuator_leak", "actuator_leak", "actuator", add("air_leak"), 1.5, limits=True),
    Effect("rod_bend", "rod_bend", "actuator", _bent, 1.5, parameter=own("friction")),
    Effect(
        "actuator_lag",
        "actuator_lag",
        "actuator",
        add("lag"),
        60.0,
        "s",
        free=3.0,
        parameter=own("time_constant", "s"),
    ),
    Effect(
        "slew_limit",
        "slew_limit",
        "actuator",
        _slow,
        300.0,
        "s",
        free=6.0,
        parameter=own("speed", "1/s", of=lambda size, plant: 1.0 / max(size, 1e-9)),
        asks=("wide",),
    ),
    Effect(
        "dead_time",
        "dead_time",
        "actuator",
        add("dead_time"),
        30.0,
        "s",
        free=3.0,
        parameter=own("delay", "s", of=lambda size, plant: size + plant.sound["dead_time"]),
    ),
    Effect(
        "transducer_fault",
        "transducer_fault",
        "actuator",
        multiply("input_gain"),
        0.5,
        signed=True,
        free=0.01,
        parameter=own("gain"),
    ),
    Effect(
        "feedback_fault",
        "positioner_feedback_fault",
        "actuator",
        multiply("feedback_gain"),
        0.5,
        signed=True,
        free=0.01,
        parameter=own("gain"),
    ),
    Effect(
        "feedback_play",
        "positioner_feedback_fault",
        "actuator",
        add("feedback_play"),
        0.3,
        free=0.01,
        parameter=own("width"),
    ),
    Effect(
        "tight_shutoff",
        "tight_shutoff",
        "actuator",
        add("cut_low"),
        0.2,
        parameter=own("cut_off"),
        asks=("wide",),
    ),
    Effect(
        "characteriser",
        "positioner_characteriser",
        "actuator",
        add("curvature"),
        3.0,
        signed=True,
        parameter=own("curvature"),
        when="start",
    ),
    Effect("clogging_closing", "clogging", "valve", rise("blocked"), 0.6, limits=True),
    Effect("stuck_valve", "stuck_valve", "actuator", _seized, 1.0, when="within", limits=True),
)
