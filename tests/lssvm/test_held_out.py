# SPDX-License-Identifier: BSD-3-Clause
"""Held-out errors from one inverse are those of machines fitted without the rows."""

import numpy as np
import pytest

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.held_out import blocked_errors, least_in_error


@pytest.mark.parametrize("gap", [0, 3])
@pytest.mark.parametrize("C", [1.0, 500.0])
def test_errors_are_those_of_fits_without_the_rows(gap, C):
    rng = np.random.default_rng(0)
    X = rng.normal(size=(90, 2))
    Y = np.column_stack([np.sin(X[:, 0]) + 3.0, X[:, 1] ** 2 + 0.1 * rng.normal(size=90)])
    blocks = [slice(0, 30), slice(30, 50), slice(50, 90)]
    found = blocked_errors(X, C=C, gamma=0.7, blocks=blocks, gap=gap)(Y)
    for block in blocks:
        rest = np.ones(90, dtype=bool)
        rest[max(block.start - gap, 0) : block.stop + gap] = False
        machine = LSSVMRegressor(C=C, gamma=0.7).fit(X[rest], Y[rest])
        assert np.allclose(found[block], Y[block] - machine.predict(X[block]), atol=1e-8)


def test_rows_of_no_block_have_no_error():
    X = np.linspace(0.0, 1.0, 20)[:, None]
    errors = blocked_errors(X, C=10.0, gamma=1.0, blocks=[slice(0, 5)])(X[:, 0])
    assert np.isfinite(errors[:5]).all()
    assert np.isnan(errors[5:]).all()


def test_a_block_of_everything_is_refused():
    X = np.linspace(0.0, 1.0, 20)[:, None]
    with pytest.raises(ValueError, match="leaves no row to fit"):
        blocked_errors(X, C=10.0, gamma=1.0, blocks=[slice(0, 20)])


@pytest.mark.parametrize("seed", range(4))
def test_the_least_error_is_that_of_all_pairs(seed):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(80, 3))
    y = np.sin(X[:, 0]) + 5.0 + rng.normal(size=80) * rng.choice([0.01, 0.5])
    blocks = [slice(low, low + 20) for low in range(0, 80, 20)]
    gammas, Cs = (0.01, 0.3, 3.0), (1000.0, 1.0)
    errors = {
        (gamma, C): np.sum(blocked_errors(X, C=C, gamma=gamma, blocks=blocks)(y) ** 2)
        for gamma in gammas
        for C in Cs
    }
    assert least_in_error(X, y, gammas=gammas, Cs=Cs, blocks=blocks) == min(errors, key=errors.get)


def test_what_is_no_kernel_is_refused():
    X = np.linspace(-1.0, 1.0, 20)[:, None]
    with pytest.raises(ValueError, match="not positive definite"):
        least_in_error(
            X, X[:, 0], gammas=(1.0,), Cs=(1e6,), blocks=[slice(0, 10)], kernel=lambda a, b: -float(a @ b)
        )
