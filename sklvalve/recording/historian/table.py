# SPDX-License-Identifier: BSD-3-Clause
"""From text to a table: what separates the columns, where their names stand, and the rows under them."""

import csv
import io
import re
from collections import Counter
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from sklvalve.recording.errors import InputError
from sklvalve.recording.files import MOST_COLUMNS
from sklvalve.recording.historian.decimals import looks_numeric
from sklvalve.recording.historian.moments import looks_like_time
from sklvalve.recording.historian.text import ExportText
from sklvalve.recording.spreadsheet import freed
from sklvalve.recording.tags import read_unit, words

_SAMPLE = 400
_LONGEST_LINE = 1_000_000
SEPARATORS = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas"}


@dataclass(frozen=True)
class Table:
    """Cells of an export, all of one width.

    Parameters
    ----------
    file : Path
    separator : str
        What stands between columns.
    names, units : list of str
        Of each column; empty where none is given. `names` holds empty texts where the file has no header.
    columns : list of list of str
        Cells by column, without blanks around them.
    lines : list of int
        Line of the file in which each row stands.
    above, skipped : int
        Lines above the names, and lines among or under the rows that are none.
    """

    file: Path
    separator: str
    names: list[str]
    units: list[str]
    columns: list[list[str]]
    lines: list[int]
    above: int
    skipped: int

    def place(self, row: int) -> str:
        """File and line of a row, for messages."""
        return f"{self.file}, line {self.lines[row]}"


def read_table(read: ExportText) -> Table:
    """Find the table in the text of an export.

    Parameters
    ----------
    read : ExportText

    Returns
    -------
    table : Table

    Raises
    ------
    InputError
        If no separator divides the lines into columns, a row holds more cells than there are names, or no row
        holds values.
    """
    separator, text = _separator(read)
    rows = _cells(read.file, text, separator)
    if not rows:
        raise InputError(
            f"{read.file}: its lines hold {SEPARATORS.get(separator, 'separators')} and nothing between "
            "them; export again"
        )
    width = Counter(len(cells) for _, cells in rows[:_SAMPLE]).most_common(1)[0][0]
    first = next((place for place, (_, cells) in enumerate(rows) if _holds_values(cells)), None)
    if first is None:
        raise InputError(
            f"{read.file}: there is a header but no row with a time and a value under it; export again, or "
            "name a longer time range"
        )
    _require_all_named(read.file, rows[: first + 1], separator)
    names, units, above = _header(rows[:first], max(width, len(rows[first][1])))
    width = max(width, len(names))
    kept, lines, skipped = [], [], 0
    for line, cells in rows[first:]:
        while len(cells) > width and not cells[-1]:
            cells.pop()
        if len(cells) > width:
            raise InputError(f"{read.file}, line {line}: {_too_many(cells, width, separator)}")
        # a dashed line, or what the exporting program says at the end
        if width > 1 and sum(map(bool, cells)) < 2 and not looks_like_time(next(filter(None, cells), "")):
            skipped += 1
            continue
        kept.append(cells + [""] * (width - len(cells)))
        lines.append(line)
    pad = [""] * width
    return Table(
        file=read.file,
        separator=separator,
        names=[freed(name) for name in (names + pad)[:width]],
        units=(units + pad)[:width],
        columns=[list(column) for column in zip(*kept, strict=True)],
        lines=lines,
        above=above,
        skipped=skipped,
    )


def _separator(read: ExportText) -> tuple[str, str]:
    """Separator, and the text without a first line that only names it."""
    told = re.match(r"\ufeff?\"?sep=(\t|[^\w\s\"'])\"?\r?\n", read.text)
    if told:
        return told[1], "\n" + read.text[told.end() :]
    lines = list(islice(io.StringIO(read.text, newline=None), 2 * _SAMPLE))
    # no cell of a table comes near this; a file without line ends would be read as one
    sample = [line.rstrip("\n") for line in lines if line.strip() and len(line) < _LONGEST_LINE][:_SAMPLE]
    if not sample:
        raise InputError(
            f"{read.file}: its lines are longer than {_LONGEST_LINE} letters, which is no table; export the "
            "table as CSV, a row a line"
        )
    for mark in SEPARATORS:
        counts = Counter(_width(line, mark) for line in sample)
        counts.pop(0, None)  # a cell longer than any
        counts.pop(1, None)
        # what is not in half of the lines separates nothing; above a table there may be words
        if counts and counts.most_common(1)[0][1] >= 0.5 * len(sample):
            return mark, read.text
    raise InputError(
        f"{read.file}: no tabs, semicolons, bars or commas divide its lines into columns (line 1 is "
        f"{_shown(sample[0])}); export the table as CSV"
    )


def _width(line: str, separator: str) -> int:
    try:
        return max((len(cells) for cells in csv.reader([line], delimiter=separator)), default=0)
    except csv.Error:
        return 0


def _cells(file: Path, text: str, separator: str) -> list[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True)
    rows = []
    try:
        for cells in reader:
            if len(cells) > MOST_COLUMNS:
                raise InputError(
                    f"{file}, line {reader.line_num}: {len(cells)} cells, more than {MOST_COLUMNS}; export "
                    "fewer signals"
                )
            stripped = [cell.strip() for cell in cells]
            if any(stripped):
                rows.append((reader.line_num, stripped))
    except csv.Error as error:
        raise InputError(
            f"{file}, line {reader.line_num}: this is no line of a table ({error}); export it again"
        ) from None
    return rows


def _holds_values(cells: list[str]) -> bool:
    filled = [cell for cell in cells if cell]
    if len(filled) < 2 or any(cell.casefold() in words.TIME for cell in filled):
        return False
    return any(looks_like_time(cell) for cell in filled) or 2 * sum(map(looks_numeric, filled)) > len(filled)


def _require_all_named(file: Path, rows: list[tuple[int, list[str]]], separator: str) -> None:
    """The first row of values must not be wider than the line of names above it."""
    *above, (line, cells) = rows
    filled = len(cells) - next((k for k, cell in enumerate(reversed(cells)) if cell), 0)
    named = [names for _, names in above if len(names) > 1 and any(_is_time_word(name) for name in names)]
    if named and len(named[-1]) < filled:
        raise InputError(f"{file}, line {line}: {_too_many(cells, len(named[-1]), separator)}")


def _header(rows: list[tuple[int, list[str]]], width: int) -> tuple[list[str], list[str], int]:
    """Names and units out of the lines above the values; what stands above the names is a heading."""
    wide = [place for place, (_, cells) in enumerate(rows) if len(cells) >= max(2, width - 1)]
    if not wide:
        return [], [], len(rows)
    named = [place for place in wide if any(_is_time_word(cell) for cell in rows[place][1])]
    place = named[-1] if named else wide[0]
    names = rows[place][1]
    while len(names) > width and not names[-1]:
        names.pop()
    units: list[str] = []
    for _, cells in rows[place + 1 :]:
        filled = [cell for cell in cells if cell and not _is_time_word(cell)]
        if filled and 2 * sum(read_unit(cell) is not None for cell in filled) >= len(filled):
            units = cells
    return names, units, place


def _is_time_word(cell: str) -> bool:
    return re.sub(r"\W+", "", re.sub(r"[\[(].*", "", cell)).casefold() in words.TIME


def _too_many(cells: list[str], width: int, separator: str) -> str:
    told = f"{len(cells)} cells, but the table has {width} columns"
    if separator == ",":
        return f"{told}; if decimals are commas too, export with semicolons between the columns"
    return f"{told}; correct the line, or export again"


def _shown(line: str) -> str:
    return repr(line if len(line) <= 60 else f"{line[:57]}...")
