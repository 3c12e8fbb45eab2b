# SPDX-License-Identifier: BSD-3-Clause
"""Fits and predictions on arrays of other libraries; run by test_device.py in a process of its own.

scipy has to be told of such arrays before it is imported, and then treats all arrays otherwise.
"""

import sys
import warnings
from contextlib import suppress
from dataclasses import dataclass
from types import ModuleType

import numpy as np
import pytest
from sklearn import config_context

from sklvalve.lssvm import LSSVMRegressor, device


@dataclass(frozen=True)
class Place:
    """A library of arrays, and where its arrays lie."""

    library: ModuleType
    options: dict[str, str]

    def asarray(self, values):
        return self.library.asarray(values, **self.options)


def places():
    """Libraries that are installed, by name; torch on a GPU too, where there is one."""
    for name, options in (
        ("array_api_strict", {}),
        ("torch", {}),
        ("torch", {"device": "cuda"}),
        ("cupy", {}),
    ):
        place, reason = None, f"{name} is not installed"
        with suppress(ImportError):
            library = __import__(name)
            place, reason = Place(library, options), "there is no GPU"
            if options and not library.cuda.is_available():
                place = None
        marks = () if place else pytest.mark.skip(reason=reason)
        yield pytest.param(place, id=" on ".join([name, *options.values()]), marks=marks)


def some(n=300, d=3, targets=2):
    rng = np.random.default_rng(0)
    X = rng.normal(size=(n, d)) + 50.0
    y = np.column_stack([np.sin(X.sum(axis=1)), 3.0 * X[:, 0]])[:, :targets]
    return X, y + 0.01 * rng.normal(size=y.shape), rng.integers(0, 3, n).astype(float)


def back(array):
    return np.asarray(array.tolist() if hasattr(array, "tolist") else array)


@pytest.fixture(autouse=True)
def dispatched():
    with config_context(array_api_dispatch=True):
        yield


@pytest.mark.parametrize("bias", ["free", "regularized", "none"])
@pytest.mark.parametrize("kernel", ["rbf", "laplacian", "linear", "poly"])
@pytest.mark.parametrize("xp", places())
def test_what_numpy_gives(xp, kernel, bias):
    X, y, weight = some()
    if kernel in ("linear", "poly"):
        X = X - 50.0
    options = {"kernel": kernel, "bias": bias, "C": 50.0}
    known = LSSVMRegressor(**options).fit(X, y, weight)
    arrays = [xp.asarray(column) for column in (X, y, weight)]
    found = LSSVMRegressor(**options).fit(*arrays)
    told = found.predict(arrays[0] + 0.1)
    assert type(told) is type(arrays[0])
    assert found.residual_ <= 1e-6
    np.testing.assert_allclose(back(told), known.predict(X + 0.1), rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(back(found.dual_coef_), known.dual_coef_, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("xp", places())
def test_one_target_a_gamma_for_each_column_and_a_given_matrix(xp):
    X, y, weight = some(targets=1)
    gamma = [0.5, 0.1, 0.01]
    known = LSSVMRegressor(gamma=gamma).fit(X, y[:, 0])
    found = LSSVMRegressor(gamma=gamma).fit(xp.asarray(X), xp.asarray(y[:, 0]))
    assert found.dual_coef_.ndim == 1
    np.testing.assert_allclose(back(found.predict(xp.asarray(X))), known.predict(X), atol=1e-8)
    matrix = np.exp(-0.1 * ((X[:, None] - X) ** 2).sum(axis=2))
    known = LSSVMRegressor("precomputed").fit(matrix, y[:, 0], weight)
    there = xp.asarray(matrix)
    found = LSSVMRegressor("precomputed").fit(there, *map(xp.asarray, (y[:, 0], weight)))
    assert (back(there) == matrix).all()
    np.testing.assert_allclose(back(found.predict(xp.asarray(matrix))), known.predict(matrix), atol=1e-8)
    assert (back(found.dual_coef_)[weight == 0.0] == 0.0).all()


@pytest.mark.parametrize("xp", places())
def test_what_cannot_be_done_there_is_told(xp):
    X, y, weight = map(xp.asarray, some(40, targets=1))
    callable_kernel = {"kernel": lambda a, b: a @ b}
    for options in ({"solver": "pcg"}, {"uncertainty": True}, {"robust_passes": 1}, callable_kernel):
        with pytest.raises(ValueError, match=f"{next(iter(options))}=.* needs rows in numpy arrays"):
            LSSVMRegressor(**options).fit(X, y)
    with pytest.raises(ValueError, match=r"zero"):
        LSSVMRegressor().fit(X, y, 0.0 * weight)
    with pytest.raises(ValueError, match=r"[Nn]egative"):
        LSSVMRegressor().fit(X, y, weight - 1.5)
    with pytest.raises(ValueError, match=r"NaN|nan|infinity"):
        LSSVMRegressor().fit(X * xp.asarray(float("nan")), y)
    with pytest.raises(ValueError, match="return_std needs rows in numpy arrays"):
        LSSVMRegressor().fit(X, y).predict(X, return_std=True)


@pytest.mark.parametrize("xp", places())
def test_equations_that_are_not_met_are_told(xp):
    X, y, _ = some(60, targets=1)
    X, y = np.repeat(X, 2, axis=0), np.random.default_rng(1).normal(size=(120, 1))
    xs, ys = xp.asarray(X), xp.asarray(y)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            residual = LSSVMRegressor(C=1e16).fit(xs, ys).residual_
        except ValueError as error:
            told, residual = [error], np.inf
    if residual > 1e-6:
        assert any("not positive definite" in str(t) or "met only to" in str(t) for t in map(_text, told))


@pytest.mark.parametrize("xp", places())
def test_a_matrix_that_is_no_kernel_is_told(xp):
    X, y, _ = some(60, targets=1)
    matrix = X @ X.T - 9000.0 * np.eye(60)
    with pytest.raises(ValueError, match="not positive definite"):
        LSSVMRegressor("precomputed").fit(xp.asarray(matrix), xp.asarray(y))


@pytest.mark.skipif("torch" not in sys.modules, reason="torch is not installed")
def test_too_little_memory_is_told_with_what_is_needed():
    import torch

    if not torch.cuda.is_available():
        pytest.skip("there is no GPU")
    X = torch.zeros((400_000, 2), device="cuda", dtype=torch.float64)
    X[:, 0] = torch.arange(400_000)
    with pytest.raises(MemoryError, match=r"400000 rows needs some 2.38e\+03 GiB"):
        LSSVMRegressor().fit(X, X[:, 0])


def test_other_errors_of_a_library_are_left_as_they_are():
    with pytest.raises(RuntimeError, match="the device is gone"), device._memory_in_words(10, 8):
        raise RuntimeError("the device is gone")


def _text(told):
    return told if isinstance(told, Exception) else told.message
