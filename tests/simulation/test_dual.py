# SPDX-License-Identifier: BSD-3-Clause
"""Dual numbers: what compiled code makes of them is what it makes of numbers, with its derivatives."""

from math import exp, sqrt

import numba as nb
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.simulation.dual import dual, kept


@nb.njit
def _arithmetic(a, b):
    return (a * b - b / (1.0 + a * a) + 2.0 * a - 3.0) / (b * b + 1.0) - (-a) + a / 4.0 + 1.0 / (2.0 + b * b)


@nb.njit
def _functions(a, b):
    return exp(-a * a) * sqrt(1.0 + b * b) + abs(a - 0.3) * abs(b)


@nb.njit
def _choices(a, b):
    y = 0.5
    if a > b:
        y = min(a, 1.0) * max(b, -1.0)
    elif a >= -b and a != 0.0:
        y += max(0.0, a * b)
    if b <= 0.0 or b == 7.0 or not a < 2.0:
        y -= min(2.0, b)
    return y


@nb.njit
def _loop(a, b):
    left, total = 1.0, 0.0
    while left > 0.05:
        step = min(0.3, left) if total < 1.0 else left * 0.5
        total += step * (a + left * b)
        left -= step
    return total


def _by(function):
    """Values and slopes of a function of two numbers for rows of them."""

    @nb.njit
    def rows(a, b, slopes_a, slopes_b, like):
        out, slopes = np.empty(len(a)), np.empty((len(a), len(like)))
        for k in range(len(a)):
            made = function(dual(a[k], slopes_a, k, like), dual(b[k], slopes_b, k, like))
            out[k] = kept(made, slopes, k)
        return out, slopes

    return rows


CASES = {f.py_func.__name__: (f, _by(f)) for f in (_arithmetic, _functions, _choices, _loop)}
numbers = st.floats(-3.0, 3.0).map(lambda x: round(x, 3) + 1e-4)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("width", [8, 16])
@settings(deadline=None, derandomize=True)
@given(a=numbers, b=numbers)
def test_slopes_are_those_of_differences(name, width, a, b):
    plain, rows = CASES[name]
    towards = np.zeros((2, 1, width))
    towards[0, 0, 0], towards[1, 0, 1] = 1.0, 1.0
    towards[:, 0, width - 1] = 2.0, -3.0
    out, slopes = rows(np.array([a]), np.array([b]), *towards, (0,) * width)
    assert out[0] == pytest.approx(plain(a, b), rel=1e-14, abs=1e-14)
    # corners lie at round numbers, and where the two are equal
    if abs(abs(a) - abs(b)) < 1e-3:
        return
    h = 1e-5
    by_a = (plain(a + h, b) - plain(a - h, b)) / (2 * h)
    by_b = (plain(a, b + h) - plain(a, b - h)) / (2 * h)
    assert slopes[0, 0] == pytest.approx(by_a, rel=1e-6, abs=1e-7)
    assert slopes[0, 1] == pytest.approx(by_b, rel=1e-6, abs=1e-7)
    assert slopes[0, width - 1] == pytest.approx(2.0 * by_a - 3.0 * by_b, rel=1e-6, abs=1e-7)
    assert not slopes[0, 2 : width - 1].any()


def test_a_root_at_zero_has_no_slope():
    @nb.njit
    def root(a, b):
        return sqrt(a) + b

    ones = np.ones((1, 8))
    out, slopes = _by(root)(np.zeros(1), np.zeros(1), ones, ones, (0,) * 8)
    assert out[0] == 0.0
    assert slopes[0].tolist() == [1.0] * 8
