# SPDX-License-Identifier: BSD-3-Clause
"""`gamma="scale"`: that of scikit-learn's SVR, the same however the rows come."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.svm import SVR

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.choice import SOLVERS

RNG = np.random.default_rng(0)
X = RNG.normal(size=(120, 2)) * [4.0, 9.0] + [50.0, -3.0]
Y = np.sin(X[:, 0] / 4.0) + 0.1 * X[:, 1]
GAMMA = 1.0 / (2.0 * X.var())


def scaled(**parameters):
    return LSSVMRegressor(gamma="scale", random_state=0, n_landmarks=40, **parameters)


@pytest.mark.parametrize("kernel", ["rbf", "laplacian", "poly"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_it_is_that_number(kernel, solver):
    more = {"coef0": 1.0, "degree": 2, "C": 10.0}
    model = scaled(kernel=kernel, solver=solver, **more).fit(X, Y)
    alike = LSSVMRegressor(kernel, gamma=GAMMA, random_state=0, n_landmarks=40, solver=solver, **more)
    assert_allclose(model.gamma_, SVR(gamma="scale").fit(X, Y)._gamma, rtol=1e-13)
    assert_allclose(model.predict(X), alike.fit(X, Y).predict(X), rtol=1e-6, atol=1e-6)


def test_rows_in_parts_have_the_gamma_of_all():
    blocks = [(X[:50], Y[:50]), (X[50:], Y[50:])]
    assert_allclose(scaled().fit_blocks(blocks).gamma_, GAMMA, rtol=1e-13)
    first = scaled().partial_fit(*blocks[0])
    assert_allclose(first.gamma_, 1.0 / (2.0 * X[:50].var()), rtol=1e-13)
    # the function stays that of the first rows
    assert first.gamma_ == first.partial_fit(*blocks[1]).gamma_
    array = pytest.importorskip("dask.array", reason="needs Dask, of the extra `distributed`")
    lazy = array.from_array(X, chunks=(50, 2)), array.from_array(Y, chunks=50)
    assert_allclose(scaled().fit(*lazy).gamma_, GAMMA, rtol=1e-13)


def test_on_a_device_too():
    strict = pytest.importorskip("array_api_strict")
    from sklearn import config_context

    try:
        with config_context(array_api_dispatch=True):
            model = scaled().fit(strict.asarray(X), strict.asarray(Y))
    except (ImportError, RuntimeError) as error:
        pytest.skip(str(error))
    assert_allclose(model.gamma_, GAMMA, rtol=1e-12)


def test_weights_count_as_repeated_rows():
    weight = np.arange(120) % 3
    assert_allclose(
        scaled().fit(X, Y, sample_weight=weight).gamma_,
        scaled().fit(np.repeat(X, weight, axis=0), np.repeat(Y, weight)).gamma_,
        rtol=1e-12,
    )


def test_other_values_are_told_as_numbers():
    assert LSSVMRegressor().fit(X, Y).gamma_ == 0.5
    assert LSSVMRegressor(gamma=0.1).fit(X, Y).gamma_ == 0.1
    assert LSSVMRegressor("linear", gamma="scale").fit(X, Y).gamma_ is None
    assert scaled().fit(np.ones((9, 2)), Y[:9]).gamma_ == 1.0
    assert LSSVMRegressor("precomputed", gamma="scale").fit(X @ X.T / 100.0, Y).gamma_ is None
    with pytest.raises(ValueError, match="'gamma' parameter"):
        LSSVMRegressor(gamma="auto").fit(X, Y)


def test_fewer_rows_and_a_known_solution_keep_the_function():
    model = scaled(C=10.0).fit(X, Y)
    fewer = model.pruned(100)
    assert fewer.gamma_ == model.gamma_
    assert fewer.gamma == "scale"
    assert_allclose(fewer.predict(X), model.predict(X), atol=0.05)
    with pytest.raises(ValueError, match="needs the rows of a fit; set gamma to the number"):
        scaled().with_solution(model.X_fit_, model.dual_coef_, model.intercept_)
