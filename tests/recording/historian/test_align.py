# SPDX-License-Identifier: BSD-3-Clause
"""Points to rows: what lies between reports, what a gap leaves empty, which period."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.recording.historian.align import Pace, align, base_of, choose_period, pace_of, silences
from sklvalve.recording.historian.clean import Points
from sklvalve.recording.historian.moments import SECOND


def _points(seconds, values=None):
    times = np.rint(np.asarray(seconds, dtype=float) * SECOND).astype(np.int64)
    return Points("F", "", times, np.asarray(seconds if values is None else values, dtype=float))


def _aligned(points, period=1.0, *, hold=False, multiple=5.0, others=()):
    pace = pace_of(points)
    base = base_of([points, *others], round(period * SECOND))
    quiet, _ = silences([points, *others], multiple)
    return base / SECOND, align(points, pace, base, hold=hold, multiple=multiple, quiet=quiet)


def test_a_scan_with_a_missing_report_is_bridged_up_to_the_limit():
    seconds = [*range(10), *range(13, 20), *range(30, 40)]
    base, aligned = _aligned(_points(seconds))
    inner = (base > 19) & (base < 30)
    assert np.isnan(aligned.values[inner]).all()
    np.testing.assert_allclose(aligned.values[~inner], base[~inner])
    assert (aligned.exact, aligned.filled, aligned.missing) == (27, 3, 10)
    assert (aligned.gaps, aligned.longest_gap, aligned.longest_bridged) == (1, 11.0, 4.0)


def test_held_and_straight():
    points = _points(np.arange(0.0, 40.0, 2.0))
    _, straight = _aligned(points)
    base, held = _aligned(points, hold=True)
    np.testing.assert_allclose(straight.values, base)
    np.testing.assert_allclose(held.values, 2.0 * (base // 2.0))


def test_nothing_is_drawn_towards_or_held_over_a_bad_value():
    values = np.arange(0.0, 40.0, 2.0)
    values[5] = np.nan  # at 10 s
    for hold in (False, True):
        base, aligned = _aligned(_points(np.arange(0.0, 40.0, 2.0), values), hold=hold)
        empty = base[np.isnan(aligned.values)]
        assert empty.tolist() == ([10.0, 11.0] if hold else [9.0, 10.0, 11.0])


def test_silence_of_one_tag_that_reports_by_exception_is_no_gap_silence_of_all_is():
    rng = np.random.default_rng(1)
    seconds = np.cumsum(rng.exponential(4.0, 200))
    still = np.concatenate([seconds[seconds < 200.0], seconds[seconds > 320.0]])
    assert not pace_of(_points(still)).scanned
    base, alone = _aligned(_points(still), hold=True)
    whole, beside = _aligned(_points(still), hold=True, others=[_points(seconds)])
    within = (base > still[still < 200.0].max() + 1.0) & (base < 319.0)
    assert np.isnan(alone.values[within]).all()
    assert alone.longest_gap > 120.0
    assert np.isfinite(beside.values[(whole > 205.0) & (whole < 319.0)]).all()
    assert beside.longest_bridged > 120.0


def test_nothing_comes_before_the_first_report_or_long_after_the_last():
    short, long = _points(np.arange(20.0, 60.0)), _points(np.arange(0.0, 100.0))
    base, aligned = _aligned(short, hold=True, others=[long])
    assert base[np.isfinite(aligned.values)].tolist() == [*np.arange(20.0, 61.0)]


@pytest.mark.parametrize(
    ("steps", "period"),
    [
        ([(1.0, True), (1.0, True), (60.0, True)], 1.0),
        ([(5.0, True)], 5.0),
        ([(7.0, True)], 7.0),
        ([(12.3, False), (40.0, False)], 15.0),
        ([(0.98, True), (1.01, True), (30.0, False)], 1.0),
    ],
)
def test_period_is_that_of_most_tags(steps, period):
    assert choose_period([Pace(step * SECOND, scanned) for step, scanned in steps]) == period * SECOND


def test_base_stands_where_most_reports_stand():
    assert (base_of([_points(np.arange(3.0, 100.0, 5.0))], 5 * SECOND)[:2] / SECOND).tolist() == [3.0, 8.0]
    rng = np.random.default_rng(0)
    uneven = _points(np.cumsum(rng.uniform(3.0, 7.0, 50)))
    assert (base_of([uneven], 5 * SECOND) % (5 * SECOND) == 0).all()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(1, 400), min_size=3, max_size=60), st.booleans(), st.integers(1, 20))
def test_counts_add_up_and_values_stay_between_their_neighbours(steps, hold, period):
    points = _points(np.cumsum(steps) / 10.0, np.sin(np.cumsum(steps)))
    base, aligned = _aligned(points, period / 2.0, hold=hold)
    assert aligned.exact + aligned.between + aligned.filled + aligned.missing == len(base)
    assert np.isfinite(aligned.values).sum() == len(base) - aligned.missing
    good = aligned.values[np.isfinite(aligned.values)]
    assert ((good >= points.values.min() - 1e-12) & (good <= points.values.max() + 1e-12)).all()
    at = {int(time): value for time, value in zip(points.times, points.values, strict=True)}
    for moment, value in zip(np.rint(base * SECOND).astype(int), aligned.values, strict=True):
        if int(moment) in at:
            assert value == at[int(moment)]
