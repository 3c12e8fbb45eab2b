# SPDX-License-Identifier: BSD-3-Clause
"""Where the clock of an export starts again, as it does where several runs stand one behind the other."""

from collections.abc import Sequence
from datetime import datetime, timedelta

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.historian.layout import Layout
from sklvalve.recording.historian.moments import DAY, HOUR
from sklvalve.recording.historian.table import Table
from sklvalve.recording.historian.timeline import Timeline

# stamps behind the latest one that are still late reports of one run, and the share of the longest run
_FEW, _SHARE = 10, 0.1
# usual steps: within so many a row goes on where the one before left off; from so many on, in an export of
# several runs, a leap of the clock begins another
_GOES_ON, _DOUBLE, _LEAP = 5.0, 1.5, 100.0
# steps within this share of the usual one are even; share of steps back from which on there is no order
_EVEN, _NO_ORDER = 0.25, 0.25


def runs_of_rows(table: Table, layout: Layout, timeline: Timeline, number: int) -> list[NDArray[np.intp]]:
    """Run to which each row belongs, counted from 0 in the order of the file.

    Parameters
    ----------
    table : Table
    layout : Layout
    timeline : Timeline
    number : int
        Of the file in the timeline.

    Returns
    -------
    runs : list of ndarray of shape (n,), intp
        For each clock of the table; all nought where no clock starts again.

    Raises
    ------
    InputError
        If the clocks of several tags start again differently often, so that nobody knows which runs belong
        together.
    """
    wide = layout.format == "wide"
    runs = [np.zeros(len(table.lines), dtype=np.intp) for _ in layout.clocks]
    counts: dict[str, int] = {}
    streams: set[tuple[int, bytes]] = set()
    for series in layout.series:
        timed = timeline.timed(number, series)
        rows = series.rows[timed]
        key = series.clock, rows.tobytes()
        if not len(rows) or key in streams:
            continue
        streams.add(key)
        ticks = timeline.read_ticks(number, series.clock)[rows]
        starts = restarts(ticks, local=timeline.kind == "local")
        if timeline.kind != "seconds":
            columns, places = (table.columns, rows) if wide else ([series.values], timed)
            starts = [k for k in starts if not _is_double(ticks, columns, places, k)]
        if wide and starts:
            starts = sorted({*starts, *_more_starts(table, rows, ticks, starts)})
        runs[series.clock][rows] = np.searchsorted(starts, np.arange(len(rows)), side="right")
        counts[series.tag] = len(starts) + 1
    if len(set(counts.values())) > 1:
        most, least = max(counts, key=counts.__getitem__), min(counts, key=counts.__getitem__)
        if not wide and (whole := _whole_table(timeline, number, counts[most])) is not None:
            return [whole]
        raise InputError(
            f"{table.file}: the clock of {most} starts again {counts[most] - 1} times, but that of {least} "
            f"{counts[least] - 1} times; export each run to a file of its own"
        )
    return runs


def restarts(ticks: NDArray[np.int64], *, local: bool) -> list[int]:
    """Places in a stream at which its clock starts again.

    A clock that runs back begins another run, unless the rows behind it are late reports: few, or a block
    that fills a hole and after which the stream goes on where it was before. Of rows in no order at all
    nothing can be said, and none is named.

    Parameters
    ----------
    ticks : ndarray of shape (n,), int64
        Times in the order of the file, or newest first [us].
    local : bool
        Whether they are of a clock on the wall, which is set back one night in the year.

    Returns
    -------
    starts : list of int
        First places of all runs but the first.
    """
    backwards = len(ticks) > 1 and (np.diff(ticks) < 0).sum() > (np.diff(ticks) > 0).sum()
    forward = ticks[::-1] if backwards else ticks
    steps = np.diff(forward)
    if not 0.0 < (steps < 0).mean() <= _NO_ORDER:
        return []
    usual = float(np.median(steps[steps > 0]))
    back = np.flatnonzero(steps < 0) + 1
    if local:
        back = np.array([k for k in back if not _set_back(forward, int(k), back)], dtype=np.intp)
    starts: list[int] = []
    begin, latest = 0, forward[0] if len(forward) else 0
    passed = 0
    for k in back:
        if k < passed:
            continue
        latest = forward[begin:k].max()
        after = np.flatnonzero(forward[k:] > latest)
        end = int(k + after[0]) if len(after) else len(forward)
        if _is_run(forward, begin, int(k), end, int(latest), usual):
            starts.append(int(k))
            begin, passed = int(k), 0
        else:
            passed = end
    if backwards:
        starts = [len(ticks) - k for k in reversed(starts)]
    return starts


def _is_run(ticks: NDArray[np.int64], begin: int, k: int, end: int, latest: int, usual: float) -> bool:
    """Whether the rows from `k` on are another run; those up to `end` are not later than what came before."""
    behind = end - k
    whole = end == len(ticks)
    leap = np.inf if whole else float(ticks[end] - ticks[end - 1])
    goes_on = not whole and ticks[end] - latest <= _GOES_ON * usual
    before = ticks[begin:k]
    block = ticks[k:end]
    hole = not ((before >= block.min()) & (before <= block.max())).any()
    if goes_on and hole and leap > _DOUBLE * usual:
        return False  # a block that came late, and filled a hole
    if behind >= _FEW:
        return True
    if whole:
        return behind >= max(2.0, _SHARE * (k - begin)) and (ticks[k] <= before[0] or not hole)
    # few rows are behind the latest one: a run that overlaps the one before goes on at an even pace
    steps = np.diff(ticks[k : end + 1])
    even = np.abs(np.diff(before) - usual) <= _EVEN * usual
    return behind >= 2 and even.mean() > 0.8 and bool((np.abs(steps - usual) <= _EVEN * usual).all())


def _set_back(ticks: NDArray[np.int64], k: int, back: NDArray[np.intp]) -> bool:
    """Whether a clock on the wall may have been set back here: one hour, once, on a Sunday night."""
    moment = datetime(1970, 1, 1) + timedelta(microseconds=int(ticks[k - 1]))
    near = (np.abs(ticks[back] - ticks[k]) < DAY).sum()
    return moment.weekday() == 6 and moment.hour < 4 and ticks[k] - ticks[k - 1] >= -HOUR and near == 1


def _is_double(
    ticks: NDArray[np.int64], columns: Sequence[list[str]], rows: NDArray[np.intp], k: int
) -> bool:
    """Whether what follows on one clock begins with rows that were there, as where two exports overlap."""
    places = {int(tick): place for place, tick in enumerate(ticks[:k])}
    after = np.flatnonzero(ticks[k:] > ticks[:k].max())
    shared = range(k, int(k + after[0]) if len(after) else len(ticks))
    same = 0
    for place in shared:
        there = places.get(int(ticks[place]))
        if there is not None:
            same += all(cells[rows[there]] == cells[rows[place]] for cells in columns)
    # at rest two runs may well hold a row in common
    return 2 * same > len(shared)


def _more_starts(
    table: Table, rows: NDArray[np.intp], ticks: NDArray[np.int64], starts: Sequence[int]
) -> list[int]:
    """Starts of runs that no clock shows by running back: by a name of the run, else by a leap."""
    for column in table.columns:
        cells = [column[row] for row in rows]
        changes = [k for k in range(1, len(cells)) if cells[k] != cells[k - 1]]
        # a name of the run changes wherever the clock starts again, and never comes back
        if set(starts) <= set(changes) and len(set(cells)) == len(changes) + 1 < 0.1 * len(cells):
            return changes
    steps = np.diff(ticks)
    usual = float(np.median(steps[steps > 0]))
    return [int(k) + 1 for k in np.flatnonzero(steps > _LEAP * usual)]


def _whole_table(timeline: Timeline, number: int, count: int) -> NDArray[np.intp] | None:
    """Runs by the order of all rows, where tags are written turn by turn and some are silent in a run."""
    ticks = timeline.read_ticks(number, 0)
    starts = restarts(ticks, local=timeline.kind == "local")
    if len(starts) + 1 != count:
        return None
    return np.searchsorted(starts, np.arange(len(ticks)), side="right")
