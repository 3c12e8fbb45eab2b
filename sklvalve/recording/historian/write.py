# SPDX-License-Identifier: BSD-3-Clause
"""A clean recording to a file that `read_recording` takes."""

import csv
import gzip
import io
from collections.abc import Mapping
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.reader import SUFFIXES
from sklvalve.recording.spreadsheet import marked

_DIGITS = ".10g"


def require_suffix(path: Path) -> None:
    """Refuse a name that tells no kind of recording.

    Raises
    ------
    InputError
    """
    if not path.name.lower().endswith(SUFFIXES):
        raise InputError(f"--out {path}: name the recording .csv, .csv.gz or .parquet")


def write_recording(path: Path, stamps: NDArray, columns: Mapping[str, NDArray[np.float64]]) -> None:
    """Write times and columns as .csv, .csv.gz or .parquet, by the name of the file.

    Parameters
    ----------
    path : Path
        Written in place: give a temporary name where that must not be seen half done.
    stamps : ndarray of shape (m,)
        Times, as seconds or texts; the column ``time``.
    columns : mapping of str to ndarray of shape (m,)
        NaN becomes an empty cell.

    Raises
    ------
    ImportError
        If pandas and pyarrow are missing, for .parquet.
    """
    name = path.name.lower()
    if name.endswith(".parquet"):
        _write_parquet(path, stamps, columns)
    elif name.endswith(".gz"):
        # no time of writing inside, so that the same export gives the same file
        with (
            path.open("wb") as raw,
            gzip.GzipFile(fileobj=raw, mode="wb", mtime=0, filename="") as packed,
            io.TextIOWrapper(packed, encoding="utf-8", newline="") as file,
        ):
            _write_csv(file, stamps, columns)
    else:
        with path.open("w", encoding="utf-8", newline="") as file:
            _write_csv(file, stamps, columns)


def _write_csv(file: IO[str], stamps: NDArray, columns: Mapping[str, NDArray[np.float64]]) -> None:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["time", *map(marked, columns)])
    times = [marked(stamp) if isinstance(stamp, str) else f"{stamp:.15g}" for stamp in stamps.tolist()]
    cells = [
        ["" if value != value else format(value, _DIGITS) for value in values.tolist()]
        for values in columns.values()
    ]
    writer.writerows(zip(times, *cells, strict=True))


def _write_parquet(path: Path, stamps: NDArray, columns: Mapping[str, NDArray[np.float64]]) -> None:
    try:
        import pandas

        pandas.DataFrame({"time": stamps, **columns}).to_parquet(path, index=False)
    except ImportError:
        raise ImportError('writing .parquet needs pandas and pyarrow: pip install "sklvalve[io]"') from None
