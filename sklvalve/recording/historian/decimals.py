# SPDX-License-Identifier: BSD-3-Clause
"""Numbers as an export writes them: decimal commas, groups of thousands, a unit behind them."""

import re
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.tags import read_unit

_BLANKS = dict.fromkeys(map(ord, " \u00a0\u202f'’"))
_TAIL = r"(?:[eE][+-]?\d+)?"
_NUMERIC = re.compile(rf"[+-]?(?:\d[\d.,' \u00a0\u202f]*|[.,]\d+){_TAIL}%?")
_WITH_UNIT = re.compile(r"([+-]?[\d.,]+(?:[eE][+-]?\d+)?)\s*([^\d\s.,][^\d]*\d?[^\d]*)")
# no number is written in more letters; on longer cells some of these patterns take minutes
_LONGEST = 80
# numbers that can only be read in one way; 1,234 and 1.234 can be read in two
_ONLY = {
    ",": re.compile(
        rf"[+-]?(?:\d{{1,3}}(?:\.\d{{3}})+,\d+|0,\d+|\d{{4,}},\d+|\d*,(?:\d{{1,2}}|\d{{4,}})){_TAIL}"
    ),
    ".": re.compile(
        rf"[+-]?(?:\d{{1,3}}(?:,\d{{3}})+\.\d+|0\.\d+|\d{{4,}}\.\d+|\d*\.(?:\d{{1,2}}|\d{{4,}})){_TAIL}"
    ),
}
_EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_GROUPED = {
    ",": re.compile(rf"[+-]?\d{{1,3}}(?:\.\d{{3}})*(?:,\d*)?{_TAIL}"),
    ".": re.compile(rf"[+-]?\d{{1,3}}(?:,\d{{3}})*(?:\.\d*)?{_TAIL}"),
}


class Mark(NamedTuple):
    """The decimal mark of a file; `assumed` where its numbers can be read with either."""

    mark: str
    assumed: bool = False


def looks_numeric(cell: str) -> bool:
    """Whether a cell holds a number, whichever its decimal mark."""
    return len(cell) <= _LONGEST and _NUMERIC.fullmatch(cell) is not None


def decimal_mark(cells: Iterable[tuple[str, str]], separator: str) -> Mark:
    """Find out whether a file writes its decimals with a point or a comma.

    Parameters
    ----------
    cells : iterable of (cell, place)
        Cells of the value columns, and where each stands, for messages.
    separator : str
        What stands between columns.

    Returns
    -------
    mark : Mark

    Raises
    ------
    InputError
        If both marks stand in the file.
    """
    seen: dict[str, tuple[str, str]] = {}
    either = False
    for cell, place in cells:
        if "," not in cell and "." not in cell:
            continue
        for mark, pattern in _ONLY.items():
            if mark in cell and mark not in seen and len(cell) <= _LONGEST and pattern.fullmatch(cell):
                seen[mark] = cell, place
        either = either or _EITHER.fullmatch(cell) is not None
        if len(seen) == 2:
            (comma, _), (point, _) = seen[","], seen["."]
            raise InputError(
                f"{place}: the number {cell!r}, but elsewhere {comma if cell == point else point!r}: decimal "
                "points and decimal commas in one file; export it again with one of them"
            )
    if seen:
        return Mark(next(iter(seen)))
    return Mark("," if either and separator != "," else ".", assumed=either)


def read_numbers(cells: list[str], mark: str) -> tuple[NDArray[np.float64], dict[int, str]]:
    """Numbers of cells, and the cells that hold none.

    Parameters
    ----------
    cells : list of str, length n
    mark : {".", ","}
        The decimal mark.

    Returns
    -------
    numbers : ndarray of shape (n,), float64
        NaN where a cell is no number, or not a finite one.
    texts : dict
        Index -> text of each such cell; an empty text where the cell is empty.
    """
    numbers = np.full(len(cells), np.nan)
    texts: dict[int, str] = {}
    known: dict[str, float | None] = {}
    for place, cell in enumerate(cells):
        if cell not in known:
            known[cell] = _number(cell, mark)
        value = known[cell]
        if value is None:
            texts[place] = cell
        else:
            numbers[place] = value
    return numbers, texts


def unit_behind(cells: Iterable[str]) -> str:
    """Unit that stands behind the numbers of a column, as written; empty where most have none."""
    filled = [cell for cell in cells if cell]
    units = [match[2].strip() for cell in filled if (match := _WITH_UNIT.fullmatch(cell))]
    usual = max(set(units), key=units.count, default="")
    return usual if 2 * units.count(usual) > len(filled) and read_unit(usual) else ""


def _number(cell: str, mark: str) -> float | None:
    if not cell or len(cell) > _LONGEST:
        return None
    try:
        if mark == "," and "." in cell:
            return _odd_number(cell, mark)
        value = float(cell.replace(",", ".") if mark == "," else cell)
    except ValueError:
        return _odd_number(cell, mark)
    # float() takes 1_000, nan and inf as well
    return value if np.isfinite(value) and "_" not in cell else None


def _odd_number(cell: str, mark: str) -> float | None:
    """A number in groups of thousands, or with its unit behind it."""
    tight = cell.translate(_BLANKS)
    if _GROUPED[mark].fullmatch(tight) or re.fullmatch(rf"[+-]?\d+(?:[{mark}]\d*)?{_TAIL}", tight):
        other = "." if mark == "," else ","
        value = float(tight.replace(other, "").replace(mark, "."))
        return value if np.isfinite(value) else None
    united = _WITH_UNIT.fullmatch(cell)
    if united and read_unit(united[2]):
        return _number(united[1], mark)
    return None
