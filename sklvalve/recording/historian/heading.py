# SPDX-License-Identifier: BSD-3-Clause
"""Where the names of the columns stand, and which lines above and under them are titles or units."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sklvalve.recording.errors import InputError
from sklvalve.recording.historian.decimals import looks_numeric
from sklvalve.recording.historian.moments import looks_like_clock, looks_like_time
from sklvalve.recording.tags import read_time_name, read_unit, split_unit

_SAMPLE = 400
# lines in which the names are looked for; rows looked at under them; lines of units and words between them
_TOP, _UNDER, _BETWEEN = 200, 20, 5
Rows = Sequence[tuple[int, list[str]]]


@dataclass(frozen=True)
class Heading:
    """Names and units of the columns.

    `first` is the place of the first row of values, `width` the number of its columns, `above` the number of
    lines above the names; `sure` tells whether the names are those of all columns beyond doubt.
    """

    names: list[str]
    units: list[str]
    first: int
    width: int
    above: int
    sure: bool


def find_heading(file: Path, rows: Rows, *, header: int | None, time_column: str | None) -> Heading:
    """Find the names of the columns and the first row of values.

    The names are the line with that of a time over cells that hold times. Where no line has one, they are
    the first well filled line above the first of many rows of values.

    Parameters
    ----------
    file : Path
        For messages.
    rows : sequence of (int, list of str)
        Line of the file and its cells; blank lines left out.
    header : int or None
        Line in which the names stand; 0 where there are none.
    time_column : str or None
        Name of the column of the times.

    Returns
    -------
    heading : Heading

    Raises
    ------
    InputError
        If no row holds values, or the line that is asked for holds no names.
    """
    if header is None:
        named, column = _named(rows, time_column)
    else:
        named = _asked(file, rows, header) if header else None
        names_of_time = [] if named is None else [_is_time(cell, time_column) for cell in rows[named][1]]
        column = names_of_time.index(True) if True in names_of_time else None
    first = _first_row(rows, named, column)
    if first is None:
        raise InputError(
            f"{file}: there is a header but no row with a time and a value under it; export again, or "
            "name a longer time range"
        )
    usual = Counter(len(cells) for _, cells in rows[first : first + _SAMPLE]).most_common(1)[0][0]
    width = max(usual, len(rows[first][1]))
    place = _above(rows, first, width) if named is None and header is None else named
    if place is None:
        return Heading([], [], first, width, first, sure=False)
    names = list(rows[place][1])
    while len(names) > width and not names[-1]:
        names.pop()
    units: list[str] = []
    for _, cells in rows[place + 1 : first]:
        filled = [cell for cell in cells if cell and not _is_time(cell)]
        if filled and 2 * sum(read_unit(cell) is not None for cell in filled) >= len(filled):
            units = cells
    return Heading(names, units, first, width, place, sure=named is not None)


def holds_values(cells: list[str], column: int | None = None) -> bool:
    """Whether a line is a row of a time, in its column where that is known, and values, or of values."""
    filled = [cell for cell in cells if cell]
    if len(filled) < 2 or any(_is_time(cell) for cell in filled):
        return False
    if column is not None and column < len(cells) and looks_numeric(cells[column]):
        return True
    return any(looks_like_time(cell) for cell in filled) or 2 * sum(map(looks_numeric, filled)) > len(filled)


def _asked(file: Path, rows: Rows, header: int) -> int:
    place = next((place for place, (line, _) in enumerate(rows) if line == header), None)
    if place is None:
        raise InputError(
            f"--header {header}: line {header} of {file} is blank, skipped or not there; give the line in "
            "which the names of the columns stand"
        )
    return place


def _named(rows: Rows, time_column: str | None) -> tuple[int | None, int | None]:
    """First line with the name of a time, under which times stand, and the column of these."""
    for place, (_, cells) in enumerate(rows[:_TOP]):
        # a title may hold such a word as well, with a time beside it
        if any(looks_like_time(cell) or looks_like_clock(cell) for cell in cells):
            continue
        under = rows[place + 1 : place + 1 + _UNDER]
        filled = sum(map(bool, cells))
        for column, cell in enumerate(cells):
            if not _is_time(cell, time_column):
                continue
            hits = [row for _, row in under if column < len(row) and _may_be_time(row[column])]
            soon = any(column < len(row) and _may_be_time(row[column]) for _, row in under[:_BETWEEN])
            usual = sorted(sum(map(bool, row)) for row in hits)[len(hits) // 2] if hits else 0
            if soon and 2 * len(hits) >= len(under) and filled >= 2 and 2 * filled >= usual:
                return place, column
    return None, None


def _first_row(rows: Rows, named: int | None, column: int | None) -> int | None:
    """First row of values under the names; without names the first of many in a row of one width."""
    if named is not None:
        below = range(named + 1, len(rows))
        return next((place for place in below if holds_values(rows[place][1], column)), None)
    places = [place for place, (_, cells) in enumerate(rows[: _TOP + _UNDER]) if holds_values(cells)]
    for place in places:
        under = [cells for _, cells in rows[place : place + _UNDER]]
        alike = [cells for cells in under if holds_values(cells)]
        usual = sorted(sum(map(bool, cells)) for cells in alike)[len(alike) // 2]
        at_once = all(holds_values(cells) for cells in under[:_BETWEEN])
        if at_once and 2 * len(alike) >= len(under) and 2 * sum(map(bool, under[0])) >= usual:
            return place
    return places[0] if places else None


def _above(rows: Rows, first: int, width: int) -> int | None:
    """Line that may hold names above the first row: the first that is as wide, and filled with words."""
    for least in (0.5, 0.0):
        for place, (_, cells) in enumerate(rows[:first]):
            filled = [cell for cell in cells if cell]
            words = not any(looks_like_time(cell) or looks_numeric(cell) for cell in filled)
            if len(cells) >= max(2, width - 1) and len(filled) >= max(2, least * width) and words:
                return place
    return None


def _is_time(cell: str, time_column: str | None = None) -> bool:
    if read_time_name(cell) is not None:
        return True
    if time_column is None:
        return False
    return time_column.strip().casefold() in (cell.casefold(), split_unit(cell)[0].casefold())


def _may_be_time(cell: str) -> bool:
    return looks_numeric(cell) or looks_like_time(cell)
