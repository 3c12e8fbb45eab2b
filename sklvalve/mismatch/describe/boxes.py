# SPDX-License-Identifier: BSD-3-Clause
"""Contiguous boxes of the operating range, made of cells whose mean residual leaves its band."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.describe.cells import Cells

if TYPE_CHECKING:
    from sklvalve.mismatch.describe.bands import Band

# of the largest mean: less is not where something acts
_FAIR_SHARE = 0.25
_MOST_BOXES = 3
_WAYS = {0: "closing", 1: "opening"}


@dataclass(frozen=True, eq=False)
class Box:
    """A range of one or two signals, or of one signal in one direction of travel.

    Attributes
    ----------
    cells : Cells
    low, high : tuple of int
        First and last bin of each signal.
    """

    cells: Cells
    low: tuple[int, ...]
    high: tuple[int, ...]

    @property
    def rows(self) -> np.ndarray:
        """Rows within the box, ndarray of bool."""
        at = self.cells.at
        inside = np.all((at >= np.array(self.low)) & (at <= np.array(self.high)), axis=1)
        return np.append(inside, False)[self.cells.cell]

    def range(self, i: int) -> tuple[float, float]:
        """Bounds in one of its signals [SI]."""
        edges = self.cells.edges[i]
        return float(edges[self.low[i]]), float(edges[self.high[i] + 1])

    def region(self, recorded: np.ndarray | None = None) -> dict[str, Any]:
        """The entry of diagnosis.json.

        Parameters
        ----------
        recorded : ndarray of shape (n,), default=None
            What was recorded of the first signal, where the cells are of what was simulated: a stem that
            stands below its command is in the box too.
        """
        rows, (low, high) = self.rows, self.range(0)
        if recorded is not None and np.isfinite(recorded[rows]).any():
            ends = np.nanquantile(recorded[rows], [0.02, 0.98])
            low, high = min(low, float(ends[0])), max(high, float(ends[1]))
        signals = self.cells.signals
        entry: dict[str, Any] = {"signal": signals[0], "low": low, "high": high, "direction": None}
        if signals[1:] == ("direction",) and self.low[1] == self.high[1]:
            entry["direction"] = _WAYS[self.low[1]]
        entry["share"] = float(np.mean(rows))
        if len(signals) == 2 and signals[1] != "direction":
            low, high = self.range(1)
            entry["and"] = {"signal": signals[1], "low": low, "high": high}
        return entry


def rows_in(boxes: Sequence[Box], n: int) -> np.ndarray:
    """Rows in any of some boxes."""
    inside = np.zeros(n, dtype=bool)
    for box in boxes:
        inside |= box.rows
    return inside


def covered(boxes: Sequence[Box]) -> float:
    """Share of the rows in any of some boxes."""
    return float(np.mean(rows_in(boxes, len(boxes[0].cells.cell)))) if boxes else 0.0


def boxes_of(band: Band) -> list[Box]:
    """Boxes of cells that leave the band, by a fair share of the largest mean, the fullest first.

    Parameters
    ----------
    band : Band

    Returns
    -------
    boxes : list of Box
    """
    cells, sure = band.cells, band.beyond > 0.0
    if not sure.any():
        return []
    large = np.abs(band.mean) >= _FAIR_SHARE * np.abs(band.mean[sure]).max()
    shape = tuple(len(e) - 1 for e in cells.edges)
    grid = np.full(shape, 0)
    rows = np.bincount(cells.cell[cells.cell >= 0], minlength=cells.count)
    weights = np.where(sure & large, rows, -rows)
    # what is large but not sure neither joins nor parts two boxes
    weights[large & ~sure] = 0
    grid[tuple(cells.at.T)] = weights
    if cells.signals[1:] == ("direction",) and np.all((grid > 0).any(axis=0)):
        both = np.any(grid > 0, axis=1)
        if np.mean(np.all(grid[both] >= 0, axis=1)) > 0.5:
            # one range for both ways, whatever their signs
            grid = np.repeat(
                np.where(both, np.abs(grid).sum(axis=1), -np.abs(grid).sum(axis=1))[:, None], 2, 1
            )
    boxes: list[Box] = []
    while len(boxes) < _MOST_BOXES and (grid > 0).any():
        low, high = _fullest(grid)
        boxes.append(Box(cells, low, high))
        grid[tuple(slice(a, b + 1) for a, b in zip(low, high, strict=True))] = -1
    return boxes


def _fullest(grid: np.ndarray) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The box with most rows that belong in it, less those that do not."""
    if grid.ndim == 1:
        grid = grid[:, None]
        low, high = _fullest(grid)
        return low[:1], high[:1]
    sums = np.pad(grid.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    best: tuple[tuple[int, ...], tuple[int, ...]] = ((0, 0), (0, 0))
    most = -np.inf
    for a, c in product(range(grid.shape[0]), range(grid.shape[1])):
        for b, d in product(range(a, grid.shape[0]), range(c, grid.shape[1])):
            held = sums[b + 1, d + 1] - sums[a, d + 1] - sums[b + 1, c] + sums[a, c]
            # the smaller one of two that hold as much
            if held > most:
                best, most = ((a, c), (b, d)), held
    return best
