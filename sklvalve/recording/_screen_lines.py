# SPDX-License-Identifier: BSD-3-Clause
"""Straight lines between the points that a historian kept, fitted line by line to the written digits."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

_ROOM = 1.02  # written steps: half of one for the point, half for the end that the line hangs on
_LEAST_ROWS = 6  # noise read in steps puts three samples on a line by chance, but hardly six
_LEAST_RISE = 10.0  # written steps; below, noise that the digits swallow would count as a line
_LEAST_LINES, _FEW_LINES, _FEW_ROWS = 10, 4, 30
_INSIDE, _FEW_INSIDE = 0.6, 0.95
# a smooth course without noise falls into lines as well, but they part by 8 to 16 written steps
_CORNER, _SHARP_CORNER, _TURNS = 8.0, 30.0, 0.4


@dataclass(frozen=True)
class Lines:
    """Lines that rise far more than the digits they are written in.

    Parameters
    ----------
    share : float
        Of the moving rows, inside of them.
    rows : float
        Of the middle one.
    """

    share: float
    rows: float


def straight_lines(time: Values, values: Values, written: float) -> Lines | None:
    """Lines that a course was redrawn from; None where it was not.

    A valve at its rate limit also runs straight, but always at the same slope; between a historian's points
    each line has its own. A smooth course without noise bends on little by little, where a historian's lines
    meet in corners.
    """
    known = np.isfinite(values)
    time, values = time[known], values[known]
    if len(values) < 4 * _LEAST_ROWS or written <= 0.0:
        return None
    # numba takes a while to load, and reading a recording needs none of it
    from sklvalve.recording._longest_lines import longest_lines

    ends = longest_lines(time, values, _ROOM * written)
    rows, rise, lasts = np.diff(ends), np.diff(values[ends]), np.diff(time[ends])
    slope = rise / lasts
    long = rows >= _LEAST_ROWS - 1
    rising = long & (np.abs(rise) > _LEAST_RISE * written)
    count, moving = int(rising.sum()), len(values) - 1 - rows[long & ~rising].sum()
    # a coarse reading rests on its steps line after line, and hardly rises
    if count < max(_FEW_LINES, 0.25 * int((long & ~rising).sum())):
        return None
    share, middle = float(rows[rising].sum() / moving), float(np.median(rows[rising])) + 1.0
    few = count < _LEAST_LINES
    if share < (_FEW_INSIDE if few else _INSIDE) or (few and middle < _FEW_ROWS):
        return None
    if not different(slope[rising], 0.9 if few else 0.3):
        return None
    meet = long[1:] & long[:-1] & (rising[1:] | rising[:-1])
    parts = (np.diff(slope) * np.minimum(lasts[1:], lasts[:-1]) / written)[meet]
    return Lines(share, middle) if _in_corners(parts) else None


def different(slopes: Values, share: float = 0.3) -> bool:
    """Whether lines have slopes of their own, not that of a rate limit."""
    return len(np.unique(np.round(np.log(np.abs(slopes)) / 0.02))) >= share * min(len(slopes), 100)


def _in_corners(parts: Values) -> bool:
    """Whether lines part clearly where they meet, by far or to either side."""
    if not len(parts):
        return False
    far = float(np.median(np.abs(parts)))
    turns = float((np.diff(np.sign(parts)) != 0.0).mean()) if len(parts) > 2 else 0.0
    return far >= _SHARP_CORNER or (far >= _CORNER and turns > _TURNS)
