# SPDX-License-Identifier: BSD-3-Clause
"""What the screens share: the finding itself, runs of rows, the grid that values lie on."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.dead_bands import flow_moved_by
from sklvalve.recording.recording import Recording
from sklvalve.recording.runs import runs
from sklvalve.recording.signal import OPENING_ROLES

Finding = dict[str, object]

#: Roles that come from a sensor; a command or a set-point may hold still or run straight without any fault.
MEASURED = (
    "opening",
    "p1",
    "p2",
    "temperature",
    "flow",
    "actuator_pressure",
    "supply_pressure",
    "process_value",
)

_MOST_ROWS = 1000


def finding(
    name: str,
    role: str | None,
    detail: str,
    rows: Iterable[tuple[int, int]] | None = None,
    size: float | None = None,
) -> Finding:
    """One finding as plain data; `rows` are the longest 1000 [start, stop) spans, None for all rows."""
    spans = None
    if rows is not None:
        longest = sorted(rows, key=lambda span: span[0] - span[1])[:_MOST_ROWS]
        spans = [[int(start), int(stop)] for start, stop in sorted(longest)]
    told: Finding = {"finding": name, "role": role, "detail": detail, "rows": spans}
    return told if size is None else told | {"size": float(size)}


def boiling_point(pressure: float) -> float:
    """Temperature [K] at which water boils under a pressure [Pa] (Antoine, 99 to 374 degC)."""
    return 1810.94 / (8.14019 - np.log10(max(pressure, 1.0) / 133.322)) - 244.485 + 273.15


def measured(recording: Recording) -> list[str]:
    """Roles that a sensor measured, in the order of the signal's way."""
    return [role for role in MEASURED if role in recording and role not in recording.constants]


def worth(recording: Recording, role: str) -> float:
    """What half a percent must be of to count, in the recorded unit; above zero.

    The whole travel, of a flow what it reaches, of a pressure what moves the flow as much: flow goes with the
    root of the drop. Of anything else its range.
    """
    if role in OPENING_ROLES:
        return abs(recording.per_si(role))
    values = recorded(recording, role)
    low, high = np.nanquantile(values, [0.01, 0.99])
    reach = float(high - low)
    if role == "flow":
        reach = float(np.nanquantile(np.abs(values), 0.995))
    elif role in ("p1", "p2"):
        one = abs(recording.per_si(role))
        reach = max(one / flow_moved_by(recording, 1.0), reach)
    return reach if reach > 0.0 else float(np.ptp(values[np.isfinite(values)])) or 1.0


def equal_runs(values: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Spans [start, stop) of at least two rows that repeat one value."""
    return [(start, stop + 1) for start, stop in runs(np.diff(values) == 0.0)]


def quantum(values: NDArray[np.float64]) -> float:
    """Step of the grid that nearly all values lie on; 0 where they lie on none.

    The tenth percentile of the moves from row to row, instead of the smallest, keeps a few interpolated or
    averaged values from hiding the grid. A grid much finer than the noise is not found, nor does it matter.
    """
    present = values[np.isfinite(values)]
    distinct = np.unique(present)
    moves = np.abs(np.diff(present))
    moves = moves[moves > 0.0]
    if len(distinct) < 3 or not len(moves):
        return 0.0
    step = float(np.quantile(moves, 0.1, method="lower"))
    if step <= 1e-9 * np.abs(distinct).max():
        return 0.0
    # the digits that values are rounded to must not add up over many steps
    step = float(np.ptp(distinct) / max(1.0, np.round(np.diff(distinct) / step).sum()))
    places = (present - distinct[len(distinct) // 2]) / step
    on_grid = np.abs(places - np.round(places)) < 0.02
    return step if on_grid.mean() > 0.98 else 0.0


def resting_quantum(values: NDArray[np.float64]) -> float:
    """Step of the grid that a signal rests on, though redrawn between its steps; 0 for none."""
    rests = equal_runs(values)
    if sum(stop - start - 1 for start, stop in rests) < 0.1 * len(values):
        return 0.0
    # each rest counts once: one that is long, as where a sensor stands still, makes no grid
    return quantum(np.array([values[start] for start, _ in rests]))


def recorded(recording: Recording, role: str) -> NDArray[np.float64]:
    """Values as they were written, without the traces of unit conversion."""
    values = recording.in_recorded_units(role, recording[role])
    largest = np.nanmax(np.abs(values), initial=0.0)
    return np.round(values, 10 - int(np.ceil(np.log10(largest)))) if largest > 0.0 else values
