# SPDX-License-Identifier: BSD-3-Clause
"""Files of recordings to plain columns: the only place that needs pandas."""

import csv
import hashlib
import io
import re
import warnings
from collections import Counter
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from numpy.typing import NDArray

from sklvalve.recording.errors import IMPORTED, InputError, hint, shown
from sklvalve.recording.files import MOST_CELLS, MOST_COLUMNS, read_plain_file, size, unpack_gzip
from sklvalve.recording.parquet import read_parquet
from sklvalve.recording.spreadsheet import freed

SUFFIXES = (".csv", ".csv.gz", ".parquet")


class Columns(NamedTuple):
    """Columns of a file by name, and the checksum of the file as it lies on the disk."""

    columns: dict[str, NDArray]
    sha256: str


def read_columns(path: str | PathLike[str]) -> Columns:
    """Read the columns of a .csv, .csv.gz or .parquet file, unconverted.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    read : Columns

    Raises
    ------
    InputError
        If the file is missing, empty, of another kind than its name says, not UTF-8, or not a table.
    ImportError
        If pandas, or pyarrow for .parquet, is not installed.
    """
    file = Path(path)
    name = file.name.lower()
    if file.is_dir():
        raise InputError(f"{file}: this is a folder; give the file of the recording in it")
    if not name.endswith(SUFFIXES):
        raise InputError(
            f"{file}: expected a file named .csv, .csv.gz or .parquet; save the recording as one of these"
        )
    content = read_plain_file(file, missing="" if file.exists() else _nearest(file))
    if not content:
        raise InputError(f"{file}: the file is empty; export the recording again")
    if name.endswith(".parquet"):
        columns = read_parquet(file, content)
    else:
        columns = _read_csv(file, _unpack(file, content) if name.endswith(".gz") else content)
    if not columns or not len(next(iter(columns.values()))):
        raise InputError(f"{file}: there is a header but no row under it; export the recording again")
    return Columns(columns, hashlib.sha256(content).hexdigest())


def _nearest(file: Path) -> str:
    """A recording in the same folder that may be meant, or what to give."""
    if file.parent.is_dir():
        near = hint(file.name, [each.name for each in file.parent.iterdir() if each.name.endswith(SUFFIXES)])
        if near.startswith("did"):
            return near
    return "give the path of the recording"


def _pandas():
    try:
        import pandas
    except ImportError:
        raise ImportError('reading recordings needs pandas: pip install "sklvalve[io]"') from None
    return pandas


def _unpack(file: Path, content: bytes) -> bytes:
    text = unpack_gzip(file, content)
    if not text:
        raise InputError(f"{file}: the file is empty; export the recording again")
    return text


def _decode(file: Path, content: bytes) -> str:
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise InputError(f"{file}: the text is UTF-16; save the file as UTF-8")
    for magic, kind, name in (
        (b"\x1f\x8b", "gzip data", ".csv.gz"),
        (b"PAR1", "Parquet", ".parquet"),
        (b"PK\x03\x04", "a workbook or zip archive", ""),
    ):
        if content.startswith(magic):
            mend = f"name it {name}" if name else "export the table as CSV"
            raise InputError(f"{file}: the file is {kind}, not text; {mend}")
    if b"\x00" in content:
        place = content.index(b"\x00")
        raise InputError(f"{file}: byte {place} shows a binary file, not text; export the recording as CSV")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise InputError(f"{file}: line {line} is no UTF-8 text; save the file as UTF-8") from None


def _header(file: Path, text: str) -> list[str]:
    lines = (line for line in io.StringIO(text) if line.strip())
    try:
        header = [freed(name.strip()) for name in next(csv.reader(lines), [])]
    except csv.Error as error:
        raise InputError(
            f"{file}: the first line is no line of CSV ({error}); export the recording again"
        ) from None
    if not any(header):
        raise InputError(
            f"{file}: the file holds no column names in its first line; export the recording again"
        )
    if len(header) > MOST_COLUMNS:
        raise InputError(f"{file}: {len(header)} columns, more than {MOST_COLUMNS}; export fewer signals")
    twice = sorted(name for name, count in Counter(header).items() if name and count > 1)
    if twice:
        raise InputError(
            f"{file}: column {shown(twice[0])} stands twice in the first line; rename one of the two"
        )
    for mark, called in ((";", "semicolons"), ("\t", "tabs")):
        if len(header) == 1 and mark in header[0]:
            raise InputError(
                f"{file}: the columns are separated by {called}; separate them by commas, decimals by "
                f"points, {IMPORTED} such files"
            )
    return header


def _read_csv(file: Path, content: bytes) -> dict[str, NDArray]:
    pandas = _pandas()
    text = _decode(file, content)
    header = _header(file, text)
    cells = (text.count("\n") + 1) * len(header)
    if cells > MOST_CELLS:
        raise InputError(
            f"{file}: the file holds about {cells:.3g} cells in {size(len(content))}, more than "
            f"{MOST_CELLS}; split the recording"
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pandas.errors.ParserWarning)
            frame = pandas.read_csv(
                io.StringIO(text),
                index_col=False,
                low_memory=False,
                skipinitialspace=True,
            )
    except pandas.errors.ParserWarning:
        raise InputError(f"{file}: {_too_long(len(header))}") from None
    except pandas.errors.ParserError as error:
        raise InputError(f"{file}: {_uneven(str(error), len(header))}") from None
    return {name: frame.iloc[:, place].to_numpy() for place, name in enumerate(header)}


def _too_long(named: int, place: str = "the lines below it hold more") -> str:
    """A sentence of lines with more cells than the first one has names."""
    if named == 1:
        return (
            f"the file is no table: line 1 names one column, {place}; put the names of the columns into the "
            f"first line, separated by commas, with nothing above them, {IMPORTED} such files"
        )
    return (
        f"the table is uneven: line 1 names {named} columns, {place}; give every row {named} cells, "
        "and write decimals with a point"
    )


def _uneven(reason: str, named: int) -> str:
    """A sentence of a table whose rows differ in length, from what the parser says of it."""
    place = re.search(r"Expected \d+ fields in line (\d+), saw (\d+)", reason)
    if place:
        return _too_long(named, f"line {place[1]} holds {place[2]} cells")
    reason = " ".join(reason.split()).removeprefix("Error tokenizing data. C error: ")
    return f"the file is no table ({reason}); export the recording again"
