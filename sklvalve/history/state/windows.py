# SPDX-License-Identifier: BSD-3-Clause
"""What every window of a history says, stacked: a file of a year holds a few arrays and not ten thousand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history.learning import Window
from sklvalve.history.posterior import Information
from sklvalve.simulation.noise import NoiseParts
from sklvalve.simulation.state import array, mapping, number

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_NOISE = tuple(each.name for each in fields(NoiseParts))
# of these nothing can be divided by where they are zero
_ABOVE_ZERO = ("fast_time", "slow_time", "size", "peak")
# of the largest curvature: rounding makes a vanishing one a little negative
_ROUNDING = 1e-6


def told(history: ValveHistory) -> dict[str, Any]:
    """Arrays over the windows: of shape (w,), of pulls (w, m), of Hessians and moves (w, m, m)."""
    windows = history.windows_
    channels = history.channels
    return {
        "begins": [w.begins if isinstance(w.begins, str) else float(w.begins) for w in windows],
        "rows": np.array([w.rows for w in windows], dtype=np.int64),
        "seconds": np.array([w.seconds for w in windows], dtype=float),
        "information": [
            {
                "hessian": np.array([w.information[k].hessian for w in windows]),
                "pull": np.array([w.information[k].pull for w in windows]),
                "moves": np.array([w.information[k].moves for w in windows]),
            }
            for k in range(len(history._groups_))
        ],
        "left": {c: np.array([w.left[c] for w in windows], dtype=float) for c in channels},
        "noise": {
            c: {name: np.array([getattr(w.noise[c], name) for w in windows], dtype=float) for name in _NOISE}
            for c in channels
        },
    }


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set the windows again."""
    groups, left, noise = part["information"], part["left"], part["noise"]
    history.windows_ = [
        Window(
            begins=begins,
            rows=int(part["rows"][k]),
            seconds=float(part["seconds"][k]),
            information=tuple(Information(g["hessian"][k], g["pull"][k], g["moves"][k]) for g in groups),
            left={c: float(each[k]) for c, each in left.items()},
            noise={
                c: NoiseParts(**{name: float(each[name][k]) for name in _NOISE}) for c, each in noise.items()
            },
        )
        for k, begins in enumerate(part["begins"])
    ]


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse windows that no history has; ``ValueError``."""
    begins, groups = part.get("begins"), whole["calibration"]["groups"]
    if not isinstance(begins, list | tuple) or not begins:
        raise ValueError("it has no windows")
    for begin in begins:
        if not isinstance(begin, str):
            number(begin, "a time", -1e300, 1e300)
    w = len(begins)
    if not (array(part.get("rows"), "the rows of the windows", (w,)) > 0).all():
        raise ValueError("a window has no rows")
    if not (array(part.get("seconds"), "the seconds of the windows", (w,)) >= 0.0).all():
        raise ValueError("a window runs back")
    information = part.get("information")
    if not isinstance(information, list | tuple) or len(information) != len(groups):
        raise ValueError("the windows say nothing of some signals")
    for group, each in zip(groups, information, strict=True):
        _require_sound_information(each, w, len(group["parameters"]))
    for channel in (channel for group in groups for channel in group["channels"]):
        left = array(mapping(part, "left").get(channel), f"what is left of the {channel}", (w,))
        if not (left >= 0.0).all():
            raise ValueError(f"what is left of the {channel} is below 0")
        _require_sound_noise(mapping(mapping(part, "noise"), channel), channel, w)


def _require_sound_information(each: Any, w: int, m: int) -> None:
    each = mapping({"information": each}, "information")
    array(each.get("pull"), "a pull", (w, m))
    for name, words in (("hessian", "Hessian"), ("moves", "table of moves")):
        curvature = array(each.get(name), f"a {words}", (w, m, m))
        if not np.allclose(curvature, curvature.transpose(0, 2, 1), rtol=1e-6, atol=1e-6):
            raise ValueError(f"a {words} is not symmetric")
        # a curvature below zero would make of an uncertainty an imaginary one
        size = np.linalg.eigvalsh(curvature)
        if (size[:, 0] < -_ROUNDING * np.maximum(size[:, -1], 1.0)).any():
            raise ValueError(f"a {words} bends down")


def _require_sound_noise(parts: dict[str, Any], channel: str, w: int) -> None:
    for name in _NOISE:
        values = array(parts.get(name), f"{name} of the noise of the {channel}", (w,))
        least = np.finfo(float).tiny if name in _ABOVE_ZERO else 0.0
        if not (values >= least).all():
            raise ValueError(f"{name} of the noise of the {channel} is out of range")
