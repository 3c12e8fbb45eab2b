# SPDX-License-Identifier: BSD-3-Clause
"""The rows of an import between two times that were asked for."""

from datetime import date, datetime, tzinfo

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._selecting import rows_between
from sklvalve.recording.errors import InputError
from sklvalve.recording.historian.moments import SECOND
from sklvalve.recording.historian.settings import ImportSettings
from sklvalve.recording.historian.timeline import Timeline
from sklvalve.recording.timebase import seconds_at


def require_one_clock(runs: int, settings: ImportSettings, source: str) -> None:
    """Refuse to cut an export in which the clock starts again: a time is in several of its runs.

    Raises
    ------
    InputError
    """
    if runs > 1 and settings.cuts:
        raise InputError(
            f"{source}: the clock starts again, so --from and --until could mean any of {runs} runs; leave "
            "them out, and take the recordings of the runs that you want"
        )


def rows_asked_for(
    base: NDArray[np.int64],
    kept: NDArray[np.bool_],
    timeline: Timeline,
    settings: ImportSettings,
    source: str,
) -> NDArray[np.bool_]:
    """Rows kept that lie between the times asked for.

    Parameters
    ----------
    base : ndarray of shape (n,)
        Times of all rows [us].
    kept : ndarray of bool, shape (n,)
        Those with values, at least one.
    timeline : Timeline
    settings : ImportSettings
    source : str

    Returns
    -------
    kept : ndarray of bool, shape (n,)

    Raises
    ------
    InputError
        If a time is none, or if no row lies between them.
    """
    if not settings.cuts:
        return kept
    places = np.flatnonzero(kept)
    first, last = timeline.stamps(base[places[[0, -1]]])
    seconds = (base[places] - base[places[0]]) / SECOND
    begin: object = settings.begin
    end: object = settings.end
    if isinstance(first, str):
        offset, zone = 0.0, timeline.zone or datetime.fromisoformat(first).tzinfo
        # of an hour that is there twice the whole is kept
        begin, end = _day(begin) or _moment(begin, zone), _day(end) or _moment(end, zone, fold=1)
    else:
        # counted seconds begin where they were set to
        offset, zone = float(first), None

    def seconds_of(time: object) -> float:
        return seconds_at(time if zone is None else _moment(time, zone), first, offset)

    def span() -> str:
        return f"give a time between {first} and {last}"

    low, high = rows_between(seconds + offset, seconds_of, begin, end, source, span)
    if high - low < 2:
        raise InputError(f"{source}: one row alone lies between --from and --until; {span()}")
    some = np.zeros(len(kept), dtype=bool)
    some[places[low:high]] = True
    return some


def _day(time: object) -> str | None:
    """A day, in whatever way it is written, such as 20260302, as 2026-03-02; None of what is none."""
    try:
        return date.fromisoformat(time.strip()).isoformat() if isinstance(time, str) else None
    except ValueError:
        return None


def _moment(time: object, zone: tzinfo | None, fold: int = 0) -> object:
    """A time that lacks an offset in a zone, a day as its first moment; what is no time as it is."""
    try:
        moment = datetime.fromisoformat(time.strip()) if isinstance(time, str) else time
    except ValueError:
        return time
    if isinstance(moment, datetime) and moment.tzinfo is None and zone is not None:
        return moment.replace(tzinfo=zone, fold=fold)
    return moment
