# SPDX-License-Identifier: BSD-3-Clause
"""The DAMADICS benchmark: its actuator, its nineteen faults and forty-four scenarios."""

from sklvalve.damadics.actuator import Actuator, preset
from sklvalve.damadics.events import LUBLIN_EVENTS, LublinEvent, events_of
from sklvalve.damadics.faults import FAULTS, Profile
from sklvalve.damadics.fetching import fetch_lublin
from sklvalve.damadics.indices import Indices, Zone, performance_indices, scenario_indices
from sklvalve.damadics.loop import LevelLoop
from sklvalve.damadics.lublin import lublin_sheet, read_lublin
from sklvalve.damadics.make import make_damadics
from sklvalve.damadics.scenarios import SCENARIOS, course, scenario_of
from sklvalve.damadics.sheet import valve_sheet
from sklvalve.damadics.simulator import ActuatorSimulator

__all__ = [
    "FAULTS",
    "LUBLIN_EVENTS",
    "SCENARIOS",
    "Actuator",
    "ActuatorSimulator",
    "Indices",
    "LevelLoop",
    "LublinEvent",
    "Profile",
    "Zone",
    "course",
    "events_of",
    "fetch_lublin",
    "lublin_sheet",
    "make_damadics",
    "performance_indices",
    "preset",
    "read_lublin",
    "scenario_indices",
    "scenario_of",
    "valve_sheet",
]
