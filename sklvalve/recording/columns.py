# SPDX-License-Identifier: BSD-3-Clause
"""One column of a recording to numbers, where a gap stays a gap and a text is named with its row."""

import re

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import IMPORTED, InputError

_MEND = f"correct it, leave the cell empty where nothing was measured, {IMPORTED} such texts as gaps"
_GAPS = ("", "nan", "none", "<na>", "nat")


def is_gap(item: object) -> bool:
    """Whether a cell holds nothing: None, NaN, an empty text, or a data frame's own mark of it."""
    if isinstance(item, int | float):
        return item != item
    return str(item).strip().lower() in _GAPS


def to_numbers(values: object, where: str, mend: str = _MEND) -> NDArray[np.float64]:
    """Numbers of a column, NaN where a cell holds nothing.

    Parameters
    ----------
    values : array-like of shape (n,)
        Cells as read.
    where : str
        File and column, for messages.
    mend : str
        What to do about a text, for messages.

    Returns
    -------
    numbers : ndarray of shape (n,), float64

    Raises
    ------
    InputError
        If a cell holds something else than a number; the message gives its row, counted from 1, and what it
        holds.
    """
    column = np.asarray(values)
    if column.ndim != 1:
        raise InputError(
            f"{where}: expected one value a row, got shape {column.shape}; give one column for each role"
        )
    if column.dtype.kind in "fiu":
        return column.astype(np.float64)
    numbers = np.empty(len(column))
    for row, item in enumerate(column):
        try:
            numbers[row] = np.nan if is_gap(item) else _number(item)
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"{where}, row {row + 1}: {_not_a_number(item, mend)}") from None
    return numbers


def _number(item: object) -> float:
    if isinstance(item, bool | np.bool_):
        raise TypeError
    return float(item)  # type: ignore[arg-type]


def _not_a_number(item: object, mend: str) -> str:
    try:
        shown = repr(item) if isinstance(item, str) else f"{item}"
    except ValueError:  # Python does not write out an integer of thousands of digits
        shown = "an integer of thousands of digits"
    if len(shown) > 60:
        shown = shown[:57] + "..."
    if isinstance(item, str) and re.fullmatch(r"\s*[+-]?\d+,\d+\s*", item):
        return f"{shown} is no number; write decimals with a point, {IMPORTED} commas"
    return f"{shown} is no number; {mend}"
