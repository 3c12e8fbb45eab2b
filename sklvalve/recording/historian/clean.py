# SPDX-License-Identifier: BSD-3-Clause
"""From cells to points of a tag: bad values told, points in order of time, one at each moment."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.historian import quality
from sklvalve.recording.historian.decimals import read_numbers
from sklvalve.recording.historian.layout import Series


@dataclass
class Points:
    """What was recorded of one tag.

    Parameters
    ----------
    tag, unit : str
    times : ndarray of shape (n,), int64
        [us].
    values : ndarray of shape (n,), float64
        In `unit`; NaN where the export says that there was no good value.
    rows : int
        Rows of the export that name the tag.
    bad : Counter
        What stood there instead of a good value -> how often.
    states : Counter
        Texts that are no numbers and tell of no fault -> how often.
    out_of_order, doubled, contradicting : int
        Points moved to their place in time; points at a moment that has one already, left out; those among
        them that said something else.
    """

    tag: str
    unit: str
    times: NDArray[np.int64]
    values: NDArray[np.float64]
    rows: int = 0
    bad: Counter[str] = field(default_factory=Counter)
    states: Counter[str] = field(default_factory=Counter)
    out_of_order: int = 0
    doubled: int = 0
    contradicting: int = 0


def read_points(series: Series, times: NDArray[np.int64], mark: str, keep_uncertain: bool) -> Points:
    """Points of a series, in the order of the file.

    Parameters
    ----------
    series : Series
    times : ndarray of shape (n,), int64
        One for each of its cells [us].
    mark : {".", ","}
        The decimal mark.
    keep_uncertain : bool
        Whether a value of uncertain quality counts.

    Returns
    -------
    points : Points
        An empty cell of a wide table is no point, for it says only that nothing was reported then.
    """
    values, texts = read_numbers(series.values, mark)
    points = Points(series.tag, series.unit, times, values)
    kept = np.ones(len(values), dtype=bool)
    for place, text in texts.items():
        if not text and not series.stated:
            kept[place] = False
        elif quality.is_bad_text(text) or quality.is_uncertain_text(text) or not text:
            points.bad[text or "empty"] += 1
        else:
            points.states[text] += 1
    if series.quality is not None:
        meaning = quality.judge(series.quality, series.quality_name)
        refused = {quality.BAD} if keep_uncertain else {quality.BAD, quality.UNCERTAIN}
        for place, text in enumerate(series.quality):
            if meaning[text] in refused and np.isfinite(values[place]):
                values[place] = np.nan
                points.bad[f"quality {text or 'empty'}"] += 1
    points.times, points.values, points.rows = times[kept], values[kept], int(kept.sum())
    return points


def join_points(parts: Sequence[Points]) -> Points:
    """Points of one tag from several files, the earlier file first; in order, and one at each moment.

    Of several points at a moment the last good one stays.
    """
    parts = (
        sorted((part for part in parts if len(part.times)), key=lambda part: part.times.min()) or parts[:1]
    )
    times = np.concatenate([part.times for part in parts])
    values = np.concatenate([part.values for part in parts])
    if len(times) > 1 and (np.diff(times) < 0).sum() > (np.diff(times) > 0).sum():
        times, values = times[::-1], values[::-1]  # newest first is an order too
    joined = Points(parts[0].tag, parts[0].unit, times, values, sum(part.rows for part in parts))
    joined.bad = sum((part.bad for part in parts), Counter())
    joined.states = sum((part.states for part in parts), Counter())
    joined.out_of_order = int((np.diff(times) < 0).sum())
    # the good ones last among those of one moment, in the order of the file
    order = np.lexsort((np.arange(len(times)), np.isfinite(values), times))
    times, values = times[order], values[order]
    follows = np.concatenate([times[1:] == times[:-1], [False]]) if len(times) else np.zeros(0, dtype=bool)
    last = values[np.flatnonzero(~follows)] if len(times) else values
    group = np.concatenate([[0], np.cumsum(~follows)[:-1]]).astype(np.intp) if len(times) else order
    differs = follows & np.isfinite(values) & (values != last[group])
    joined.doubled, joined.contradicting = int(follows.sum()), int(differs.sum())
    joined.times, joined.values = times[~follows], values[~follows]
    return joined
