# SPDX-License-Identifier: BSD-3-Clause
"""Where the valve has been in its history."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history.operating_range import COUNTED, OperatingRange, Visited
from sklvalve.simulation.state import array, mapping, number

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory


def told(history: ValveHistory) -> dict[str, Any]:
    """Of each signal the width of its bins [SI], their numbers, and the rows in each."""
    return {
        name: {"step": float(each.step), "bins": each.bins, "rows": each.rows}
        for name, each in history.range_.visited.items()
    }


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set the operating range again."""
    history.range_ = OperatingRange({name: Visited(**each) for name, each in part.items()})


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse a range that no valve has had; ``ValueError``."""
    for name in part:
        if name not in COUNTED:
            raise ValueError("a range is of no signal")
        each = mapping(part, name)
        if set(each) != {"step", "bins", "rows"}:
            raise ValueError(f"the range of {name} is none")
        step = number(each["step"], f"the bins of {name}", 1e-300)
        if np.log2(step) % 1.0:
            raise ValueError(f"the bins of {name} are of no width that can be joined")
        bins = array(each["bins"], f"the bins of {name}", (-1,))
        rows = array(each["rows"], f"the rows of {name}", bins.shape)
        if not len(bins) or {bins.dtype.kind, rows.dtype.kind} != {"i"}:
            raise ValueError(f"the range of {name} is none")
        if (np.diff(bins) <= 0).any() or (rows < 1).any():
            raise ValueError(f"the bins of {name} do not rise")
