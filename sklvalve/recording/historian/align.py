# SPDX-License-Identifier: BSD-3-Clause
"""From points at moments of their own to rows on one regular base, without bridging gaps in silence."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.historian.clean import Points
from sklvalve.recording.historian.moments import SECOND

# periods that people choose [s]
_ROUND = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 20, 30, 60, 120, 300, 600, 900, 1800, 3600)
# steps within this share of their median belong to a scan; where fewer do, the tag reports by exception
_SAME_STEP, _SCANNED = 0.25, 0.8
# a step longer than so many is a missing row, and not the jitter of a scan
_ONE_STEP = 1.5
# share of the steps between any two reports that are usual
_USUAL = 0.95


@dataclass(frozen=True)
class Pace:
    """How a tag reports: its middle step [us], and whether by a scan or only when something changed."""

    step: float
    scanned: bool


@dataclass(frozen=True)
class Aligned:
    """Values of one tag on the base, and how its rows came about.

    `exact` were reported at that moment; `between` lie between two reports in a row; `filled` bridge missing
    reports of a scan, within the limit; `missing` are empty; `gaps` counts the silences that are not bridged,
    and `longest_gap` [s] is the longest of them; `longest_bridged` [s] is the longest that is; `unused` are
    good reports that fall between rows.
    """

    values: NDArray[np.float64]
    method: str
    scanned: bool
    step: float
    exact: int
    between: int
    filled: int
    missing: int
    gaps: int
    longest_gap: float
    longest_bridged: float
    unused: int


def pace_of(points: Points) -> Pace | None:
    """How a tag reports; None where it has fewer than two points."""
    steps = np.diff(points.times)
    if not len(steps):
        return None
    middle = float(np.median(steps))
    near = np.abs(steps - middle) <= _SAME_STEP * middle
    return Pace(middle, bool(near.mean() >= _SCANNED))


def choose_period(paces: Sequence[Pace]) -> int:
    """Period [us] of the base: the middle one of the tags' own steps, rounded where they report unevenly."""
    steps = sorted(pace.step for pace in paces)
    middle = steps[(len(steps) - 1) // 2]
    near = min((SECOND * each for each in _ROUND), key=lambda each: abs(np.log(each / middle)))
    exact = any(pace.scanned and pace.step == middle for pace in paces)
    if abs(near / middle - 1.0) < 0.05 or not exact:
        return round(near)
    return round(middle)


def base_of(all_points: Sequence[Points], period: int) -> NDArray[np.int64]:
    """Moments of the base [us], at the phase at which most reports stand."""
    times = np.concatenate([points.times for points in all_points])
    phases, counts = np.unique(times % period, return_counts=True)
    phase = int(phases[np.argmax(counts)]) if 2 * counts.max() >= len(times) else 0
    first, last = int(times.min()), int(times.max())
    start = first + (phase - first) % period
    return np.arange(start, last + 1, period, dtype=np.int64)


def silences(all_points: Sequence[Points], multiple: float) -> tuple[NDArray[np.int64], float]:
    """Spans in which no tag reported anything for longer than usual.

    Parameters
    ----------
    all_points : sequence of Points
        At least two moments among them.
    multiple : float

    Returns
    -------
    spans : ndarray of shape (k, 2), int64
        Begin and end [us].
    longest : float
        What is still usual [us]: `multiple` times the step that 95 % of those between any two reports do not
        exceed. Reports by exception come by chance, many in a row and then none, so that the middle step
        would tell little.
    """
    times = np.unique(np.concatenate([points.times for points in all_points]))
    longest = multiple * float(np.quantile(np.diff(times), _USUAL))
    wide = np.flatnonzero(np.diff(times) > longest)
    return np.column_stack([times[wide], times[wide + 1]]), longest


def align(
    points: Points,
    pace: Pace,
    base: NDArray[np.int64],
    *,
    hold: bool,
    multiple: float,
    quiet: NDArray[np.int64],
) -> Aligned:
    """Take a tag to the base.

    A tag that is scanned is followed over at most `multiple` of its steps. One that reports by exception has
    not changed while it is silent, as long as any other tag reports: it is followed up to a silence of all.

    Parameters
    ----------
    points : Points
    pace : Pace
    base : ndarray of shape (m,), int64
        [us].
    hold : bool
        Whether the last known value holds until the next (a command), or the value runs straight from one
        report to the next (a measurement).
    multiple : float
        Longest stretch without a report that is bridged, in steps.
    quiet : ndarray of shape (k, 2), int64
        Silences of all tags [us].

    Returns
    -------
    aligned : Aligned
    """
    times, values = points.times, points.values
    before = np.searchsorted(times, base, side="right") - 1
    known = before >= 0
    at = np.clip(before, 0, None)
    exact = known & (times[at] == base)
    following = np.minimum(at + 1, len(times) - 1)
    if pace.scanned:
        bridged = np.diff(times) <= multiple * pace.step
        last = base <= times[-1] + _ONE_STEP * pace.step
    else:
        reached = np.searchsorted(quiet[:, 0], times[:-1], side="left")
        begins = np.append(quiet[:, 0], np.iinfo(np.int64).max)[reached]
        bridged = begins >= times[1:]
        last = base <= _first_silence(quiet, int(times[-1]))
    usable = np.append(bridged, True)[at] & (last | (at < len(times) - 1)) & known
    if hold:
        result = np.where(exact | usable, values[at], np.nan)
    else:
        share = (base - times[at]) / np.maximum(times[following] - times[at], 1)
        straight = values[at] + share * (values[following] - values[at])
        inner = usable & (following > at)
        result = np.where(exact, values[at], np.where(inner, straight, np.nan))
    good = np.isfinite(result) & known
    result = np.where(good, result, np.nan)
    wide = pace.scanned & ((times[following] - times[at]) > _ONE_STEP * pace.step)
    gaps, spans = np.diff(times)[~bridged], np.diff(times)[bridged]
    hit = np.unique(at[exact])
    return Aligned(
        values=result,
        method="held" if hold else "linear",
        scanned=pace.scanned,
        step=pace.step / SECOND,
        exact=int((good & exact).sum()),
        between=int((good & ~exact & ~wide).sum()),
        filled=int((good & ~exact & wide).sum()),
        missing=int((~good).sum()),
        gaps=len(gaps),
        longest_gap=float(gaps.max()) / SECOND if len(gaps) else 0.0,
        longest_bridged=float(spans.max()) / SECOND if len(spans) else 0.0,
        unused=int(np.isfinite(values).sum() - np.isfinite(values[hit]).sum()),
    )


def _first_silence(quiet: NDArray[np.int64], after: int) -> int:
    """When the first silence of all tags begins at or after a moment; the end of time where none does."""
    begins = quiet[quiet[:, 0] >= after, 0]
    return int(begins[0]) if len(begins) else int(np.iinfo(np.int64).max)
