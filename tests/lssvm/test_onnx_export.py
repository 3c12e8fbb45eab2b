# SPDX-License-Identifier: BSD-3-Clause
"""The graph of a prediction, run by another program, against the prediction."""

import json
import os
import sys
import types

import numpy as np
import pandas as pd
import pytest
from sklearn.exceptions import NotFittedError
from sklearn.linear_model import Ridge

import sklvalve
from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV, onnx_export, to_onnx
from sklvalve.lssvm.choice import SOLVERS

onnx = pytest.importorskip("onnx", reason="needs onnx, of the extra `onnx`")
ort = pytest.importorskip("onnxruntime", reason="needs onnxruntime, of the extra `test`")

KERNELS = ("rbf", "laplacian", "linear", "poly", "polynomial")
BIASES = ("free", "regularized", "none")
# of the largest target: what double must keep
SAME = 1e-9


def some(n=120, d=3, targets=None, seed=0):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, d))
    y = np.sin(X.sum(axis=1)) + 0.3 * X[:, 0] + 5.0 + 0.05 * rng.normal(size=n)
    if targets:
        y = np.column_stack([(k + 1.0) * y + k for k in range(targets)])
    return X, y


def run(saved, X):
    """What onnxruntime makes of a model, or of the file of one."""
    options = ort.SessionOptions()
    options.intra_op_num_threads = 1
    content = saved if isinstance(saved, str) else saved.SerializeToString()
    session = ort.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    (found,) = session.run(["y"], {"X": X})
    return found


def told(saved):
    return {entry.key: entry.value for entry in saved.metadata_props}


def assert_same(model, X, y):
    saved = to_onnx(model)
    onnx.checker.check_model(saved, full_check=True)
    expected = model.predict(X)
    found = run(saved, np.asarray(X, dtype=np.float64))
    assert found.dtype == np.float64
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=0, atol=SAME * np.abs(y).max())


@pytest.mark.parametrize("targets", [None, 1, 3])
@pytest.mark.parametrize("bias", BIASES)
@pytest.mark.parametrize("kernel", KERNELS)
def test_the_graph_is_the_prediction(kernel, bias, targets):
    X, y = some(targets=targets)
    model = LSSVMRegressor(kernel, bias=bias, degree=2, coef0=0.5, gamma=0.4).fit(X, y)
    assert_same(model, 1.5 * some(50, seed=1)[0], y)


@pytest.mark.parametrize("d", [1, 3])
@pytest.mark.parametrize("gamma", [None, 0.3, [0.3, 0.1, 0.7]])
@pytest.mark.parametrize("kernel", KERNELS)
def test_one_gamma_or_one_for_each_column(kernel, gamma, d):
    X, y = some(d=d)
    gamma = gamma[:d] if isinstance(gamma, list) else gamma
    assert_same(LSSVMRegressor(kernel, gamma=gamma).fit(X, y), 1.5 * some(50, d=d, seed=1)[0], y)


@pytest.mark.parametrize("kernel", ["rbf", "laplacian", "linear"])
@pytest.mark.parametrize("way", [*SOLVERS, "partial_fit", "fit_blocks"])
def test_all_ways_to_fit_and_large_offsets(way, kernel):
    X, y = some(300, targets=2)
    X, y = X + 1e6, y + 1e6
    model = LSSVMRegressor(
        kernel, C=1e4, gamma=[0.2, 0.5, 0.9], n_landmarks=150, random_state=0, max_iter=1000
    )
    if way == "partial_fit":
        model.set_params(n_landmarks=300)
        model.partial_fit(X[:200], y[:200]).partial_fit(X[200:], y[200:])
    elif way == "fit_blocks":
        model.fit_blocks([(X[:200], y[:200]), (X[200:], y[200:])])
    else:
        model.set_params(solver=way).fit(X, y)
    assert_same(model, some(50, seed=1)[0] + 1e6, y)
    # the offset must not hide what varies
    found = run(to_onnx(model), X)
    np.testing.assert_allclose(found, model.predict(X), rtol=0, atol=1e-7 * np.std(y, axis=0).min() + 1e-8)


@pytest.mark.parametrize("bias", BIASES)
@pytest.mark.parametrize("kernel", KERNELS)
def test_offsets_of_the_target(kernel, bias):
    X, y = some()
    model = LSSVMRegressor(kernel, bias=bias, degree=2).fit(X, y + 1e6)
    assert_same(model, some(50, seed=1)[0], y + 1e6)


@pytest.mark.parametrize("bias", ["regularized", "none"])
def test_a_linear_function_far_from_zero_is_rounded_less_than_by_its_kernel(bias):
    X, y = some()
    model = LSSVMRegressor("linear", C=100.0, bias=bias, solver="nystrom", random_state=0).fit(X + 1e6, y)
    exact = X.astype(np.longdouble) + 1e6
    slope = (model.X_fit_.astype(np.longdouble)).T @ model.dual_coef_.astype(np.longdouble)
    exact = exact @ slope + model.intercept_
    off = np.abs(run(to_onnx(model), X + 1e6) - exact).max()
    assert off <= np.abs(model.predict(X + 1e6) - exact).max() + 1e-9


@pytest.mark.parametrize("n", [1, 7, 300])
def test_any_number_of_rows(n):
    X, y = some(targets=2)
    assert_same(LSSVMRegressor(gamma=0.5).fit(X, y), some(n, seed=1)[0], y)
    sizes = to_onnx(LSSVMRegressor().fit(X, y)).graph
    shapes = [
        [size.dim_param or size.dim_value for size in v.type.tensor_type.shape.dim] for v in sizes.input
    ]
    assert shapes == [["N", 3]]


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("kernel", KERNELS)
def test_one_or_two_rows_in_the_fit(kernel, n):
    X, y = np.arange(2.0 * n).reshape(n, 2), np.arange(n) + 4.0
    assert_same(LSSVMRegressor(kernel).fit(X, y), X + 0.5, y)


@pytest.mark.parametrize("kernel", ["rbf", "linear"])
def test_a_model_that_chose_its_parameters(kernel):
    X, y = some()
    frame = pd.DataFrame(X, columns=["P1", "P2", "öffnung"])
    model = LSSVMRegressorCV(kernel).fit(frame, y)
    assert_same(model, frame, y)
    assert json.loads(told(to_onnx(model))["feature_names"]) == ["P1", "P2", "öffnung"]


def test_what_the_file_tells():
    X, y = some()
    known = told(to_onnx(LSSVMRegressor().fit(pd.DataFrame(X, columns=list("abc")), y)))
    assert known == {"sklvalve_version": sklvalve.__version__, "feature_names": '["a", "b", "c"]'}
    assert told(to_onnx(LSSVMRegressor().fit(X, y))) == {"sklvalve_version": sklvalve.__version__}


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("C", [1.0, 1e4])
def test_a_float_graph_tells_its_error(kernel, C):
    X, y = some()
    model = LSSVMRegressor(kernel, C=C, degree=2).fit(X, y)
    saved = to_onnx(model, dtype="float")
    onnx.checker.check_model(saved, full_check=True)
    found = run(saved, X.astype(np.float32))
    assert found.dtype == np.float32
    error, least = json.loads(told(saved)["max_error"]), np.finfo(np.float32).eps * np.abs(y).max()
    assert error > 0.0
    # sums in another order
    assert np.abs(found - model.predict(X)).max() <= 5.0 * error + least


def test_a_float_graph_tells_the_error_of_each_target():
    X, y = some(1500)
    model = LSSVMRegressor(C=10.0).fit(X, np.column_stack([y, 1e6 + y]))
    small, large = json.loads(told(to_onnx(model, dtype="float"))["max_error"])
    assert 0.0 < small < 1e-3
    # a step of a float at 1e6 is 0.06
    assert 0.01 < large < 1.0


def test_rows_on_which_the_error_is_measured_come_in_parts(monkeypatch):
    X, y = some()
    model = LSSVMRegressor(C=10.0).fit(X, y)
    whole = json.loads(told(to_onnx(model, dtype="float"))["max_error"])
    monkeypatch.setattr(onnx_export, "_AT_A_TIME", 7 * len(X))
    parts = json.loads(told(to_onnx(model, dtype="float"))["max_error"])
    assert parts == pytest.approx(whole, rel=0.5)
    monkeypatch.setattr(onnx_export, "_MEASURED", 50)
    assert 0.0 < json.loads(told(to_onnx(model, dtype="float"))["max_error"]) <= 1.5 * whole


def test_what_overflows_in_float_is_an_error():
    X, y = some()
    model = LSSVMRegressor().fit(X, 1e39 * y)
    assert_same(model, X, 1e39 * y)
    with pytest.raises(ValueError, match=r"overflows in float: take dtype='double'"):
        to_onnx(model, dtype="float")


def test_the_file_is_written_whole(tmp_path):
    X, y = some()
    model, file = LSSVMRegressor().fit(X, y), tmp_path / "model.onnx"
    file.write_bytes(b"older")
    saved = to_onnx(model, path=file)
    assert [path.name for path in tmp_path.iterdir()] == ["model.onnx"]
    assert file.read_bytes() == saved.SerializeToString()
    onnx.checker.check_model(str(file), full_check=True)
    np.testing.assert_allclose(run(str(file), X), model.predict(X), rtol=1e-9)
    assert to_onnx(model, path=str(file)) == saved


def test_nothing_is_left_of_a_file_that_fails(tmp_path, monkeypatch):
    X, y = some()
    model, file = LSSVMRegressor().fit(X, y), tmp_path / "model.onnx"
    file.write_bytes(b"older")

    def refused(*_):
        raise PermissionError("in use")

    monkeypatch.setattr(os, "replace", refused)
    with pytest.raises(PermissionError, match="in use"):
        to_onnx(model, path=file)
    assert [path.name for path in tmp_path.iterdir()] == ["model.onnx"]
    assert file.read_bytes() == b"older"


def row_kernel(a, b):
    return float(a @ b)


@pytest.mark.parametrize(("kernel", "word"), [(row_kernel, "a callable"), ("precomputed", "'precomputed'")])
def test_kernels_without_a_graph(kernel, word):
    X, y = some(20)
    model = LSSVMRegressor(kernel).fit(X @ X.T if kernel == "precomputed" else X, y)
    with pytest.raises(ValueError, match=rf"kernel must be rbf, .*, got {word}; fit with"):
        to_onnx(model)


def test_models_that_cannot_be_written(monkeypatch):
    X, y = some()
    with pytest.raises(NotFittedError):
        to_onnx(LSSVMRegressor())
    with pytest.raises(NotFittedError):
        to_onnx(LSSVMRegressorCV())
    with pytest.raises(TypeError, match=r"LSSVMRegressor or LSSVMRegressorCV, got Ridge; of a pipeline"):
        to_onnx(Ridge().fit(X, y))
    model = LSSVMRegressor().fit(X, y)
    with pytest.raises(ValueError, match=r"dtype must be 'double' or 'float', got 'half'"):
        to_onnx(model, dtype="half")
    monkeypatch.setattr(onnx_export, "_LARGEST", 3500)
    with pytest.raises(ValueError, match=r"120 rows span .*; give model\.pruned"):
        to_onnx(model)
    to_onnx(model, dtype="float")
    model.dual_coef_ = types.SimpleNamespace()
    with pytest.raises(ValueError, match="fit it to numpy arrays"):
        to_onnx(model)


def test_without_the_package_the_extra_is_named(monkeypatch):
    model = LSSVMRegressor().fit(*some())
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(ImportError, match=r'needs onnx: pip install "sklvalve\[onnx\]"'):
        to_onnx(model)
