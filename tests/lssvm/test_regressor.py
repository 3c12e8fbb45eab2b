# SPDX-License-Identifier: BSD-3-Clause

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import LinAlgWarning
from sklearn import config_context
from sklearn.base import clone
from sklearn.kernel_ridge import KernelRidge
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.metrics.pairwise import laplacian_kernel, polynomial_kernel, rbf_kernel
from sklearn.model_selection import GridSearchCV, cross_validate

from sklvalve.lssvm import LSSVMRegressor, kernels

BIASES = ["free", "regularized", "none"]


def make_data(n=80, n_features=3, seed=0, targets=None):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, n_features))
    y = np.sin(X[:, 0]) + 0.3 * X[:, -1] + 5.0 + 0.05 * rng.normal(size=n)
    if targets:
        y = np.column_stack([y * (k + 1) + k for k in range(targets)])
    return X, y, rng.uniform(0.1, 3.0, n)


@pytest.mark.parametrize("C", [1e-2, 1.0, 1e4])
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("targets", [None, 2])
def test_linear_kernel_with_free_bias_is_ridge(C, weighted, targets):
    X, y, weight = make_data(targets=targets)
    weight = weight if weighted else None
    ours = LSSVMRegressor("linear", C=C).fit(X, y, sample_weight=weight)
    ridge = Ridge(alpha=1 / C).fit(X, y, sample_weight=weight)
    np.testing.assert_allclose(ours.predict(X), ridge.predict(X), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose((ours.dual_coef_.T @ ours.X_fit_), ridge.coef_, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(ours.intercept_, ridge.intercept_, rtol=1e-10)


@pytest.mark.parametrize(
    "parameters",
    [
        {"kernel": "rbf", "gamma": 0.3},
        {"kernel": "rbf"},
        {"kernel": "linear"},
        {"kernel": "polynomial", "degree": 2, "coef0": 0.5},
        {"kernel": "laplacian", "gamma": 0.2},
    ],
)
@pytest.mark.parametrize("weighted", [False, True])
def test_no_bias_is_kernel_ridge(parameters, weighted):
    X, y, weight = make_data()
    weight = weight if weighted else None
    ours = LSSVMRegressor(C=20.0, bias="none", **parameters).fit(X, y, sample_weight=weight)
    theirs = KernelRidge(alpha=1 / 20.0, **parameters).fit(X, y, sample_weight=weight)
    queries = make_data(seed=1)[0]
    np.testing.assert_allclose(ours.predict(queries), theirs.predict(queries), rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(ours.dual_coef_, theirs.dual_coef_, rtol=1e-7, atol=1e-8)
    assert ours.intercept_ == 0.0


@pytest.mark.parametrize("weighted", [False, True])
def test_regularized_bias_is_kernel_ridge_with_one_added_to_the_kernel(weighted):
    X, y, weight = make_data()
    weight = weight if weighted else None
    ours = LSSVMRegressor(C=20.0, gamma=0.4, bias="regularized").fit(X, y, sample_weight=weight)
    theirs = KernelRidge(alpha=1 / 20.0, kernel="precomputed")
    theirs.fit(rbf_kernel(X, gamma=0.4) + 1, y, sample_weight=weight)
    queries = make_data(seed=1)[0]
    expected = theirs.predict(rbf_kernel(queries, X, gamma=0.4) + 1)
    np.testing.assert_allclose(ours.predict(queries), expected, rtol=1e-10)
    np.testing.assert_allclose(ours.intercept_, ours.dual_coef_.sum(), rtol=1e-10)


@settings(deadline=None, max_examples=30)
@given(
    C=st.floats(1e-2, 1e4),
    offset=st.floats(-1e6, 1e6),
    seed=st.integers(0, 100),
    kernel=st.sampled_from(["rbf", "linear", "poly", "laplacian"]),
)
def test_free_bias_balances_and_shifts_with_y(C, offset, seed, kernel):
    X, y, weight = make_data(n=40, seed=seed)
    model = LSSVMRegressor(kernel, C=C).fit(X, y, sample_weight=weight)
    assert abs(model.dual_coef_.sum()) <= 1e-10 * np.abs(model.dual_coef_).sum()
    moved = LSSVMRegressor(kernel, C=C).fit(X, y + offset, sample_weight=weight)
    np.testing.assert_allclose(
        moved.predict(X) - offset, model.predict(X), atol=1e-9 * (1 + abs(offset)), rtol=0
    )


@pytest.mark.parametrize("bias", BIASES)
def test_the_equations_are_met(bias):
    X, y, weight = make_data()
    C = 50.0
    model = LSSVMRegressor(C=C, bias=bias).fit(X, y, sample_weight=weight)
    np.testing.assert_allclose(model.predict(X) + model.dual_coef_ / (C * weight), y, atol=1e-10)


@pytest.mark.parametrize("bias", BIASES)
def test_weight_k_is_the_row_k_times_and_weight_zero_no_row(bias):
    X, y, _ = make_data(n=40)
    count = np.random.default_rng(3).integers(0, 4, 40)
    weighted = LSSVMRegressor(C=10.0, bias=bias).fit(X, y, sample_weight=count)
    repeated = LSSVMRegressor(C=10.0, bias=bias).fit(np.repeat(X, count, axis=0), np.repeat(y, count))
    np.testing.assert_allclose(weighted.predict(X), repeated.predict(X), rtol=1e-10)
    assert len(weighted.dual_coef_) == len(weighted.X_fit_) == np.count_nonzero(count)


@pytest.mark.parametrize("bias", BIASES)
@pytest.mark.parametrize(
    ("kernel", "function"),
    [
        ("rbf", lambda A, B: rbf_kernel(A, B, gamma=0.5)),
        ("laplacian", lambda A, B: laplacian_kernel(A, B, gamma=0.5)),
        ("poly", lambda A, B: polynomial_kernel(A, B, degree=2, gamma=0.5, coef0=1)),
    ],
)
def test_precomputed_and_named_kernels_agree(kernel, function, bias):
    X, y, weight = make_data(targets=2)
    weight[:7] = 0.0
    queries = make_data(n=11, seed=1)[0]
    named = LSSVMRegressor(kernel, gamma=0.5, degree=2, bias=bias).fit(X, y, sample_weight=weight)
    given_matrix = LSSVMRegressor("precomputed", bias=bias).fit(function(X, X), y, sample_weight=weight)
    np.testing.assert_allclose(
        named.predict(queries), given_matrix.predict(function(queries, X)), rtol=1e-9, atol=1e-10
    )
    assert given_matrix.X_fit_ is None
    assert not given_matrix.dual_coef_[:7].any()


def test_a_precomputed_matrix_is_left_as_it_was():
    X, y, _ = make_data()
    matrix = np.asfortranarray(rbf_kernel(X))
    before = matrix.copy()
    LSSVMRegressor("precomputed").fit(matrix, y)
    np.testing.assert_array_equal(matrix, before)


def row_kernel(a, b, scale=1.0):
    return np.exp(-scale * np.sum((a - b) ** 2))


def test_a_callable_kernel_with_its_keywords():
    X, y, _ = make_data(n=30)
    called = LSSVMRegressor(row_kernel, kernel_params={"scale": 0.5}).fit(X, y)
    named = LSSVMRegressor("rbf", gamma=0.5).fit(X, y)
    np.testing.assert_allclose(called.predict(X), named.predict(X), rtol=1e-10)


def test_several_targets_are_several_fits():
    X, y, weight = make_data(targets=3)
    together = LSSVMRegressor(C=10.0).fit(X, y, sample_weight=weight)
    assert together.dual_coef_.shape == (80, 3)
    assert together.intercept_.shape == (3,)
    for k in range(3):
        alone = LSSVMRegressor(C=10.0).fit(X, y[:, k], sample_weight=weight)
        assert isinstance(alone.intercept_, float)
        np.testing.assert_allclose(together.predict(X)[:, k], alone.predict(X), rtol=1e-12)


@pytest.mark.parametrize("kernel", ["rbf", "laplacian", "linear"])
def test_a_large_offset_of_the_columns_costs_no_accuracy(kernel):
    X, y, _ = make_data()
    near = LSSVMRegressor(kernel, C=1e3).fit(X, y).predict(X)
    far = LSSVMRegressor(kernel, C=1e3).fit(X + 1e6, y).predict(X + 1e6)
    np.testing.assert_allclose(far, near, atol=1e-6, rtol=0)


def test_blocks_change_nothing(monkeypatch):
    X, y, _ = make_data(n=101)
    whole = LSSVMRegressor(C=10.0).fit(X, y).predict(X)
    monkeypatch.setattr(kernels, "BLOCK", 700)
    np.testing.assert_allclose(LSSVMRegressor(C=10.0).fit(X, y).predict(X), whole, rtol=1e-12)


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("bias", BIASES)
def test_one_or_two_rows(n, bias):
    X = np.zeros((n, 2))
    model = LSSVMRegressor(C=1e3, bias=bias).fit(X, np.full(n, 4.0))
    expected = {"free": 4.0, "regularized": 4 * 2 * n / (2 * n + 1e-3), "none": 4 * n / (n + 1e-3)}[bias]
    np.testing.assert_allclose(model.predict(X), expected, rtol=1e-12)


@pytest.mark.parametrize("gamma", [1e-8, 1e4])
def test_extreme_widths_stay_finite_and_sensible(gamma):
    X, y, _ = make_data()
    prediction = LSSVMRegressor(gamma=gamma, C=100.0).fit(X, y).predict(X)
    assert np.abs(prediction - y.mean()).max() <= 1.5 * np.abs(y - y.mean()).max()


def test_equal_rows_and_a_huge_c_are_met_half_way():
    rng = np.random.default_rng(0)
    X = np.repeat(np.linspace(0, 3, 8)[:, None], 2, axis=0)
    y = np.sin(X[:, 0]) + 0.1 * rng.normal(size=16)
    model = LSSVMRegressor(C=1e17, gamma=3.0).fit(X, y)
    assert model.X_fit_.shape == (8, 1)
    np.testing.assert_allclose(model.predict(X[::2]), (y[::2] + y[1::2]) / 2, atol=1e-6)
    uneven = LSSVMRegressor(C=1e17, gamma=3.0).fit(X, y, np.tile([3.0, 1.0], 8))
    np.testing.assert_allclose(uneven.predict(X[::2]), (3 * y[::2] + y[1::2]) / 4, atol=1e-6)


def test_linear_kernel_with_a_large_c_is_ordinary_least_squares():
    X, y, _ = make_data()
    expected = LinearRegression().fit(X, y).predict(X)
    np.testing.assert_allclose(LSSVMRegressor("linear", C=1e7).fit(X, y).predict(X), expected, atol=1e-6)
    # The ones of the bias lie outside the range of a matrix of rank 3, so the border must be solved with it.
    with pytest.warns(LinAlgWarning, match="not positive definite"):
        singular = LSSVMRegressor("linear", C=1e17).fit(X, y)
    np.testing.assert_allclose(singular.predict(X), expected, atol=1e-9)
    with pytest.warns(LinAlgWarning, match=r"met only to.*lower C"):
        LSSVMRegressor("linear", C=1e10).fit(X, y)


@pytest.mark.parametrize("C", [1e13, 1e15, 1e300])
@pytest.mark.parametrize("bias", ["free", "regularized", "none"])
def test_rows_that_contradict_each_other_are_met_half_way(C, bias):
    rng = np.random.default_rng(0)
    X = rng.normal(size=(60, 2))
    y = np.sin(X[:, 0])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        model = LSSVMRegressor(C=C, bias=bias).fit(np.vstack([X, X]), np.concatenate([y, y + 1.0]))
    assert model.residual_ <= model.tol or told
    np.testing.assert_allclose(model.predict(X), y + 0.5, atol=1e-3)


def test_equations_that_cannot_be_met_are_told():
    rng = np.random.default_rng(0)
    X = np.repeat(rng.normal(size=(200, 2)), 2, axis=0)
    y = rng.normal(size=400)
    with pytest.warns(LinAlgWarning, match=r"not positive definite|met only to"):
        LSSVMRegressor(C=1e14, gamma=0.1).fit(X, y)


def test_bad_input_gets_one_plain_sentence():
    X, y, weight = make_data()
    with pytest.raises(ValueError, match=r"not finite.*scale it"):
        LSSVMRegressor().fit(X * 1e300, y)
    with pytest.raises(ValueError, match=r"not finite.*scale it"):
        LSSVMRegressor("linear").fit(X * 1e200, y)
    with pytest.raises(ValueError, match=r"not positive|non-zero|zero"):
        LSSVMRegressor().fit(X, y, sample_weight=0 * weight)
    with pytest.raises(ValueError, match=r"[Nn]egative"):
        LSSVMRegressor().fit(X, y, sample_weight=-weight)
    with pytest.raises(ValueError, match="must be square"):
        LSSVMRegressor("precomputed").fit(X, y)
    with pytest.raises(ValueError, match="The 'C' parameter"):
        LSSVMRegressor(C=0).fit(X, y)
    for C in (1e-310, 1e-320):
        with pytest.raises(ValueError, match=r"C = .* is so small"):
            LSSVMRegressor(C=C).fit(X, y)
        with pytest.raises(ValueError, match=r"C = .* is so small"):
            LSSVMRegressor(C=C).fit(X, y, sample_weight=weight)
    with pytest.raises(ValueError, match="The 'bias' parameter"):
        LSSVMRegressor(bias="maybe").fit(X, y)


def test_grid_search_slices_a_precomputed_kernel():
    X, y, _ = make_data()
    grid = {"C": [0.1, 1.0, 10.0]}
    named = GridSearchCV(LSSVMRegressor(gamma=0.5), grid, cv=3).fit(X, y)
    matrix = GridSearchCV(LSSVMRegressor("precomputed"), grid, cv=3).fit(rbf_kernel(X, gamma=0.5), y)
    np.testing.assert_allclose(
        named.cv_results_["mean_test_score"], matrix.cv_results_["mean_test_score"], rtol=1e-9
    )


def test_sample_weight_is_routed_where_routing_is_on():
    X, y, weight = make_data()
    weight[:40] = 0.0
    with config_context(enable_metadata_routing=True):
        model = LSSVMRegressor().set_fit_request(sample_weight=True).set_score_request(sample_weight=False)
        results = cross_validate(
            clone(model), X, y, params={"sample_weight": weight}, cv=4, return_estimator=True
        )
    assert [len(fitted.X_fit_) for fitted in results["estimator"]] == [40, 40, 20, 20]
