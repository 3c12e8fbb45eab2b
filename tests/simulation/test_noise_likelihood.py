# SPDX-License-Identifier: BSD-3-Clause
"""The likelihood is that of the filter, its slopes are those of the likelihood, and a fit is its summit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.simulation.noise import NoiseModel
from sklvalve.simulation.noise_likelihood import _SPREAD as SPREAD
from sklvalve.simulation.noise_likelihood import PARTS, Bounds, likeliest, loss_and_slopes
from sklvalve.simulation.robust import robust_cost

ROWS = 500
SOME = st.lists(st.floats(-3.0, 3.0), min_size=7, max_size=7)
USUAL = np.array([0.5, 0.01, 0.3, 3.0, 0.2, 100.0, 0.05])
FREE = Bounds(np.zeros(7), np.full(7, np.inf))


def rows_of(seed):
    """Residuals with gaps, steps that are not all alike, and what share and timing multiply."""
    rng = np.random.default_rng(seed)
    residuals = rng.standard_normal(ROWS) + 0.05 * np.cumsum(rng.standard_normal(ROWS))
    residuals[rng.random(ROWS) < 0.05] = np.nan
    steps = np.where(rng.random(ROWS) < 0.1, 2.5, 1.0)
    return residuals, steps, rng.random(ROWS), rng.random(ROWS) ** 2


def parts_of(logs):
    return USUAL * np.exp(logs)


@given(logs=SOME, seed=st.integers(0, 50))
@settings(deadline=None, max_examples=60)
def test_loss_is_that_of_the_filter(logs, seed):
    parts, (residuals, step, level, moving) = parts_of(logs), rows_of(seed)
    base, share, timing, *correlated = parts
    white = np.where(np.isfinite(residuals), base + share * level + timing * moving, np.inf)
    noise = NoiseModel(white, step, *correlated)
    expected = robust_cost(noise.whiten(residuals)) + noise.log_spread
    assert loss_and_slopes(parts, residuals, step, level, moving)[0] == pytest.approx(expected, abs=1e-8)


@given(logs=SOME, seed=st.integers(0, 50))
@settings(deadline=None, max_examples=60)
def test_slopes_agree_with_central_differences(logs, seed):
    parts, rows = parts_of(logs), rows_of(seed)
    slopes = loss_and_slopes(parts, *rows)[1] * parts
    for i in range(len(PARTS)):
        reach = np.zeros(len(PARTS))
        reach[i] = 1e-5
        ends = [loss_and_slopes(parts * np.exp(s * reach), *rows)[0] for s in (1.0, -1.0)]
        # a difference of two losses is exact to the digits of a loss
        exact = 1e-6 * np.abs(slopes).max() + 1e-12 * abs(ends[0]) / 1e-5
        assert slopes[i] == pytest.approx((ends[0] - ends[1]) / 2e-5, abs=exact)


@pytest.mark.parametrize("seed", range(6))
def test_no_part_beside_the_likeliest_is_likelier(seed):
    rows = rows_of(seed)
    found = likeliest(USUAL, FREE, 0.0, rows)

    def cost(parts):
        return loss_and_slopes(parts, *rows)[0] + np.sum(np.log(parts / USUAL) ** 2) / (2.0 * SPREAD**2)

    least = cost(found)
    for i in range(len(PARTS)):
        for times in (0.5, 0.9, 1.1, 2.0):
            beside = found.copy()
            beside[i] *= times
            assert cost(beside) > least - 1e-3


def test_parts_at_a_bound_are_exactly_there():
    rows = rows_of(0)
    low, high = np.zeros(7), np.full(7, np.inf)
    high[PARTS.index("slow")] = high[PARTS.index("fast")] = 0.01
    low[PARTS.index("timing")] = 5.0
    found = dict(zip(PARTS, likeliest(USUAL, Bounds(low, high), 0.0, rows), strict=True))
    assert found["slow"] == 0.01
    assert found["fast"] <= 0.01
    assert found["timing"] == 5.0


def test_white_noise_that_is_there_already_is_not_added():
    rng = np.random.default_rng(1)
    quiet = np.zeros(4000)
    rows = rng.standard_normal(4000), np.ones(4000), quiet, quiet
    only_white = np.full(7, np.inf)
    only_white[[PARTS.index("fast"), PARTS.index("slow")]] = 1e-9
    bounds = Bounds(np.zeros(7), only_white)
    beside = [likeliest(USUAL, bounds, fixed, rows)[0] + fixed for fixed in (0.0, 0.6)]
    # large values weigh less in a robust loss than in a variance
    assert beside[0] == pytest.approx(0.87, abs=0.03)
    assert beside[1] == pytest.approx(beside[0], abs=0.02)
