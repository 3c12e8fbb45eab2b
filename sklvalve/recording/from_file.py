# SPDX-License-Identifier: BSD-3-Clause
"""From a file, and what is known of the valve, to a recording."""

from os import PathLike

from sklvalve.recording.errors import InputError
from sklvalve.recording.reader import read_columns
from sklvalve.recording.recording import Recording
from sklvalve.recording.valve import Valve, read_valve

_MIN_ROWS = 10


def read_recording(path: str | PathLike[str], valve: Valve | str | PathLike[str]) -> Recording:
    """Read a recording, its signals by role and in SI.

    Parameters
    ----------
    path : str or path-like
        A .csv, .csv.gz or .parquet file; UTF-8, commas between columns, their names in the first line. Empty
        cells, ``NaN`` and ``NA`` are gaps and stay gaps; missing rows are not filled in.
    valve : Valve, str or path-like
        What is known of the valve, or the path of its valve.toml.

    Returns
    -------
    recording : Recording

    Raises
    ------
    InputError
        With one sentence that names file, place and mend: a missing file or column, text or an infinite value
        among the numbers, times that repeat or run backwards, a column of gaps only, p2 above p1 throughout,
        values far outside what their unit allows, a binary file, fewer than 10 rows.
    ImportError
        If pandas is not installed.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from sklvalve.recording import Valve, read_recording
    >>> roles = {"command": {"column": "CV", "unit": "%"}, "flow": {"column": "F", "unit": "m3/h"}}
    >>> valve = Valve.from_dict({"recording": {"time": "t", **roles}})
    >>> rows = "".join(f"{t},{50 + t},36\\n" for t in range(12))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "recording.csv"
    ...     _ = path.write_text("t,CV,F\\n" + rows)
    ...     recording = read_recording(path, valve)
    >>> len(recording), float(recording["command"][0]), float(recording["flow"][0])
    (12, 0.5, 0.01)
    """
    sheet = valve if isinstance(valve, Valve) else read_valve(valve)
    if not sheet.roles:
        raise InputError(
            f"{sheet.source}: [recording] names no signal; add a section such as [recording.command] "
            "with column and unit"
        )
    read = read_columns(path)
    rows = len(next(iter(read.columns.values())))
    if rows < _MIN_ROWS:
        raise InputError(f"{path}: too few rows for a recording, {rows}; give at least {_MIN_ROWS}")
    return Recording.from_columns(read.columns, sheet, str(path), read.sha256)
