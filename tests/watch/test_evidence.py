# SPDX-License-Identifier: BSD-3-Clause
"""The detector: how often it calls without a reason, and how soon with one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.watch.evidence import cusum, detector, limit_of


def sound(rng, days, series=4):
    return rng.normal(size=(days, series))


def test_evidence_grows_by_no_more_than_one_a_day_while_nothing_changes():
    rng = np.random.default_rng(1)
    mean = np.mean([detector(sound(rng, 60), 10)[0] for _ in range(400)], axis=0)
    since = np.arange(60) - 9
    # its expectation is the number of days; the mean of a heavy tail lies below it mostly
    assert (mean[10:] < 2.0 * since[10:]).all()
    assert (mean[:10] == 0.0).all()


def test_sound_valves_call_no_more_often_than_allowed():
    rng = np.random.default_rng(2)
    limit = limit_of(0.2)
    calls = sum((detector(sound(rng, 10 + 365), 10)[0] >= limit).any() for _ in range(150))
    # 30 expected at most
    assert calls <= 30


@pytest.mark.parametrize("shape", ["step", "ramp"])
def test_a_change_is_called_with_its_onset(shape):
    rng = np.random.default_rng(3)
    table = sound(rng, 90)
    since = np.maximum(np.arange(90) - 50, 0)
    table[:, 2] += 6.0 * (since > 0) if shape == "step" else 0.3 * since
    evidence, onset, _ = detector(table, 14)
    day = int(np.flatnonzero(evidence >= limit_of(0.05))[0])
    assert 50 < day < 75
    assert abs(onset[day] - 51) < 8


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
@settings(max_examples=25, deadline=None)
def test_unit_and_zero_of_a_series_do_not_matter(zero, unit):
    series = sound(np.random.default_rng(4), 40, 1)[:, 0]
    here, _, _ = detector(series, 10)
    there, _, _ = detector(zero + unit * series, 10)
    # what a large zero leaves of the digits
    np.testing.assert_allclose(there, here, rtol=1e-4 + 1e-12 * abs(zero) / unit)


def test_days_without_data_neither_add_nor_take():
    rng = np.random.default_rng(5)
    table = sound(rng, 50, 1)
    table[20:30] = np.nan
    evidence, _, _ = detector(table, 10)
    with_none, _, _ = detector(np.delete(table, range(20, 30), axis=0), 10)
    # onsets in days without data are onsets of the day behind them
    assert evidence[-1] > 0.5 * with_none[-1]
    assert np.isfinite(evidence).all()


def test_nothing_is_told_before_a_day_has_come_since_the_commissioning():
    evidence, onset, which = detector(np.random.default_rng(0).normal(size=(10, 2)), 10)
    assert not evidence.any()
    assert (onset == -1).all()
    assert (which == -1).all()


@pytest.mark.parametrize("commissioned", [10, 40])
@pytest.mark.parametrize("level", [0.0, 0.3, -20.7, 1e6 / 3.0, 0.0007232851362999529])
def test_days_that_are_all_the_same_are_no_evidence(level, commissioned):
    evidence, _, _ = detector(np.full(60, level), commissioned)
    assert (evidence <= np.maximum(np.arange(60) - commissioned + 1, 0)).all()
    assert not cusum(np.full(60, level), commissioned).any()


def test_nothing_is_told_by_too_few_sound_days():
    evidence, onset, _ = detector(np.r_[np.zeros(3), 100.0 * np.ones(5)], 3)
    assert not evidence.any()
    assert (onset == -1).all()


def test_cumulative_sum_of_a_shift_by_two_scatters_grows_by_one_and_a_half_a_day():
    sound_days = np.tile([-1.0, 1.0], 50)
    scale = np.std(sound_days, ddof=1)
    sums = cusum(np.r_[sound_days, 2.0 * scale * np.ones(4)], 100)
    np.testing.assert_allclose(sums[-4:], [1.5, 3.0, 4.5, 6.0])
    assert not cusum(np.zeros(10), 5).any()


def test_the_detector_is_the_sum_of_the_bayes_factors_of_its_equation():
    rng = np.random.default_rng(8)
    days = 0.3 + 0.1 * rng.normal(size=16)
    days[[3, 12]] = np.nan
    expected = np.zeros(16)
    for d in range(10, 16):
        seen = np.flatnonzero(np.isfinite(days[: d + 1]))
        y = days[seen] - days[seen].mean()
        for k in range(10, d + 1):
            for form in ((seen >= k).astype(float), np.maximum(seen - k + 1, 0) / 10.0):
                about = form - form.mean()
                s, b, r0 = about @ about, about @ y, y @ y
                r1 = r0 - b**2 / (s + 1.0 / 4.0)
                expected[d] += (1.0 + 4.0 * s) ** -0.5 * (r0 / r1) ** ((len(seen) - 1) / 2.0) / 2.0
    np.testing.assert_allclose(detector(days, 10)[0], expected, rtol=1e-9)


def test_evidence_that_was_low_between_is_no_lasting_one():
    from sklvalve.watch.trend import Trend

    def reached(*evidence):
        none = np.zeros((len(evidence), 0))
        return Trend((), (), none, {}, 0, np.array(evidence, dtype=float), none, none, none).reached(5.0, 2)

    assert reached(9, 9, 9, 1, 9, 9, 9) == [2, 6]
    assert reached(9, 1, 9) == reached(9, 9) == reached() == []
