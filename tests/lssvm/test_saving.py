# SPDX-License-Identifier: BSD-3-Clause
"""Saved and loaded models predict the same numbers, however they were fitted."""

import io
import pickle

import joblib
import numpy as np
import pandas as pd
import pytest
from sklearn.metrics.pairwise import rbf_kernel
from sklearn.utils import check_random_state

from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.lssvm.choice import SOLVERS

OWN = "sklvalve.lssvm.regressor.LSSVMRegressor"
OWN_CV = "sklvalve.lssvm.cross_validated.LSSVMRegressorCV"


def some(n=150, seed=0):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, 3))
    y = np.column_stack([np.sin(X.sum(axis=1)), 2.0 * X[:, 0] + 7.0])
    return X, y + 0.01 * rng.normal(size=y.shape)


X, Y = some()
QUERIES = some(40, seed=1)[0]


def partly(**parameters):
    model = LSSVMRegressor(random_state=0, **parameters)
    return model.partial_fit(X[:100], Y[:100]).partial_fit(X[100:], Y[100:])


def by_blocks(**parameters):
    model = LSSVMRegressor(n_landmarks=60, random_state=0, **parameters)
    return model.fit_blocks([(X[:100], Y[:100]), (X[100:], Y[100:])])


FITTED = {
    **{
        solver: lambda solver=solver: LSSVMRegressor(solver=solver, n_landmarks=60, random_state=0).fit(X, Y)
        for solver in SOLVERS
    },
    **{
        kernel: lambda kernel=kernel: LSSVMRegressor(kernel, gamma=[0.2, 0.5, 0.9]).fit(X, Y)
        for kernel in ("rbf", "laplacian", "linear", "poly")
    },
    "one target": lambda: LSSVMRegressor().fit(X, Y[:, 0]),
    "float": lambda: LSSVMRegressor().fit(X.astype(np.float32), Y.astype(np.float32)),
    "named columns": lambda: LSSVMRegressor().fit(pd.DataFrame(X, columns=list("abc")), Y),
    "gamma in an array": lambda: LSSVMRegressor(gamma=np.array([0.2, 0.5, 0.9])).fit(X, Y),
    "weights": lambda: LSSVMRegressor().fit(X, Y, sample_weight=np.arange(150.0)),
    "random state": lambda: LSSVMRegressor(random_state=check_random_state(0)).fit(X, Y),
    "partial_fit": partly,
    "partial_fit of one target": lambda: LSSVMRegressor(random_state=0).partial_fit(X, Y[:, 0]),
    "fit_blocks": by_blocks,
    "fit_blocks with uncertainty": lambda: by_blocks(uncertainty=True),
    "robust_passes": lambda: LSSVMRegressor(robust_passes=2).fit(X, Y),
    "uncertainty": lambda: LSSVMRegressor(uncertainty=True, random_state=0).fit(X, Y),
    "robust_passes with uncertainty": lambda: LSSVMRegressor(
        robust_passes=1, uncertainty=True, solver="nystrom", n_landmarks=60, random_state=0
    ).fit(X, Y),
    "pruned": lambda: LSSVMRegressor(random_state=0).fit(X, Y).pruned(60),
    "CV": lambda: LSSVMRegressorCV().fit(X, Y),
    "CV in blocks": lambda: LSSVMRegressorCV("laplacian", cv=3, gammas=[0.1, 0.5]).fit(X, Y[:, 0]),
    "CV by landmarks": lambda: LSSVMRegressorCV("rbf", solver="nystrom", n_landmarks=60, random_state=0).fit(
        X, Y
    ),
}


def pickled(model):
    return pickle.loads(pickle.dumps(model))


def by_joblib(model, compress=0):
    file = io.BytesIO()
    joblib.dump(model, file, compress=compress)
    file.seek(0)
    return joblib.load(file)


def by_compressing_joblib(model):
    return by_joblib(model, compress=3)


def by_skops(model):
    sio = pytest.importorskip("skops.io", reason="needs skops, of the extra `skops`")
    saved = sio.dumps(model)
    untrusted = sio.get_untrusted_types(data=saved)
    assert set(untrusted) == {OWN} | ({OWN_CV} if isinstance(model, LSSVMRegressorCV) else set())
    return sio.loads(saved, trusted=untrusted)


WAYS = [pickled, by_joblib, by_compressing_joblib, by_skops]


def assert_the_same(loaded, model, queries):
    np.testing.assert_array_equal(loaded.predict(queries), model.predict(queries))
    if getattr(model, "uncertainty", False):
        for found, known in zip(
            [*loaded.predict(queries, return_std=True), *loaded.predict_interval(queries)],
            [*model.predict(queries, return_std=True), *model.predict_interval(queries)],
            strict=True,
        ):
            np.testing.assert_array_equal(found, known)
        np.testing.assert_array_equal(loaded.loo_residuals_, model.loo_residuals_)
    for name in ("dual_coef_", "intercept_", "X_fit_"):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(model, name))


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("fitted", FITTED.values(), ids=FITTED)
def test_a_loaded_model_predicts_the_same(fitted, way):
    model = fitted()
    loaded = way(model)
    named = hasattr(model, "feature_names_in_")
    assert_the_same(loaded, model, pd.DataFrame(QUERIES, columns=list("abc")) if named else QUERIES)
    assert loaded.n_features_in_ == 3
    assert vars(loaded).keys() == vars(model).keys()


@pytest.mark.parametrize("way", WAYS)
def test_a_loaded_model_goes_on_with_new_rows(way):
    model = partly(n_landmarks=120)
    loaded = way(model)
    new, targets = some(30, seed=2)
    assert_the_same(loaded.partial_fit(new, targets), model.partial_fit(new, targets), QUERIES)


@pytest.mark.parametrize("way", WAYS)
def test_a_precomputed_kernel(way):
    matrix = rbf_kernel(X)
    model = LSSVMRegressor("precomputed").fit(matrix, Y)
    loaded = way(model)
    np.testing.assert_array_equal(loaded.predict(matrix), model.predict(matrix))
    assert loaded.X_fit_ is None


def row_kernel(a, b, scale=1.0):
    return np.exp(-scale * np.sum((a - b) ** 2))


@pytest.mark.parametrize("way", WAYS[:-1])
def test_a_callable_kernel(way):
    model = LSSVMRegressor(row_kernel, kernel_params={"scale": 0.5}).fit(X[:30], Y[:30])
    np.testing.assert_array_equal(way(model).predict(QUERIES), model.predict(QUERIES))


def test_skops_asks_whether_a_callable_kernel_is_trusted():
    sio = pytest.importorskip("skops.io", reason="needs skops, of the extra `skops`")
    model = LSSVMRegressor(row_kernel).fit(X[:30], Y[:30])
    saved = sio.dumps(model)
    untrusted = sio.get_untrusted_types(data=saved)
    assert OWN in untrusted
    assert [name for name in untrusted if name.endswith("row_kernel")]
    np.testing.assert_array_equal(
        sio.loads(saved, trusted=untrusted).predict(QUERIES), model.predict(QUERIES)
    )
