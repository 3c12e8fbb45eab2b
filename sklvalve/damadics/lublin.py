# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of the three real actuators of the Lublin sugar factory, from their day files."""

import copy
import gzip
import io
import warnings
import zlib
from pathlib import Path

import numpy as np

from sklvalve.damadics.days import day_of

_WIDTH, _DAY = 33, 86400.0
# columns of the files, counted from one, and their tags
_COLUMNS = {
    1: {
        "CV": (6, "LC51_03CV"),
        "P1": (2, "P51_05"),
        "P2": (3, "P51_06"),
        "T1": (4, "T51_01"),
        "X": (7, "LC51_03X"),
        "F": (5, "F51_01"),
    },
    2: {
        "CV": (22, "FC57_03CV"),
        "P1": (18, "P57_03"),
        "P2": (19, "P57_04"),
        "T1": (20, "T57_03"),
        "X": (23, "FC57_03X"),
        "F": (21, "FC57_03PV"),
    },
    3: {
        "CV": (28, "LC74_20CV"),
        "P1": (24, "P74_00"),
        "P2": (25, "P74_01"),
        "T1": (26, "T74_00"),
        "X": (29, "LC74_20X"),
        "F": (27, "F74_00"),
    },
}
_FLOW_UNIT = {1: "m3/h", 2: "m3/h", 3: "t/h"}
# role of each signal, and factor and offset to SI
_ROLES = {
    "CV": ("command", -0.01, 1.0),
    "P1": ("p1", 1e3, 0.0),
    "P2": ("p2", 1e3, 0.0),
    "T1": ("temperature", 1.0, 273.15),
    "X": ("opening", -0.01, 1.0),
}
_PER_FLOW = {"m3/h": 1.0 / 3600.0, "t/h": 1.0 / 3.6}
_SHEETS = {
    1: {
        "valve": {"tag": "LC51_03", "kv_rated": 550.0, "nominal_size": 200.0, "travel": 38.1},
        "fluid": {"density": 986.0},
        "actuator": {"supply_pressure": 140.0, "spring_range": [20.0, 100.0], "effective_area": 1290.0},
    },
    2: {
        "valve": {"tag": "FC57_03", "nominal_size": 100.0, "travel": 38.1},
        "actuator": {"supply_pressure": 140.0, "spring_range": [20.0, 100.0], "effective_area": 1290.0},
    },
    3: {
        "valve": {"tag": "LC74_20", "nominal_size": 50.0, "travel": 38.1},
        "fluid": {"name": "water"},
        "actuator": {"supply_pressure": 240.0, "spring_range": [40.0, 200.0], "effective_area": 290.0},
    },
}


def read_lublin(day_file, actuator, *, roles=False, stamps=False):
    """Read the six signals of an actuator from a day file.

    Parameters
    ----------
    day_file : str or path
        Tab-separated text without a header, 33 columns, one row a second, gaps written NaN;
        ``"09112001.txt"``, or compressed as ``"09112001.txt.gz"``.
    actuator : {1, 2, 3}
        1 is LC51_03 (thin juice into evaporator 1), 2 FC57_03 (thick juice out of evaporator 5), 3 LC74_20
        (feed water of the boiler).
    roles : bool, default=False
        Whether the columns are this package's roles in SI, and not the benchmark's signals as recorded.
    stamps : bool, default=False
        Whether times are stamps, of the day that the file is named after, and not seconds from midnight.

    Returns
    -------
    frame : pandas.DataFrame of shape (n, 7)
        As `make_damadics` gives it: ``time`` [s], as in `LUBLIN_EVENTS`, command ``CV`` and stem ``X`` [% of
        *closing*], ``P1``, ``P2`` [kPa], ``T1`` [degC] and ``F`` [m3/h; of actuator 3 t/h]. As roles:
        ``time`` [s], ``command`` and ``opening`` [1, 0 = shut], ``p1``, ``p2`` [Pa], ``temperature`` [K] and
        ``flow`` [m3/s; of actuator 3 kg/s]. Gaps are NaN. Whether the pressures are absolute is not said of
        the data.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no day file or a damaged one, there is no such actuator, or the file's name is no day where
        `stamps` need one.
    OSError
        If the file may not be read.
    ImportError
        If pandas is not installed.

    Warns
    -----
    UserWarning
        If seconds are missing between the first and the last; there are no rows for them.

    See Also
    --------
    lublin_sheet : Describes the frame to a `Recording`.
    events_of : The faults of a day.

    Examples
    --------
    >>> from sklvalve.damadics import events_of, lublin_sheet, read_lublin
    >>> from sklvalve.recording import Recording, Valve
    >>> event = events_of("2001-11-09", actuator=3)[0]
    >>> day = read_lublin("09112001.txt", actuator=3)  # doctest: +SKIP
    >>> around = day[day["time"].between(event.begins - 600.0, event.ends + 600.0)]  # doctest: +SKIP
    >>> recording = Recording.from_frame(around, Valve.from_dict(lublin_sheet(3)))  # doctest: +SKIP
    """
    columns, path = _of_actuator(_COLUMNS, actuator), Path(day_file)
    day = day_of(path.name.removesuffix(".gz"))
    if stamps and day is None:
        raise ValueError(
            f"Expected a file named after its day, such as 09112001.txt, got {path.name!r}; rename it, or "
            "leave stamps out."
        )
    pandas, table = _table(path)
    time = _seconds(pandas, table, path)
    if stamps:
        time = pandas.Timestamp(day) + pandas.to_timedelta(time, unit="s")
    signals = {name: _numbers(pandas, table, *place, path) for name, place in columns.items()}
    if roles:
        signals = _in_roles(signals, _FLOW_UNIT[actuator])
    return pandas.DataFrame({"time": time, **signals})


def lublin_sheet(actuator):
    """What is known of an actuator and of its recordings, in the structure of a valve.toml.

    Parameters
    ----------
    actuator : {1, 2, 3}

    Returns
    -------
    sheet : dict of dict
        What ``sklvalve.Valve.from_dict`` takes, for frames of `read_lublin` as recorded. Only what is told of
        the valves themselves: for the model that the benchmark has of actuator 3 see `valve_sheet`.

    Raises
    ------
    ValueError
        If there is no such actuator.

    Notes
    -----
    Source: the benchmark's specifications of actuators (v1.02) and of sugar processes (rev. 2.0), 2002.

    Examples
    --------
    >>> from sklvalve.damadics import lublin_sheet
    >>> lublin_sheet(3)["recording"]["flow"]
    {'column': 'F', 'unit': 't/h'}
    """
    sheet = copy.deepcopy(_of_actuator(_SHEETS, actuator))
    sheet["actuator"] |= {"fail": "open", "positioner": True}
    sheet["recording"] = {
        "time": "time",
        "command": {"column": "CV", "unit": "%", "sense": "closing"},
        "opening": {"column": "X", "unit": "%", "sense": "closing"},
        "p1": {"column": "P1", "unit": "kPa"},
        "p2": {"column": "P2", "unit": "kPa"},
        "temperature": {"column": "T1", "unit": "degC"},
        "flow": {"column": "F", "unit": _FLOW_UNIT[actuator]},
    }
    return sheet


def _of_actuator(table, actuator):
    if actuator not in tuple(table):
        raise ValueError(f"actuator must be 1, 2 or 3, got {actuator!r}.")
    return table[actuator]


def _in_roles(signals, flow_unit):
    to_si = _ROLES | {"F": ("flow", _PER_FLOW[flow_unit], 0.0)}
    return {role: factor * signals[name] + offset for name, (role, factor, offset) in to_si.items()}


def _table(path):
    """pandas, and the file as it is, columns counted from zero."""
    if not path.is_file():
        raise FileNotFoundError(f"Expected the day file {str(path)!r}, which is not there; name one that is.")
    try:
        import pandas
    except ImportError:
        raise ImportError(
            'Day files are read as data frames; install pandas with: pip install "sklvalve[io]"'
        ) from None
    text = _text(path)
    _require_whole(text, path)
    try:
        rows = io.BytesIO(text)
        table = pandas.read_csv(
            rows, sep="\t", header=None, skipinitialspace=True, low_memory=False, quoting=3
        )
    except (pandas.errors.ParserError, UnicodeDecodeError) as error:
        raise ValueError(
            f"Expected text in {path}, a day file as it was published, got what cannot be read: {error}."
        ) from None
    return pandas, table


def _text(path):
    """The file's bytes, unpacked."""
    try:
        packed = path.read_bytes()
    except OSError as error:
        raise OSError(
            f"The day file {str(path)!r} cannot be read ({error.strerror}); allow it, or name another."
        ) from None
    try:
        return gzip.decompress(packed) if path.suffix == ".gz" else packed
    except (EOFError, zlib.error, OSError) as error:
        raise ValueError(
            f"Expected a whole gzip file in {path}, got one that is cut or damaged ({error}); fetch it again."
        ) from None


def _require_whole(text, path):
    """ValueError unless every row has all columns: pandas fills a short one with gaps."""
    rows = text.splitlines() or [b""]
    for number, row in enumerate(rows, 1):
        if (many := row.count(b"\t") + 1) != _WIDTH and (row.strip() or number == 1):
            raise ValueError(
                f"Expected {_WIDTH} columns between tabs in row {number} of {path}, got {many}; give a day "
                "file as it was published, plain or as .gz, and not cut."
            )


def _seconds(pandas, table, path):
    seconds = _numbers(pandas, table, 1, "time", path)
    before = np.concatenate([[-1.0], seconds[:-1]])
    wrong = np.flatnonzero(~((seconds > before) & (seconds >= 0.0) & (seconds < _DAY)))
    if len(wrong):
        at = wrong[0]
        after = f" after {before[at]:g}" if at else ""
        raise ValueError(
            f"Expected seconds from midnight in column 1 of {path}, each later than the one before, got "
            f"{seconds[at]:g}{after} in row {at + 1}; give a day file as it was published."
        )
    gaps = np.flatnonzero(np.diff(seconds) > 1.0)
    if len(gaps):
        lacking = np.diff(seconds)[gaps].sum() - len(gaps)
        warnings.warn(
            f"{path} lacks {lacking:g} seconds at {len(gaps)} places, first after {seconds[gaps[0]]:g} s; "
            "there are no rows for them.",
            stacklevel=3,
        )
    return seconds


def _numbers(pandas, table, number, tag, path):
    """Column by its number from one, as floats."""
    column = table[number - 1]
    values = pandas.to_numeric(column, errors="coerce")
    text = np.flatnonzero((values.isna() & column.notna()) | np.isinf(values))
    if len(text):
        raise ValueError(
            f"Expected a number or NaN in row {text[0] + 1}, column {number} ({tag}) of {path}, got "
            f"{str(column[text[0]])!r}."
        )
    return values.to_numpy(float)
