# SPDX-License-Identifier: BSD-3-Clause
"""Published and benchmark recordings, read from a folder that the caller names. Nothing is downloaded."""

import json
import tomllib
from pathlib import Path

from sklearn.utils import Bunch

WATERSAFE_VALVES = ("VA_A1", "VA_C1", "VA_C3")


def load_watersafe(folder):
    """Laboratory water network: commands, flows and levels of three valves over 9,700 s.

    Parameters
    ----------
    folder : str or path
        Holds recording.csv and a valve.toml per valve (VA_A1.toml, VA_C1.toml, VA_C3.toml).

    Returns
    -------
    data : :class:`~sklearn.utils.Bunch`
        `frame` : DataFrame, one row a second: t_s [s], VA_* [1], FS_* [cm3/s], PS_* and LS_* [cm of water];
        `valves` : dict of the parsed valve.toml by tag.

    Raises
    ------
    FileNotFoundError
        If a file is missing.

    Notes
    -----
    Vrachimis et al., IFAC-PapersOnLine 55(6), 2022, doi 10.1016/j.ifacol.2022.07.202.

    Examples
    --------
    >>> from sklvalve.datasets import load_watersafe
    >>> load_watersafe("no such folder")
    Traceback (most recent call last):
    ...
    FileNotFoundError: Expected the file recording.csv in 'no such folder'; name the folder that holds it.
    """
    frame = _frame(folder, "recording.csv", ("t_s",))
    return Bunch(frame=frame, valves={tag: _toml(folder, f"{tag}.toml") for tag in WATERSAFE_VALVES})


def load_concealed(folder, name):
    """One record of a concealed-effect benchmark.

    Parameters
    ----------
    folder : str or path
        Holds one folder per record.
    name : str
        The record's folder.

    Returns
    -------
    record : :class:`~sklearn.utils.Bunch`
        `frame` and `later` : DataFrame with time [s], CV, X [%], P1, P2 [kPa], T1 [degC], F [m3/h]; `valve`
        : dict of valve.toml; `truth` : dict; `flow_without_noise` : DataFrame of time and flow over both;
        `recording_file` and `valve_file` : paths, for readers that want the files.

    Raises
    ------
    FileNotFoundError
        If the record or one of its files is missing; the message lists the records that are there.
    """
    record = Path(folder) / str(name)
    if not record.is_dir():
        there = ", ".join(sorted(path.parent.name for path in Path(folder).glob("*/truth.json"))) or "none"
        raise FileNotFoundError(
            f"Expected a record named {str(name)!r} in {str(folder)!r}; the records there are: {there}."
        )
    signals = ("time", "CV", "F")
    return Bunch(
        frame=_frame(record, "recording.csv.gz", signals),
        later=_frame(record, "later.csv.gz", signals),
        flow_without_noise=_frame(record, "flow_without_noise.csv.gz", ("time", "flow")),
        valve=_toml(record, "valve.toml"),
        truth=json.loads(_path(record, "truth.json").read_text(encoding="utf-8")),
        recording_file=record / "recording.csv.gz",
        valve_file=record / "valve.toml",
    )


def load_refinery_loops(folder):
    """Windows of refinery control loops with the plant's own verdict on stiction.

    Parameters
    ----------
    folder : str or path
        Holds index.csv and loops.csv.gz.

    Returns
    -------
    data : :class:`~sklearn.utils.Bunch`
        `index` : DataFrame, one row a loop: id, stiction (0 or 1), tag, dt_s [s], `dup_group` (equal
        numbers are the same samples again: split by tag, never by row); `frame` : DataFrame of id, t (time
        stamp), op [%], pv and sp [loop's unit], auto.

    Raises
    ------
    FileNotFoundError
        If a file is missing.

    Notes
    -----
    doi 10.2139/ssrn.5265092, Apache-2.0.
    """
    index = _frame(folder, "index.csv", ("id", "stiction", "tag"))
    frame = _frame(folder, "loops.csv.gz", ("id", "t", "op", "pv"), parse_dates=["t"])
    return Bunch(index=index, frame=frame)


def load_belimo(folder):
    """Electric valve actuator at about 20 Hz: command, position and torque of several runs.

    Parameters
    ----------
    folder : str or path
        Holds campaign_20hz.csv.gz.

    Returns
    -------
    data : :class:`~sklearn.utils.Bunch`
        `frame` : DataFrame with `timestamp`, `test_id` (one run each), `setpoint_position_%` and
        `feedback_position_%` [%], `motor_torque_Nmm` [N mm], `internal_temperature_deg_C` [degC], and
        `time`, seconds from each run's first row.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    """
    frame = _frame(folder, "campaign_20hz.csv.gz", ("timestamp", "test_id", "setpoint_position_%"))
    import pandas as pd

    # whole seconds are written without their fraction, so no single format fits all rows
    frame["timestamp"] = pd.to_datetime(frame["timestamp"], format="ISO8601", utc=True)
    start = frame.groupby("test_id")["timestamp"].transform("min")
    frame["time"] = (frame["timestamp"] - start).dt.total_seconds()
    return Bunch(frame=frame)


def _path(folder, name):
    path = Path(folder) / name
    if not path.is_file():
        raise FileNotFoundError(
            f"Expected the file {name} in {str(folder)!r}; name the folder that holds it."
        )
    return path


def _frame(folder, name, columns, **options):
    path = _path(folder, name)
    try:
        import pandas as pd
    except ImportError:
        raise ImportError(
            'Recordings are read as data frames; install pandas with: pip install "sklvalve[io]"'
        ) from None
    header = pd.read_csv(path, nrows=0).columns
    missing = [column for column in columns if column not in header]
    if missing:
        raise ValueError(f"Expected the column {missing[0]} in {path}; it has {', '.join(header)}.")
    return pd.read_csv(path, **options)


def _toml(folder, name):
    return tomllib.loads(_path(folder, name).read_text(encoding="utf-8"))
