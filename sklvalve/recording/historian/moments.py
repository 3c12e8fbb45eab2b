# SPDX-License-Identifier: BSD-3-Clause
"""Times as an export writes them, to microseconds: local, with an offset from UTC, or counted in seconds."""

import re
import unicodedata
from collections.abc import Callable, Iterable
from datetime import date
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError, shown
from sklvalve.recording.historian.decimals import looks_numeric

SECOND = 1_000_000  # microseconds
HOUR = 3600 * SECOND
DAY = 24 * HOUR
_EPOCH = date(1970, 1, 1).toordinal()
_EXCEL_EPOCH = 25569.0  # serial day of 1970-01-01

_CLOCK = (
    r"(?P<H>\d{1,2}):(?P<M>\d{2})(?::(?P<S>\d{2})(?:[.,:](?P<f>\d{1,9}))?)?(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
    r"(?:\s*(?P<zone>[Zz]|[+-]\d{2}(?::?\d{2})?|[A-Z]{3,4}))?"
)
_SHAPES = tuple(
    re.compile(form)
    for form in (
        rf"(?P<y>\d{{4}})(?P<s>[-/.])(?P<m>\d{{1,2}})(?P=s)(?P<d>\d{{1,2}})(?:[T ,_]+{_CLOCK})?",
        rf"(?P<a>\d{{1,2}})(?P<s>[-/.])(?P<b>\d{{1,2}})(?P=s)(?P<y>\d{{4}}|\d{{2}})(?:[T ,_]+{_CLOCK})?",
        rf"(?P<d>\d{{1,2}})[-. /]{{0,2}}(?P<name>[^\W\d_]{{3,12}})\.?[-. /,]{{0,2}}(?P<y>\d{{4}}|\d{{2}})"
        rf"(?:[T ,_]+{_CLOCK})?",
        rf"(?P<name>[^\W\d_]{{3,12}})\.?\s+(?P<d>\d{{1,2}}),?\s+(?P<y>\d{{4}})(?:[T ,_]+{_CLOCK})?",
        r"(?P<y>(?:19|20)\d{2})(?P<m>\d{2})(?P<d>\d{2})[T _-]?(?P<H>\d{2})(?P<M>\d{2})(?P<S>\d{2})",
    )
)
_CLOCK_ALONE = re.compile(_CLOCK)
_MONTHS = {
    name: number
    for number, names in enumerate(
        (
            "jan sty ene", "feb lut fev", "mar", "apr kwi avr abr", "may mai maj", "jun cze juin",
            "jul lip juil", "aug sie aou ago", "sep wrz", "oct okt paz", "nov lis", "dec dez gru dic",
        ),
        start=1,
    )
    for name in names.split()
}  # fmt: skip
_OFFSETS = {
    "Z": 0, "UTC": 0, "GMT": 0, "WET": 0, "WEST": 1, "BST": 1, "CET": 1, "MEZ": 1, "CEST": 2, "MESZ": 2,
    "EET": 2, "EEST": 3, "EST": -5, "EDT": -4, "CST": -6, "CDT": -5, "MST": -7, "MDT": -6, "PST": -8,
    "PDT": -7,
}  # fmt: skip
# from the first days of year 1 to the last ones of year 9999, with room for offsets from UTC [us]
_EARLIEST, _LATEST = (
    (date(1, 1, 3).toordinal() - _EPOCH) * DAY,
    (date(9999, 12, 29).toordinal() - _EPOCH) * DAY,
)
# no time, and no number, is written in more letters
_LONGEST = 80
_OUT_OF_RANGE = "beyond the years that a calendar holds; correct the time, or leave the line out"
_SCALES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}


class Moments(NamedTuple):
    """Times of rows.

    `ticks` (int64 of shape (n,), [us]): since 1970, on the clock that wrote them, or since nought where
    `kind` is ``"seconds"``; `offsets` [us] from UTC where `kind` is ``"offset"``, None where it is
    ``"local"`` or ``"seconds"``.
    """

    kind: str
    ticks: NDArray[np.int64]
    offsets: NDArray[np.int64] | None = None


def looks_like_time(cell: str) -> bool:
    """Whether a cell holds a date, with or without a time of day."""
    return len(cell) <= _LONGEST and any(shape.fullmatch(cell) for shape in _SHAPES)


def looks_like_clock(cell: str) -> bool:
    """Whether a cell holds a time of day without a date."""
    return len(cell) <= _LONGEST and _CLOCK_ALONE.fullmatch(cell) is not None


class DateOrder(NamedTuple):
    """Whether the day stands before the month in dates such as 03/04/2024; `assumed` where nothing tells."""

    day_first: bool
    assumed: bool = False


def date_order(cells: Iterable[str], source: str) -> DateOrder:
    """Find out which of two numbers is the day.

    Parameters
    ----------
    cells : iterable of str
        All times of an export.
    source : str
        For messages.

    Returns
    -------
    order : DateOrder

    Raises
    ------
    InputError
        If in some dates only the first number can be the day, in others only the second.
    """
    found, marks, halves = set(), set(), False
    for cell in cells:
        match = _SHAPES[1].fullmatch(cell)
        if match:
            found.add((int(match["a"]), int(match["b"]), _year(match["y"])))
            marks.add(match["s"])
            halves = halves or match["half"] is not None
    day_first = next((each for each in found if each[0] > 12), None)
    month_first = next((each for each in found if each[1] > 12), None)
    if day_first and month_first:
        raise InputError(
            f"{source}: in the date {day_first[0]}/{day_first[1]}/{day_first[2]} the day stands first, in "
            f"{month_first[0]}/{month_first[1]}/{month_first[2]} the month; export all times in one form, "
            "best 2024-06-28 14:35:00"
        )
    if day_first or month_first or not found:
        return DateOrder(month_first is None)
    if halves or marks == {"."}:
        return DateOrder(not halves)
    spans = []
    for days, months in ((0, 1), (1, 0)):
        numbers = [number for each in found if (number := _ordinal(each[2], each[months], each[days]))]
        spans.append(max(numbers) - min(numbers) if numbers else 0)
    # days in a row jump by months when they are read the wrong way round
    return DateOrder(spans[0] <= spans[1], assumed=spans[0] == spans[1])


def _ordinal(year: int, month: int, day: int) -> int:
    """Number of a day; nought where there is no such day, which reading the times will say."""
    try:
        return date(year, month, day).toordinal()
    except ValueError:
        return 0


def read_moments(cells: list[str], unit: str, day_first: bool, place: Callable[[int], str]) -> Moments:
    """Turn a column of times into microseconds.

    Parameters
    ----------
    cells : list of str, length n
        None of them empty.
    unit : str
        Unit of a time that is counted: s, ms, min or h; empty where none is given.
    day_first : bool
        How to read 03/04/2024.
    place : callable
        Row -> file and line, for messages.

    Returns
    -------
    moments : Moments

    Raises
    ------
    InputError
        If a cell is no time, or only some carry an offset from UTC.
    """
    first = cells[:50]
    if 2 * sum(map(looks_numeric, first)) > len(first) and not _SHAPES[-1].fullmatch(cells[0]):
        return _counted(cells, unit.casefold(), place)
    return _dated(cells, day_first, place)


def _dated(cells: list[str], day_first: bool, place: Callable[[int], str]) -> Moments:
    """Times that are dates."""
    known: dict[str, tuple[int, int | None]] = {}
    ticks, offsets = np.empty(len(cells), np.int64), np.zeros(len(cells), np.int64)
    with_offset = None
    for row, cell in enumerate(cells):
        if cell not in known:
            try:
                known[cell] = _moment(cell, day_first)
            except ValueError:
                raise InputError(
                    f"{place(row)}: {shown(cell)} is no time; expected one like 2024-06-28 14:35:00, so "
                    "correct it or leave the line out"
                ) from None
            if not _EARLIEST <= known[cell][0] <= _LATEST:
                raise InputError(f"{place(row)}: {shown(cell)} lies {_OUT_OF_RANGE}")
        ticks[row], offset = known[cell]
        if with_offset is None:
            with_offset = offset is not None
        if (offset is not None) != with_offset:
            raise InputError(
                f"{place(row)}: {cell!r} {'has no' if with_offset else 'has an'} offset from UTC, unlike "
                f"{cells[0]!r} before it; export all times with an offset, or all without"
            )
        offsets[row] = offset or 0
    return Moments("offset", ticks, offsets) if with_offset else Moments("local", ticks)


def _moment(cell: str, day_first: bool) -> tuple[int, int | None]:
    """Microseconds since 1970 on the clock that wrote them, and that clock's offset [us] where it is told."""
    if len(cell) > _LONGEST:
        raise ValueError
    match = next((found for shape in _SHAPES if (found := shape.fullmatch(cell))), None)
    if match is None:
        raise ValueError
    parts = match.groupdict()
    if "a" in parts:
        day, month = (parts["a"], parts["b"]) if day_first else (parts["b"], parts["a"])
    else:
        day, month = parts["d"], parts["m"] if "m" in parts else _month(parts["name"])
    days = date(_year(parts["y"]), int(month), int(day)).toordinal() - _EPOCH
    hour, minute, second = (int(parts.get(key) or 0) for key in "HMS")
    if parts.get("half"):
        if not 1 <= hour <= 12:
            raise ValueError
        hour = hour % 12 + 12 * (parts["half"] in "pP")
    if hour > 24 or minute > 59 or second > 60 or (hour == 24 and minute + second > 0):
        raise ValueError
    fraction = int((parts.get("f") or "0").ljust(6, "0")[:6])
    ticks = days * DAY + hour * HOUR + (60 * minute + second) * SECOND + fraction
    return ticks, _offset(parts.get("zone"))


def _year(text: str) -> int:
    return int(text) if len(text) == 4 else 2000 + int(text) - 100 * (int(text) >= 70)


def _month(name: str) -> int:
    plain = unicodedata.normalize("NFKD", name.casefold()).encode("ascii", "ignore").decode()
    found = _MONTHS.get(plain[:4]) or _MONTHS.get(plain[:3])
    if found is None:
        raise ValueError
    return found


def _offset(zone: str | None) -> int | None:
    if zone is None:
        return None
    if zone.upper() in _OFFSETS:
        return _OFFSETS[zone.upper()] * HOUR
    if zone[0] not in "+-":
        raise ValueError
    digits = zone[1:].replace(":", "").ljust(4, "0")
    size = int(digits[:2]) * HOUR + int(digits[2:]) * 60 * SECOND
    if size >= DAY or int(digits[2:]) > 59:
        raise ValueError
    return -size if zone[0] == "-" else size


def _counted(cells: list[str], unit: str, place: Callable[[int], str]) -> Moments:
    """Times that are numbers: of seconds, since 1970, or days as a spreadsheet counts them."""
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        try:
            values[row] = float(cell.replace(",", ".").replace("\u00a0", ""))
        except ValueError:
            values[row] = np.nan
        if not np.isfinite(values[row]):
            raise InputError(
                f"{place(row)}: {shown(cell)} is no time, unlike {shown(cells[0])} before it; correct it "
                "or leave the line out"
            )
    middle, steps = float(np.median(values)), np.abs(np.diff(values))
    step = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    if unit not in _SCALES and 2e4 < middle < 8e4 and 0.0 < step < 0.02:
        # days to 11 digits: milliseconds are told, microseconds are not
        return Moments("local", _ticks(86_400_000.0 * (values - _EXCEL_EPOCH), 1000, cells, place))
    for least, scale in ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3), (1e9, 1.0)):
        if middle >= least:
            ticks = _ticks(values * scale * SECOND, 1, cells, place)
            return Moments("offset", ticks, np.zeros(len(cells), np.int64))
    return Moments("seconds", _ticks(values * _SCALES.get(unit, 1.0) * SECOND, 1, cells, place))


def _ticks(
    values: NDArray[np.float64], each: int, cells: list[str], place: Callable[[int], str]
) -> NDArray[np.int64]:
    """Whole microseconds, `each` for one of the values; refused where no calendar holds them."""
    far = np.flatnonzero(~((values * each >= _EARLIEST) & (values * each <= _LATEST)))
    if len(far):
        raise InputError(f"{place(int(far[0]))}: {shown(cells[far[0]])} lies {_OUT_OF_RANGE}")
    return each * np.rint(values).astype(np.int64)
