# SPDX-License-Identifier: BSD-3-Clause
"""Recordings to try things on: made by a simulated plant, or read from a folder."""

from sklvalve.datasets._plant_effects import CONCEALABLE
from sklvalve.datasets.plant import make_valve_recording

__all__ = ["CONCEALABLE", "make_valve_recording"]
