# SPDX-License-Identifier: BSD-3-Clause
"""Local time to UTC across the days on which clocks are changed."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError, available_timezones

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError, hint
from sklvalve.recording.historian.moments import DAY, HOUR, SECOND

_BIN = 15 * 60 * SECOND  # clocks are changed at quarters of an hour
_EPOCH = datetime(1970, 1, 1)
Ticks = NDArray[np.int64]


@dataclass
class ClockChanges:
    """What the clock changes did to the times of one stream, each entry a local date and hour.

    `told_apart`: stamps of a repeated hour whose place their order, or their neighbours, told; `assumed`:
    such stamps taken for the first of the two; `late`: stamps in an hour that does not exist, from a clock
    that was set forward late.
    """

    told_apart: dict[str, int] = field(default_factory=dict)
    assumed: dict[str, int] = field(default_factory=dict)
    late: dict[str, int] = field(default_factory=dict)


def read_zone(name: str) -> tzinfo:
    """Time zone by its name, or by its offset from UTC.

    Parameters
    ----------
    name : str
        As ``"Europe/Warsaw"``, ``"UTC"`` or ``"+01:00"``.

    Returns
    -------
    zone : tzinfo

    Raises
    ------
    InputError
        If there is no such zone, or this computer has no table of zones.
    """
    if not isinstance(name, str):
        raise InputError(f"zone must be the name of a time zone, as 'Europe/Warsaw'; got {name!r}")
    fixed = re.fullmatch(r"(?:UTC|GMT)?([+-])(\d{1,2})(?::?(\d{2}))?", name.strip())
    if fixed and int(fixed[2]) < 15:
        offset = timedelta(hours=int(fixed[2]), minutes=int(fixed[3] or 0))
        return timezone(-offset if fixed[1] == "-" else offset)
    if name.strip().upper() in ("UTC", "Z", "GMT"):
        return UTC
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        zones = available_timezones()
    if not zones:
        raise InputError(
            f"--timezone {name}: this computer has no table of time zones; pip install tzdata, or give the "
            "offset from UTC, such as +01:00"
        )
    near = hint(name, sorted(zones))
    more = near if near.startswith("did") else "give one like Europe/Warsaw, or an offset like +01:00"
    raise InputError(f"--timezone {name}: there is no such time zone; {more}")


def offsets_at(utc: Ticks, zone: tzinfo) -> Ticks:
    """Offset of local time from UTC [us] at moments in UTC [us]."""
    bins, place = np.unique(utc // _BIN, return_inverse=True)
    offsets = [_microseconds((_moment(tick).replace(tzinfo=UTC)).astimezone(zone)) for tick in bins * _BIN]
    return np.array(offsets, dtype=np.int64)[place]


def to_utc(local: Ticks, zone: tzinfo, place: Callable[[int], str], changes: ClockChanges) -> Ticks:
    """Local times of one stream, in the order of the file, to UTC.

    A stamp in the hour that is repeated in autumn stands for two moments. In a stream that is in order the
    second pass begins where the stamps run back; where every stamp stands twice, the second of each belongs
    to it; where only one pass was recorded, the side on which it joins its neighbours tells. Else the first
    pass is assumed. A stamp in the hour that is left out in spring is read on the clock of before, if the
    stream stays in order so.

    Parameters
    ----------
    local : ndarray of shape (n,), int64
        Times on the local clock [us since 1970].
    zone : tzinfo
    place : callable
        Row -> file and line, for messages.
    changes : ClockChanges
        What was done is added to it.

    Returns
    -------
    utc : ndarray of shape (n,), int64
        [us since 1970].

    Raises
    ------
    InputError
        If the stream goes through an hour that the zone leaves out.
    """
    backwards = len(local) > 1 and (np.diff(local) < 0).sum() > (np.diff(local) > 0).sum()
    forward = local[::-1] if backwards else local
    bins, where = np.unique(forward // _BIN, return_inverse=True)
    first_pass, second_pass = (
        np.array([_offset(tick, zone, fold) for tick in bins * _BIN], dtype=np.int64)[where]
        for fold in (0, 1)
    )
    utc = forward - first_pass
    repeated = first_pass > second_pass
    typical = _typical(forward)
    for day in np.unique(forward[repeated] // DAY):
        rows = np.flatnonzero(repeated & (forward // DAY == day))
        second, certain = _second_pass(forward, utc, rows, first_pass - second_pass, typical)
        utc[rows[second]] = forward[rows[second]] - second_pass[rows[second]]
        kept = changes.told_apart if certain else changes.assumed
        _count(kept, forward[rows].min(), len(rows))
    absent = np.flatnonzero(first_pass < second_pass)
    if len(absent):
        row_of = (lambda row: len(local) - 1 - row) if backwards else (lambda row: row)
        _require_order(forward, utc, absent, zone, lambda row: place(row_of(row)))
        for day in np.unique(forward[absent] // DAY):
            rows = absent[forward[absent] // DAY == day]
            _count(changes.late, forward[rows].min(), len(rows))
    return utc[::-1] if backwards else utc


def runs_back_in_autumn(local: Ticks) -> int | None:
    """Row at which local times run back as they do when clocks are set back, once and on a Sunday night."""
    steps = np.diff(local)
    if (steps < 0).sum() > (steps > 0).sum():
        steps = -steps
    back = np.flatnonzero(steps < 0)
    if len(back) != 1 or steps[back[0]] < -HOUR:
        return None
    moment = _moment(int(local[back[0]]))
    return int(back[0]) + 1 if moment.weekday() == 6 and moment.hour < 4 else None


def _second_pass(
    local: Ticks, utc: Ticks, rows: NDArray[np.intp], shift: Ticks, typical: float
) -> tuple[NDArray[np.bool_], bool]:
    """Which rows of a repeated hour belong to its second pass, and whether that is certain."""
    stamps = local[rows]
    steps = np.diff(stamps)
    second = np.zeros(len(rows), dtype=bool)
    if (steps < 0).any():
        second[int(np.argmin(steps)) + 1 :] = True
        return second, True
    again = np.concatenate([[False], steps == 0])
    if 2 * again.sum() >= (~again).sum():
        return again, True
    before, after = rows[0] - 1, rows[-1] + 1
    joins_first = before >= 0 and utc[rows[0]] - utc[before] <= 2.0 * typical
    late_end = utc[rows[-1]] + shift[rows[-1]]
    joins_second = after < len(utc) and 0 <= utc[after] - late_end <= 2.0 * typical
    second[:] = joins_second and not joins_first
    return second, joins_first != joins_second


def _require_order(
    local: Ticks, utc: Ticks, absent: NDArray[np.intp], zone: tzinfo, place: Callable[[int], str]
) -> None:
    following = absent[absent + 1 < len(utc)]
    against = following[utc[following + 1] < utc[following]]
    if len(against):
        row = int(against[0])
        raise InputError(
            f"{place(row)}: the time {_moment(int(local[row]))} does not exist in {zone}, where clocks were "
            "set forward over it; these times were written without daylight saving, so give --timezone the "
            "offset from UTC of that clock, such as +01:00"
        )


def _typical(local: Ticks) -> float:
    steps = np.diff(local)
    steps = steps[steps > 0]
    return float(np.median(steps)) if len(steps) else float(SECOND)


def _count(kept: dict[str, int], tick: int, rows: int) -> None:
    hour = _moment(int(tick) // HOUR * HOUR).strftime("%Y-%m-%d %H:%M")
    kept[hour] = kept.get(hour, 0) + rows


def _moment(tick: int) -> datetime:
    return _EPOCH + timedelta(microseconds=int(tick))


def _offset(tick: int, zone: tzinfo, fold: int) -> int:
    return _microseconds(_moment(tick).replace(tzinfo=zone, fold=fold))


def _microseconds(moment: datetime) -> int:
    offset = moment.utcoffset() or timedelta()
    return (offset.days * 86400 + offset.seconds) * SECOND
