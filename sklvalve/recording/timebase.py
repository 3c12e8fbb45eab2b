# SPDX-License-Identifier: BSD-3-Clause
"""One time base: seconds from the first sample, out of seconds or ISO 8601 stamps."""

import re
from datetime import date, datetime, timedelta
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.columns import is_gap, to_numbers
from sklvalve.recording.errors import IMPORTED, InputError, shown

# s; thirty thousand years, and still told to a millisecond
_LONGEST = 1e12


class TimeBase(NamedTuple):
    """Time values as they were recorded, and seconds from the first of them."""

    stamps: NDArray
    seconds: NDArray[np.float64]


def read_time(values: object, where: str) -> TimeBase:
    """Turn a time column into seconds from its first sample.

    Parameters
    ----------
    values : array-like of shape (n,)
        Numbers [s], ISO 8601 texts, dates, or time differences. Rows may be missing between them, times may
        not. Dates keep their time zone.
    where : str
        File and column, for messages.

    Returns
    -------
    base : TimeBase
        `stamps` as recorded (float64, or object array of ISO texts) and `seconds` (float64).

    Raises
    ------
    InputError
        If a time is missing, is neither seconds nor ISO 8601, repeats or runs backwards, or if only some of
        the times carry an offset from UTC.
    """
    column = _as_texts(_as_array(values))
    if column.dtype.kind in "fiu" or _looks_numeric(column):
        stamps = to_numbers(column, where, "correct the time or drop the row")
        bad = np.flatnonzero(~np.isfinite(stamps))
        if len(bad):
            raise InputError(
                f"{where}, row {bad[0] + 1}: the time is missing or infinite; fill it in or drop the row"
            )
        with np.errstate(over="ignore"):
            base = TimeBase(stamps, stamps - stamps[0])
        far = np.flatnonzero(~(np.abs(base.seconds) <= _LONGEST))
        if len(far):
            raise InputError(
                f"{where}, row {far[0] + 1}: time {_shown(stamps[far[0]])} lies more than {_LONGEST:g} s "
                "from the first; correct it, and write times in seconds"
            )
    else:
        moments = [_moment(stamp, f"{where}, row {row}") for row, stamp in enumerate(column, start=1)]
        aware = moments[0].tzinfo is not None
        for row, moment in enumerate(moments, start=1):
            if (moment.tzinfo is not None) != aware:
                raise InputError(
                    f"{where}, row {row}: {shown(column[row - 1])} {'has no' if aware else 'has an'} offset "
                    f"from UTC, unlike row 1, {column[0]!r}; write all times with an offset or all without"
                )
        first = moments[0]
        base = TimeBase(column, np.array([(moment - first).total_seconds() for moment in moments]))
    _require_rising(base, where)
    return base


def seconds_at(value: object, first: object, offset: float) -> float:
    """Seconds on the recording's clock of a time given as the recording writes its own.

    Parameters
    ----------
    value : float, str, datetime or timedelta
        A time as in the time column; a number may come as text.
    first : float or str
        A stamp of the recording.
    offset : float
        Seconds of that stamp on the recording's clock [s].

    Returns
    -------
    seconds : float

    Raises
    ------
    InputError
        If the value is no such time.
    """
    if isinstance(value, bool | np.bool_ | bytes):
        like = first if isinstance(first, str) else float(first)  # type: ignore[arg-type]
        raise InputError(f"{shown(value)} is no time; give one like {like!r}")
    if isinstance(first, str):
        start = _moment(first, "the recording's first time")
        try:
            moment = _moment(value, "the time asked for")
        except InputError:
            raise InputError(
                f"{shown(value)} is no time of this recording; give one like {first!r}"
            ) from None
        if (moment.tzinfo is None) != (start.tzinfo is None):
            raise InputError(
                f"{shown(value)} and the recording differ in having an offset from UTC; give one like "
                f"{first!r}"
            )
        return offset + (moment - start).total_seconds()
    try:
        number = float(_seconds_of(value))  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not np.isfinite(number):
        raise InputError(
            f"{shown(value)} is no time of this recording; give a number of seconds like {_shown(first)}"
        )
    return offset + (number - float(first))  # type: ignore[arg-type]


def is_day(value: object) -> bool:
    """Whether a time is a date without a time of day."""
    if isinstance(value, str):
        return re.fullmatch(r"\d{4}-\d\d-\d\d", value.strip()) is not None
    return isinstance(value, date) and not isinstance(value, datetime)


def day_after(day: Any) -> str | date:
    """The day after one of `is_day`, as it is written; where the clock is set that day has other hours."""
    if isinstance(day, str):
        return (date.fromisoformat(day.strip()) + timedelta(days=1)).isoformat()
    return day + timedelta(days=1)


def _as_array(values: object) -> NDArray:
    """A column as an array; numpy knows no time zones, so dates that have one stay Python's."""
    of_polars, of_arrow = getattr(values, "dtype", None), getattr(values, "type", None)
    if getattr(of_polars, "time_zone", None) is not None and hasattr(values, "to_list"):
        return np.array(values.to_list(), dtype=object)
    if getattr(of_arrow, "tz", None) is not None and hasattr(values, "to_pylist"):
        return np.array(values.to_pylist(), dtype=object)
    return np.asarray(values)


def _as_texts(column: NDArray) -> NDArray:
    """Dates to ISO texts, time differences to seconds; numbers and texts as they are."""
    if column.dtype.kind == "m":
        return column / np.timedelta64(1, "s")
    if column.dtype.kind == "M":
        whole = column.astype("datetime64[s]")
        return np.datetime_as_string(whole if (whole == column).all() else column).astype(object)
    if column.dtype.kind in "OU":
        return np.array([_plain(item) for item in column], dtype=object)
    return column


def _plain(item: object) -> object:
    return item.isoformat() if isinstance(item, datetime) else _seconds_of(item)


def _seconds_of(item: object) -> object:
    """Seconds of a time difference; anything else as it is."""
    if isinstance(item, timedelta):
        return item.total_seconds()
    return item / np.timedelta64(1, "s") if isinstance(item, np.timedelta64) else item


def _looks_numeric(column: NDArray) -> bool:
    # ISO 8601 also has stamps of digits alone; a recording that counts seconds is far more usual
    for item in column:
        if not is_gap(item):
            try:
                float(item)
            except OverflowError:
                return True
            except (TypeError, ValueError):
                return False
            return True
    return True


def _moment(stamp: object, where: str) -> datetime:
    if is_gap(stamp):
        raise InputError(f"{where}: the time is missing; fill it in or drop the row")
    try:
        return datetime.fromisoformat(str(stamp).strip())
    except ValueError:
        pass
    more = ""
    if re.match(r"\d{1,2}[./]\d{1,2}[./]\d{2,4}", str(stamp)):
        more = f", which leaves no doubt between day and month, {IMPORTED} such times"
    raise InputError(
        f"{where}: {shown(stamp)} is no time; write seconds, or ISO 8601 such as 2024-06-28T14:35:00{more}"
    )


def _require_rising(base: TimeBase, where: str) -> None:
    step = np.diff(base.seconds)
    bad = np.flatnonzero(step <= 0.0)
    if not len(bad):
        return
    row = int(bad[0]) + 1
    before, after = _shown(base.stamps[row - 1]), _shown(base.stamps[row])
    if step[bad[0]] == 0.0:
        raise InputError(f"{where}, row {row + 1}: time {after} stands twice; keep one row for each time")
    # where runs stand one behind the other, sorted rows would mix them
    mend = "sort the rows by time, or part runs put one behind the other by sklvalve import"
    if isinstance(base.stamps[0], str) and step[bad[0]] >= -3600.0:
        mend = "sort the rows by time, or write the offset from UTC if the clocks were changed"
    raise InputError(f"{where}, row {row + 1}: time {after} comes after {before}; {mend}")


def _shown(stamp: object) -> str:
    return shown(stamp) if isinstance(stamp, str) else f"{stamp:.12g}"
