# SPDX-License-Identifier: BSD-3-Clause
"""Courses over time, panel by panel: what was recorded, and what the simulation leaves of it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.report import signals
from sklvalve.report.words import role_words

Array = NDArray[np.float64]

# one panel each; of two signals the second stands behind
_PANELS = (("opening", "command"), ("flow", "setpoint"), ("process_value", "setpoint"), ("p2", "p1"))
_TOLD = {"nominal": ", before", "corrected": ", after"}
_COMPARED = ("opening", "flow", "process_value")


class Course(NamedTuple):
    """One signal over time.

    Parameters
    ----------
    name : str
    unit : str
    colour : str
        A key of `sklvalve.report.drawing.COLOURS`.
    values : ndarray of shape (n,)
        In `unit`; NaN is a gap.
    """

    name: str
    unit: str
    colour: str
    values: Array


Panel = list[Course]


def recorded_panels(traces: dict) -> list[Panel]:
    """What was recorded: travel, flow or another value that a loop controls, and pressures."""
    recorded = traces["recorded"]
    panels = []
    for group in _PANELS:
        present = [role for role in group if recorded.get(role) is not None]
        if present and present != ["setpoint"]:
            colours = ("recorded", "other")
            panels.append(
                [
                    Course(*_named(traces, role), colour, np.asarray(recorded[role], dtype=float))
                    for role, colour in zip(present, colours, strict=False)
                ]
            )
    return panels


def residual_panels(traces: dict) -> list[Panel]:
    """Recorded minus simulated, before and after the correction; none where nothing can be compared."""
    panels = []
    for role in compared_roles(traces):
        name, unit = _named(traces, role)
        left = {model: signals.residual(traces, role, model) for model in signals.MODELS}
        told = _TOLD if left["corrected"] is not None else {"nominal": ""}
        panels.append(
            [
                Course(f"{name}{when}", unit, model, values)
                for model, when in told.items()
                if (values := left[model]) is not None
            ]
        )
    return panels


def compared_roles(traces: dict) -> list[str]:
    """Roles that were both recorded and simulated."""
    return [role for role in _COMPARED if signals.residual(traces, role, "nominal") is not None]


def _named(traces: dict, role: str) -> tuple[str, str]:
    return role_words(role), str(traces["units"].get(role, "1"))
