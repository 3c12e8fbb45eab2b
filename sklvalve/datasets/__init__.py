# SPDX-License-Identifier: BSD-3-Clause
"""Recordings to try things on: made by a simulated plant, or read from a folder."""

from sklvalve.datasets._plant_effects import CONCEALABLE
from sklvalve.datasets.concealed import write_concealed
from sklvalve.datasets.loaders import load_belimo, load_concealed, load_refinery_loops, load_watersafe
from sklvalve.datasets.plant import make_valve_recording
from sklvalve.datasets.valve_days import make_valve_days, write_plant

__all__ = [
    "CONCEALABLE",
    "load_belimo",
    "load_concealed",
    "load_refinery_loops",
    "load_watersafe",
    "make_damadics",
    "make_valve_days",
    "make_valve_recording",
    "write_concealed",
    "write_plant",
]


def __getattr__(name):
    # another plant, with compiled code of its own: loaded where it is asked for
    if name == "make_damadics":
        from sklvalve.damadics import make_damadics

        return make_damadics
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
