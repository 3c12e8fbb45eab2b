# SPDX-License-Identifier: BSD-3-Clause
"""The rows of an import between two times that were asked for."""

from datetime import datetime

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
    if runs > 1 and (settings.begin is not None or settings.end is not None):
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
    if settings.begin is None and settings.end is None:
        return kept
    places = np.flatnonzero(kept)
    first, last = timeline.stamps(base[places[[0, -1]]])
    seconds = (base[places] - base[places[0]]) / SECOND
    # where times are seconds they count from a beginning of their own
    offset = 0.0 if isinstance(first, str) else float(first)

    def seconds_of(time: object) -> float:
        return seconds_at(_with_offset(time, first, timeline), first, offset)

    def span() -> str:
        return f"give a time between {first} and {last}"

    low, high = rows_between(seconds + offset, seconds_of, settings.begin, settings.end, source, span)
    some = np.zeros(len(kept), dtype=bool)
    some[places[low:high]] = True
    return some


def _with_offset(time: object, first: object, timeline: Timeline) -> object:
    """A local time with its offset from UTC, where the recording's times have one and it has none."""
    if timeline.zone is None or not isinstance(first, str) or not isinstance(time, str):
        return time
    try:
        moment = datetime.fromisoformat(time)
    except ValueError:
        return time
    return moment.replace(tzinfo=timeline.zone) if moment.tzinfo is None else time
