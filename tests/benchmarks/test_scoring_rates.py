# SPDX-License-Identifier: BSD-3-Clause
"""Rates, their exact intervals, and intervals of other figures."""

import numpy as np
import pytest

from benchmarks.concealed.scoring.rates import (
    Estimate,
    Rate,
    exact,
    macro_of,
    mean_of,
    nothing,
    quantile_of,
    rate_of,
    resampled,
)


def test_intervals_of_rates_are_exact():
    """Against the published limits of Clopper and Pearson: 0 of 10, 1 of 20, all of 5."""
    assert exact(0, 10) == pytest.approx((0.0, 30.85), abs=0.01)
    assert exact(5, 5) == pytest.approx((47.82, 100.0), abs=0.01)
    assert exact(1, 20) == pytest.approx((0.127, 24.87), abs=0.01)
    low, high = exact(23, 36)
    assert low < 100.0 * 23 / 36 < high


def test_an_exact_interval_leaves_out_a_fortieth_on_either_side():
    """At its ends the count seen, or one further off, has a probability of 2.5 %: its definition."""
    from scipy.stats import binom

    low, high = Rate(7, 50).ends
    assert binom.sf(6, 50, low) == pytest.approx(0.025, rel=1e-9)
    assert binom.cdf(7, 50, high) == pytest.approx(0.025, rel=1e-9)


def test_rates_as_text():
    assert str(Rate(0, 0)) == "-"
    assert str(Rate(1, 2)) == "50 % (1-99)"
    assert str(Rate(5, 200)) == "2.5 % (0.8-5.7)"
    assert np.isnan(Rate(0, 0).value)


def test_what_is_not_known_is_not_counted():
    assert rate_of([True, None, False, np.bool_(True)]) == Rate(2, 3)
    assert rate_of([]) == rate_of([None]) == Rate(0, 0)


def test_estimates_as_text():
    nan = float("nan")
    assert str(nothing()) == "-"
    assert str(Estimate(0.031, 0.02, 0.06, 9, "%", 0)) == "3 % (2-6)"
    assert str(Estimate(0.031, nan, nan, 2, "%", 1)) == "3.1 %"
    assert str(Estimate(0.5, -0.25, 0.75, 9)) == "0.50 (-0.25 to 0.75)"


def test_the_mean_and_its_interval():
    assert str(mean_of([])) == str(mean_of([None, float("nan")])) == "-"
    one = mean_of([3.0])
    assert (one.value, one.of) == (3.0, 1)
    assert np.isnan(one.low)
    rng = np.random.default_rng(0)
    values = rng.normal(size=400)
    mean = mean_of(values)
    half = 1.96 * values.std() / np.sqrt(400)
    assert mean.value == pytest.approx(values.mean())
    assert mean.high - mean.low == pytest.approx(2.0 * half, rel=0.06)


def test_figures_of_sums_are_drawn_anew_by_record():
    """Every record has the same ratio: the interval has no width, however the weights differ."""
    ratio = resampled([[1.0, 2.0], [10.0, 20.0], [100.0, 200.0]], lambda s: s[0] / s[1])
    assert (ratio.value, ratio.low, ratio.high) == pytest.approx((0.5, 0.5, 0.5))
    assert str(resampled([[0.0, 0.0], [0.0, 0.0]], lambda s: s[0] / s[1])) == "-"


def test_the_median_lies_between_ranks():
    """Of 9 values the 2nd and the 8th hold the median with 96 %; of 5 no two do with 95 %."""
    median = quantile_of(range(1, 10))
    assert (median.value, median.low, median.high) == (5.0, 2.0, 8.0)
    # all of six lie above the median, or below it, once in 32 times
    six = quantile_of([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert (six.low, six.high) == (1.0, 6.0)
    few = quantile_of([1.0, 2.0, 3.0, 4.0, 5.0])
    assert few.value == 3.0
    assert np.isnan(few.low)
    assert str(quantile_of([])) == "-"


def test_the_interval_of_a_quantile_holds_it_often_enough():
    rng = np.random.default_rng(1)
    held = 0
    for _ in range(300):
        ninth = quantile_of(rng.uniform(size=60), 0.9)
        held += bool(ninth.low <= 0.9 <= ninth.high)
    assert held >= 0.93 * 300


def test_a_mean_over_effects_weighs_each_the_same():
    macro = macro_of([Rate(1, 1), Rate(0, 99), Rate(0, 0)])
    assert macro.value == pytest.approx(0.5)
    assert macro.of == 100
    assert macro.low < 0.5 < macro.high
    sure = macro_of([Rate(5, 5)] * 4)
    # p = 5.5/6: half width 1.96 sqrt(p (1 - p) / 5) / 2
    assert (sure.value, sure.high) == (1.0, 1.0)
    assert sure.low == pytest.approx(1.0 - 0.98 * np.sqrt(5.5 / 6.0 * 0.5 / 6.0 / 5.0))
    assert str(macro_of([])) == "-"
