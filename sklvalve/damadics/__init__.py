# SPDX-License-Identifier: BSD-3-Clause
"""The DAMADICS benchmark: its actuator, its nineteen faults and forty-four scenarios."""

from sklvalve.damadics.actuator import Actuator, preset
from sklvalve.damadics.faults import FAULTS, Profile
from sklvalve.damadics.scenarios import SCENARIOS, scenario_of
from sklvalve.damadics.simulator import ActuatorSimulator

__all__ = ["FAULTS", "SCENARIOS", "Actuator", "ActuatorSimulator", "Profile", "preset", "scenario_of"]
