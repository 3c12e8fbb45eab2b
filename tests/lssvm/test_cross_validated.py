# SPDX-License-Identifier: BSD-3-Clause
"""C and gamma chosen in closed form, against machines that are fitted without the rows they are asked for."""

import numpy as np
import pytest
from sklearn.model_selection import GridSearchCV, KFold

from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV, left_out
from sklvalve.lssvm.kernels import kernel_between
from sklvalve.lssvm.left_out import LeftOut

BIASES = ("free", "regularized", "none")


def some(n=90, seed=0, noise=0.05):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, 3))
    y = np.column_stack([np.sin(X.sum(axis=1)) + 100.0, X[:, 0]])
    return X, y + noise * rng.normal(size=y.shape), rng.uniform(0.3, 3.0, n)


def without(X, y, weight, out, rows, bias):
    kept = np.setdiff1d(np.arange(len(X)), out)
    machine = LSSVMRegressor(C=50.0, gamma=0.3, bias=bias).fit(X[kept], y[kept], weight[kept])
    return y[rows] - machine.predict(X[rows])


@pytest.mark.parametrize("whole", [1000, 0], ids=["eigenvalues", "inverse"])
@pytest.mark.parametrize("bias", BIASES)
def test_leaving_one_out_is_fitting_without_it(bias, whole, monkeypatch):
    X, y, weight = some()
    # a low rank of ninety rough rows is too poor, so that the matrix is inverted
    monkeypatch.setattr(left_out, "_WHOLE", whole)
    between = kernel_between("rbf", gamma=0.3)
    found = LeftOut(between, X, weight, largest_C=50.0, bias=bias, random_state=np.random.RandomState(0))
    known = np.vstack([without(X, y, weight, [i], [i], bias) for i in range(len(X))])
    np.testing.assert_allclose(found.errors(50.0, y), known, atol=1e-8)


def test_a_low_rank_that_is_good_enough_moves_no_score(monkeypatch):
    X, y, weight = some(1200, noise=0.01)
    between = kernel_between("rbf", gamma=0.1)
    more = {"largest_C": 1e3, "random_state": np.random.RandomState(0)}
    found = LeftOut(between, X, weight, **more)
    assert found.method == "low rank"
    monkeypatch.setattr(left_out, "_WHOLE", 2000)
    known = LeftOut(between, X, weight, **more)
    assert known.method == "eigenvalues"
    for C in (1.0, 1e2, 1e3):
        scores = [np.sqrt(np.mean(each.errors(C, y) ** 2)) for each in (found, known)]
        assert scores[0] == pytest.approx(scores[1], rel=1e-3)


@pytest.mark.parametrize("bias", BIASES)
def test_leaving_a_block_out_with_its_gap(bias):
    X, y, weight = some()
    rows, between = np.arange(90), kernel_between("rbf", gamma=0.3)
    held = [rows[:20], rows[20:50], rows[60:]]
    out = [rows[:25], rows[15:55], rows[55:]]
    more = {
        "bias": bias,
        "blocks": list(zip(held, out, strict=True)),
        "random_state": np.random.RandomState(0),
    }
    errors = LeftOut(between, X, weight, largest_C=50.0, **more).errors(50.0, y)
    for block, gone in zip(held, out, strict=True):
        np.testing.assert_allclose(errors[block], without(X, y, weight, gone, block, bias), atol=1e-8)
    assert np.isnan(errors[50:60]).all()


def test_a_gap_leaves_out_more_and_counts_no_more():
    X, y, _ = some(120)
    found = LSSVMRegressorCV(Cs=[50.0], gammas=[0.3], cv=4, gap=7).fit(X, y)
    rows = np.arange(30, 60)
    known = without(X, y, np.ones(120), np.arange(23, 67), rows, "free")
    np.testing.assert_allclose(found.loo_residuals_[rows], known, atol=1e-8)
    assert np.isfinite(found.loo_residuals_).all()


def test_blocks_choose_what_a_grid_search_over_them_chooses():
    X, y, _ = some(120, noise=0.3)
    Cs, gammas = [0.1, 1.0, 10.0, 100.0, 1000.0], [0.03, 0.3, 3.0]
    found = LSSVMRegressorCV(Cs=Cs, gammas=gammas, cv=4).fit(X, y[:, 0])
    grid = {"C": Cs, "gamma": gammas}
    search = GridSearchCV(LSSVMRegressor(), grid, cv=KFold(4), scoring="neg_mean_squared_error")
    search.fit(X, y[:, 0])
    assert search.best_params_ == {"C": found.best_C_, "gamma": found.best_gamma_}
    assert found.best_score_ == pytest.approx(np.sqrt(-search.best_score_), rel=1e-6)
    np.testing.assert_allclose(found.predict(X), search.predict(X), rtol=1e-9)
    shuffled = KFold(4, shuffle=True, random_state=3)
    found = LSSVMRegressorCV(Cs=Cs, gammas=gammas, cv=shuffled).fit(X, y[:, 0])
    search = GridSearchCV(LSSVMRegressor(), grid, cv=shuffled, scoring="neg_mean_squared_error")
    assert search.fit(X, y[:, 0]).best_params_ == {"C": found.best_C_, "gamma": found.best_gamma_}


def test_what_it_tells_of_the_choice():
    X, y, weight = some()
    weight[::9] = 0.0
    found = LSSVMRegressorCV(gammas=[0.1, 0.3], Cs=[1.0, 10.0, 100.0]).fit(X, y, weight)
    assert found.scores_.shape == (2, 3)
    assert found.best_score_ == pytest.approx(found.scores_.min())
    assert found.loo_residuals_.shape == y.shape
    assert np.isnan(found.loo_residuals_[::9]).all()
    known = np.isfinite(found.loo_residuals_[:, 0])
    assert known.sum() == (weight > 0.0).sum()
    plain = LSSVMRegressor(C=found.best_C_, gamma=found.best_gamma_).fit(X, y, weight)
    np.testing.assert_array_equal(found.predict(X), plain.predict(X))
    np.testing.assert_array_equal(found.dual_coef_, plain.dual_coef_)
    np.testing.assert_array_equal(found.intercept_, plain.intercept_)
    np.testing.assert_array_equal(found.X_fit_, plain.X_fit_)


def test_gamma_is_compared_on_some_rows_and_c_on_all():
    X, y, _ = some(2600, noise=0.2)
    found = LSSVMRegressorCV(gammas=[0.02, 0.3], Cs=[1.0, 10.0], random_state=0).fit(X, y[:, 0])
    assert found.best_gamma_ in (0.02, 0.3)
    assert np.isfinite(found.loo_residuals_).all()
    assert found.best_score_ == pytest.approx(np.sqrt(np.mean(found.loo_residuals_**2)))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"Cs": []}, "Cs must hold positive finite numbers"),
        ({"Cs": [1.0, -1.0]}, "Cs must hold positive finite numbers"),
        ({"gammas": [np.nan]}, "gammas must hold positive finite numbers"),
        ({"cv": 2, "gap": 500}, "leaves no row to fit"),
    ],
)
def test_wrong_paths(wrong, message):
    X, y, _ = some()
    with pytest.raises(ValueError, match=message):
        LSSVMRegressorCV(**wrong).fit(X, y)


def test_one_row_cannot_be_left_out():
    X, y, weight = some()
    weight[1:] = 0.0
    with pytest.raises(ValueError, match="at least two"):
        LSSVMRegressorCV().fit(X, y, weight)


def test_a_gamma_for_each_column_tells_which_matter():
    rng = np.random.default_rng(3)
    X = rng.normal(size=(300, 3))
    y = np.sin(2.0 * X[:, 0]) + 0.3 * X[:, 1] + 0.02 * rng.normal(size=300)
    one = LSSVMRegressorCV(random_state=0).fit(X, y)
    each = LSSVMRegressorCV(per_feature=True, random_state=0).fit(X, y)
    assert each.best_gamma_.shape == (3,)
    # the last says nothing, the second hardly bends
    assert each.best_gamma_[0] > 10.0 * each.best_gamma_[1]
    assert each.best_gamma_[0] > 100.0 * each.best_gamma_[2]
    assert each.best_score_ < 0.8 * one.best_score_
    fresh = rng.normal(size=(500, 3))
    flow = np.sin(2.0 * fresh[:, 0]) + 0.3 * fresh[:, 1]
    far = [np.sqrt(np.mean((model.predict(fresh) - flow) ** 2)) for model in (one, each)]
    assert far[1] < 0.5 * far[0]


def test_what_is_known_of_the_spread_is_passed_on():
    rng = np.random.default_rng(4)
    X = rng.uniform(-2.0, 2.0, size=(200, 1))
    y = np.sin(X[:, 0]) + 0.1 * rng.normal(size=200)
    model = LSSVMRegressorCV(uncertainty=True, random_state=0).fit(X, y)
    fresh = rng.uniform(-2.0, 2.0, size=(2000, 1))
    target = np.sin(fresh[:, 0]) + 0.1 * rng.normal(size=2000)
    low, high = model.predict_interval(fresh, coverage=0.9)
    assert np.mean((low <= target) & (target <= high)) == pytest.approx(0.9, abs=0.05)
    np.testing.assert_allclose(model.estimator_.loo_residuals_, model.loo_residuals_, atol=1e-8)
