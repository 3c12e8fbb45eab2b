# SPDX-License-Identifier: BSD-3-Clause
"""Robust cost and bounded steps, against scipy's and by what defines them."""

import numpy as np
import pytest
from scipy.optimize import least_squares, lsq_linear

from sklvalve.simulation.robust import ROBUST_FROM, least_within, robust_cost, robust_weights, step_inside


def _drawn(seed, n=60, p=4):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, p)), 3.0 * rng.standard_t(2, size=n)


def test_cost_is_half_the_square_where_small_and_grows_like_a_line_where_large():
    small = np.array([1e-3, -2e-3])
    assert robust_cost(small) == pytest.approx(0.5 * np.sum(small**2), rel=1e-6)
    far, farther = robust_cost(np.array([1e6])), robust_cost(np.array([2e6]))
    assert farther - far == pytest.approx(ROBUST_FROM * 1e6, rel=1e-4)


def test_weights_are_those_of_the_slope():
    left = np.array([-20.0, -1.0, 0.1, 3.0, 50.0])
    step = 1e-5
    for k in range(len(left)):
        up, down = left.copy(), left.copy()
        up[k] += step
        down[k] -= step
        slope = (robust_cost(up) - robust_cost(down)) / (2.0 * step)
        assert robust_weights(left)[k] * left[k] == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("reach", [0.05, 0.5, 50.0])
def test_step_inside_bounds_is_no_worse_than_stopping_the_free_one_there(seed, reach):
    slopes, errors = _drawn(seed)
    low, high = np.full(4, -reach), np.full(4, reach)
    step = step_inside(slopes.T @ slopes, slopes.T @ errors, low, high)
    assert np.all((step >= low) & (step <= high))
    clipped = np.clip(np.linalg.lstsq(slopes, -errors, rcond=None)[0], low, high)
    exact = lsq_linear(slopes, -errors, (low, high)).cost
    cost = 0.5 * np.sum((errors + slopes @ step) ** 2)
    assert exact - 1e-9 <= cost <= 0.5 * np.sum((errors + slopes @ clipped) ** 2) + 1e-9
    if reach == 50.0:
        assert cost == pytest.approx(exact, rel=1e-10)


def test_what_nothing_speaks_of_stays():
    slopes, errors = _drawn(3)
    slopes[:, 2] = slopes[:, 1]
    step = step_inside(slopes.T @ slopes, slopes.T @ errors, np.full(4, -9.0), np.full(4, 9.0))
    assert np.isfinite(step).all()
    free = lsq_linear(slopes, -errors).cost
    assert 0.5 * np.sum((errors + slopes @ step) ** 2) == pytest.approx(free, rel=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_least_cost_is_nearly_that_of_a_general_optimiser(seed):
    slopes, errors = _drawn(seed)
    low, high = np.full(4, -2.0), np.full(4, 2.0)
    cost, at = least_within(np.ascontiguousarray(slopes.T), errors, low, high)
    assert cost == pytest.approx(robust_cost(errors + slopes @ at), rel=1e-9)
    oracle = least_squares(
        lambda z: errors + slopes @ z, np.zeros(4), bounds=(low, high), loss="soft_l1", f_scale=ROBUST_FROM
    )
    assert oracle.cost - 1e-6 <= cost <= oracle.cost + 0.1 + 1e-3 * oracle.cost
