# SPDX-License-Identifier: BSD-3-Clause
"""What the plant can conceal: each effect changes columns of the schedule and vanishes at size zero."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from sklvalve.datasets._plant_loop import P_ATM


@dataclass(frozen=True)
class Concealed:
    """One effect: how it is told afterwards, how large it is drawn, what it does to the schedule."""

    told: str | None  # its name in the truth; None: no catalogue holds it
    block: str
    moves: str  # the signal by which its size is judged: "opening" or "flow"
    low: float  # from the start, a smaller one could be a tolerance of the sheet
    high: float
    unit: str
    apply: Callable
    sized: bool = True  # whether a drawn size is scaled until it matters as much as it should
    needs_wide: bool = False  # whether a calm loop off the seat shows nothing of it
    limit: bool = False  # low and high are quantiles of the healthy opening at which it limits the travel
    signed: bool = False


def _add(column, scale=lambda kv: 1.0):
    def apply(schedule, size, active, surroundings):
        schedule[column][:] += size * scale(surroundings["kv"]) * active

    return apply


def _at_least(column):
    def apply(schedule, size, active, surroundings):
        schedule[column][:] = np.where(active, np.maximum(schedule[column], size), schedule[column])

    return apply


def _multiply(column):
    def apply(schedule, size, active, surroundings):
        schedule[column][:] *= 1.0 + size * active

    return apply


def _stiction(schedule, size, active, surroundings):
    _at_least("stick")(schedule, size, active, surroundings)
    share = surroundings["rng"].uniform(0.35, 0.75)
    _at_least("coulomb")(schedule, share * size, active, surroundings)


def _friction(schedule, size, active, surroundings):
    _at_least("stick")(schedule, size, active, surroundings)
    _at_least("coulomb")(schedule, size, active, surroundings)


def _supply_drop(schedule, size, active, surroundings):
    schedule["supply"][:] = P_ATM + (schedule["supply"] - P_ATM) * (1.0 - size * active)


def _choked(schedule, size, active, surroundings):
    schedule["fl_factor"][:] *= 1.0 - size * active


def _clogging(schedule, size, active, surroundings):
    schedule["open_max"][:] -= size * active


def _growing(column, sign):
    """A drift that starts at the onset and reaches its size at the end of the record."""

    def apply(schedule, size, active, surroundings):
        grown = np.cumsum(active)
        scale = 1.5 * surroundings["kv"] if column == "meter_bias" else 1.0
        schedule[column][:] += sign * scale * size * grown / max(grown[-1], 1.0)

    return apply


def _trim_rotation(schedule, size, active, surroundings):
    rng, n = surroundings["rng"], active.size
    phase = 2.0 * np.pi * (np.arange(n) / rng.uniform(150.0, 700.0) + rng.uniform())
    schedule["capacity"][:] *= 1.0 + size * np.sin(phase) * active


def _thermal_bow(schedule, size, active, surroundings):
    """The stem bows while body and bonnet differ in temperature, and pulls the plug with it."""
    celsius = surroundings["celsius"]
    body = lfilter([1.0 / 600.0], [1.0, -1.0 + 1.0 / 600.0], celsius, zi=[celsius[0] * (1.0 - 1.0 / 600.0)])[
        0
    ]
    bow = celsius - body
    schedule["plug_offset"][:] += size * bow / max(np.sqrt(np.mean(bow * bow)), 1e-9) * active


def _hydrate_pulses(schedule, size, active, surroundings):
    """Deposits grow for some minutes and are then washed off at once, again and again."""
    rng, n = surroundings["rng"], active.size
    blocked, t = np.zeros(n), 0
    while t < n:
        t += int(rng.uniform(50.0, 300.0))
        length = int(rng.uniform(60.0, 350.0))
        stop = min(t + length, n)
        if t < n:
            blocked[t:stop] = rng.uniform(0.6, 1.4) * (np.arange(stop - t) / length) ** 0.7
        t = stop
    schedule["capacity"][:] *= np.maximum(1.0 - size * blocked * active, 0.1)


def _per_rated(kv):
    return kv


def _per_span(kv):
    return 1.5 * kv


EFFECTS = {
    "backlash": Concealed("backlash", "valve", "flow", 0.015, 0.06, "1", _add("plug_play")),
    "linkage_backlash": Concealed("backlash", "actuator", "opening", 0.025, 0.06, "1", _add("link_play")),
    "stiction": Concealed("stiction", "actuator", "opening", 350.0, 700.0, "N", _stiction),
    "friction": Concealed("friction", "actuator", "opening", 300.0, 700.0, "N", _friction),
    "positioner_deadband": Concealed(
        "positioner_deadband", "actuator", "opening", 0.012, 0.04, "1", _add("dead_zone")
    ),
    "supply_pressure_drop": Concealed(
        "supply_pressure_drop", "actuator", "opening", 0.7, 0.93, "1", _supply_drop, sized=False, limit=True
    ),
    "dead_time": Concealed("dead_time", "actuator", "opening", 4.5, 9.0, "s", _add("dead_time"), sized=False),
    "actuator_lag": Concealed(
        "actuator_lag", "actuator", "opening", 8.0, 20.0, "s", _add("lag"), sized=False
    ),
    "slew_limit": Concealed(
        "slew_limit",
        "actuator",
        "opening",
        40.0,
        120.0,
        "s",
        _add("stroke_time"),
        sized=False,
        needs_wide=True,
    ),
    "choked_flow": Concealed("choked_flow", "valve", "flow", 0.16, 0.35, "1", _choked),
    "seat_leakage": Concealed(
        "seat_leakage", "valve", "flow", 0.015, 0.06, "kv_rated", _add("leak_kv", _per_rated)
    ),
    "bypass_open": Concealed(
        "bypass_open", "valve", "flow", 0.015, 0.06, "kv_rated", _add("bypass_kv", _per_rated)
    ),
    "erosion": Concealed(
        "erosion", "valve", "flow", 0.03, 0.1, "kv_rated", _add("erosion_kv", _per_rated), needs_wide=True
    ),
    "clogging": Concealed("clogging", "valve", "flow", 0.65, 0.92, "1", _clogging, sized=False, limit=True),
    "wrong_characteristic": Concealed("wrong_characteristic", "valve", "flow", 0.22, 0.6, "1", _add("blend")),
    "piping_reducers": Concealed("piping_reducers", "line", "flow", 0.8, 2.5, "1", _add("fittings")),
    "capacity_error": Concealed(
        "capacity_error", "valve", "flow", 0.25, 0.4, "1", _multiply("capacity"), signed=True
    ),
    "sedimentation": Concealed("sedimentation", "valve", "flow", 0.06, 0.25, "1", _growing("capacity", -1.0)),
    "position_sensor_bias": Concealed(
        "position_sensor_bias", "measurement", "flow", 0.02, 0.05, "1", _add("sensor_bias"), signed=True
    ),
    "flow_meter_gain": Concealed(
        "flow_meter_gain", "measurement", "flow", 0.25, 0.4, "1", _multiply("meter_gain"), signed=True
    ),
    "flow_meter_bias": Concealed(
        "flow_meter_bias",
        "measurement",
        "flow",
        0.015,
        0.05,
        "span",
        _add("meter_bias", _per_span),
        signed=True,
    ),
    "flow_meter_drift": Concealed(
        "flow_meter_drift",
        "measurement",
        "flow",
        0.02,
        0.08,
        "span",
        _growing("meter_bias", 1.0),
        signed=True,
    ),
    "sensor_lag": Concealed(
        "sensor_lag", "measurement", "flow", 6.0, 20.0, "s", _add("meter_lag"), sized=False
    ),
    "trim_rotation": Concealed(None, "valve", "flow", 0.03, 0.12, "1", _trim_rotation),
    "thermal_bow": Concealed(None, "valve", "flow", 0.008, 0.04, "1", _thermal_bow),
    "hydrate_pulses": Concealed(None, "valve", "flow", 0.04, 0.25, "1", _hydrate_pulses),
}

#: Names of the effects that `make_valve_recording` can conceal.
CONCEALABLE = tuple(EFFECTS)
