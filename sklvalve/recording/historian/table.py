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
from sklvalve.recording.historian.heading import find_heading, holds_values
from sklvalve.recording.historian.moments import looks_like_time
from sklvalve.recording.historian.text import ExportText
from sklvalve.recording.spreadsheet import freed

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


def read_table(
    read: ExportText, *, skip_rows: int = 0, header: int | None = None, time_column: str | None = None
) -> Table:
    """Find the table in the text of an export.

    Parameters
    ----------
    read : ExportText
    skip_rows : int, default=0
        Lines at the beginning of the file that are no part of it.
    header : int or None, default=None
        Line of the file, counted from 1, in which the names stand; 0 where there are none; None finds it.
    time_column : str or None, default=None
        Name of the column of the times, by which the line of the names is known too.

    Returns
    -------
    table : Table

    Raises
    ------
    InputError
        If no separator divides the lines into columns, a row holds more cells than there are names, no row
        holds values, or `skip_rows` and `header` leave nothing.
    """
    separator, text = _separator(read, skip_rows)
    rows = _cells(read.file, text, separator, skip_rows)
    if not rows:
        raise InputError(
            f"{read.file}: its lines hold {SEPARATORS.get(separator, 'separators')} and nothing between "
            "them; export again"
        )
    heading = find_heading(read.file, rows, header=header, time_column=time_column)
    first, names = heading.first, heading.names
    filled = len(rows[first][1]) - next((k for k, cell in enumerate(reversed(rows[first][1])) if cell), 0)
    if heading.sure and len(names) < filled:
        raise InputError(
            f"{read.file}, line {rows[first][0]}: {_too_many(rows[first][1], len(names), separator)}"
        )
    width = max(heading.width, len(names))
    # files put one behind the other repeat what stands above their rows
    above = {tuple(cells) for _, cells in rows[:first]}
    kept, lines, skipped = [], [], 0
    for line, cells in rows[first:]:
        if tuple(cells) in above and not holds_values(cells):
            skipped += 1
            continue
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
        units=(heading.units + pad)[:width],
        columns=[list(column) for column in zip(*kept, strict=True)],
        lines=lines,
        above=heading.above,
        skipped=skipped,
    )


def _separator(read: ExportText, skip_rows: int) -> tuple[str, str]:
    """Separator, and the text without a first line that only names it."""
    lines = list(islice(io.StringIO(read.text, newline=None), min(skip_rows, len(read.text)) + 2 * _SAMPLE))
    if skip_rows >= len(lines):
        raise InputError(
            f"--skip-rows {skip_rows}: {read.file} has {len(lines)} lines; leave out fewer, or the option"
        )
    some = [line.rstrip("\n") for line in lines[skip_rows:] if line.strip()]
    if not some:
        raise InputError(f"--skip-rows {skip_rows}: {read.file} holds only blank lines below; skip fewer")
    told = re.match(r"\ufeff?\"?sep=(\t|[^\w\s\"'])\"?\r?\n", read.text)
    if told:
        return told[1], "\n" + read.text[told.end() :]
    # no cell of a table comes near this; a file without line ends would be read as one
    sample = [line for line in some if len(line) < _LONGEST_LINE][:_SAMPLE]
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


def _cells(file: Path, text: str, separator: str, skip_rows: int) -> list[tuple[int, list[str]]]:
    stream = io.StringIO(text, newline="")
    # left out before cells are made of them: a quote that stands alone there would swallow the table
    for _ in range(skip_rows):
        stream.readline()
    reader = csv.reader(stream, delimiter=separator, skipinitialspace=True)
    rows = []
    try:
        for cells in reader:
            if len(cells) > MOST_COLUMNS:
                raise InputError(
                    f"{file}, line {skip_rows + reader.line_num}: {len(cells)} cells, more than "
                    f"{MOST_COLUMNS}; export fewer signals"
                )
            stripped = [cell.strip() for cell in cells]
            if any(stripped):
                rows.append((skip_rows + reader.line_num, stripped))
    except csv.Error as error:
        raise InputError(
            f"{file}, line {skip_rows + reader.line_num}: this is no line of a table ({error}); export it "
            "again"
        ) from None
    return rows


def _too_many(cells: list[str], width: int, separator: str) -> str:
    told = f"{len(cells)} cells, but the table has {width} columns"
    if separator == ",":
        return f"{told}; if decimals are commas too, export with semicolons between the columns"
    return f"{told}; correct the line, or export again"


def _shown(line: str) -> str:
    return repr(line if len(line) <= 60 else f"{line[:57]}...")
