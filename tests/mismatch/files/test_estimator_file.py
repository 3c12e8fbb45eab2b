# SPDX-License-Identifier: BSD-3-Clause
"""Model files of estimators that are no finders: the same numbers, no code, nothing that fails later."""

import copy
import re

import numpy as np
import pandas as pd
import pytest
from sklearn.compose import ColumnTransformer, TransformedTargetRegressor
from sklearn.decomposition import PCA
from sklearn.dummy import DummyRegressor
from sklearn.ensemble import RandomForestRegressor
from sklearn.exceptions import NotFittedError
from sklearn.impute import SimpleImputer
from sklearn.kernel_ridge import KernelRidge
from sklearn.linear_model import LogisticRegression, RidgeCV
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import (
    FunctionTransformer,
    OneHotEncoder,
    PolynomialFeatures,
    SplineTransformer,
    StandardScaler,
)

from sklvalve.datasets import make_valve_recording
from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.mechanism import ValveMechanismTransformer
from sklvalve.mismatch import MissingPhysicsFinder, load_model, save_model
from sklvalve.mismatch.files.estimator_file import content_of_estimator, estimator_of_content
from sklvalve.mismatch.files.model_file import _built_estimator
from sklvalve.recording import InputError, Recording, Valve
from sklvalve.simulation import ValveSimulation

skops_io = pytest.importorskip("skops.io", reason="model files need skops")
pytestmark = pytest.mark.filterwarnings("ignore::sklvalve.mechanism.ValidityWarning")

RNG = np.random.default_rng(0)
X = RNG.uniform([0.2, 5e5, 2e5], [1.0, 6e5, 4e5], (120, 3))
FLOW = 40.0 * X[:, 0] ** 2 * np.sqrt((X[:, 1] - X[:, 2]) / 1e5) / 3600.0
SCALED = (X - X.mean(axis=0)) / X.std(axis=0)
FRAME = pd.DataFrame(X, columns=["opening", "p1", "p2"])
NAMED = {"opening": "opening", "p1": "p1", "p2": "p2"}


def scaled(**parameters):
    return make_pipeline(StandardScaler(), LSSVMRegressor(random_state=0, **parameters))


ESTIMATORS = {
    "scaled LS-SVM": lambda: scaled().fit(X, FLOW),
    **{
        solver: lambda solver=solver: scaled(solver=solver, n_landmarks=40).fit(X, FLOW)
        for solver in ("cholesky", "tiled", "pcg", "nystrom")
    },
    **{
        kernel: lambda kernel=kernel: scaled(kernel=kernel).fit(X, FLOW)
        for kernel in ("linear", "poly", "laplacian")
    },
    "several targets": lambda: scaled(gamma=[0.1, 0.2, 0.3]).fit(X, np.column_stack([FLOW, X[:, 0]])),
    "uncertain": lambda: scaled(uncertainty=True, robust_passes=1).fit(X, FLOW),
    "rows added": lambda: LSSVMRegressor(random_state=np.random.RandomState(3)).partial_fit(X[:, :1], FLOW),
    "float": lambda: LSSVMRegressor().fit(X[:, :1].astype(np.float32), FLOW.astype(np.float32)),
    "precomputed": lambda: LSSVMRegressor("precomputed").fit(np.eye(9), FLOW[:9]),
    "CV": lambda: make_pipeline(StandardScaler(), LSSVMRegressorCV()).fit(X, FLOW),
    "mechanism": lambda: ValveMechanismTransformer(kv_rated=40.0, fl=[[0.0, 0.9], [1.0, 0.8]]).fit(X),
    "features": lambda: ValveMechanismTransformer(features=["dp"]).fit(X),
    "series": lambda: SeriesHybridRegressor(link="log", regressor_columns=[0]).fit(X, FLOW),
    "series of names": lambda: SeriesHybridRegressor(
        ValveMechanismTransformer(**NAMED, fl=0.9), LSSVMRegressor(), regressor_columns=["opening"]
    ).fit(FRAME, FLOW),
    "mixed": lambda: ParallelHybridRegressor(
        SeriesHybridRegressor(regressor_columns=[0]), scaled(C=1.0)
    ).fit(X, FLOW),
    "hybrid in a pipeline": lambda: make_pipeline(SimpleImputer(), SeriesHybridRegressor()).fit(X, FLOW),
    "line": lambda: make_pipeline(PolynomialFeatures(2), PCA(3), RidgeCV()).fit(X, FLOW),
    "mechanism, then LS-SVM": lambda: make_pipeline(
        ValveMechanismTransformer(kv_rated=40.0), StandardScaler(), LSSVMRegressor()
    ).fit(X, FLOW),
    "columns": lambda: make_pipeline(
        ColumnTransformer([("scale", StandardScaler(), [0, 1])], remainder="passthrough"),
        LSSVMRegressor(gamma=1e-12),
    ).fit(X, FLOW),
    "target": lambda: TransformedTargetRegressor(scaled(), transformer=StandardScaler()).fit(X, FLOW),
}  # fmt: skip


def given(model, rows):
    if getattr(model, "kernel", None) == "precomputed":
        rows = np.eye(9)
    elif model.n_features_in_ == 1:
        rows = rows[:, :1]
    elif hasattr(model, "feature_names_in_"):
        rows = pd.DataFrame(rows, columns=model.feature_names_in_)
    return model.predict(rows) if hasattr(model, "predict") else model.transform(rows)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model.skops"


@pytest.mark.parametrize("fitted", ESTIMATORS.values(), ids=ESTIMATORS)
def test_a_loaded_estimator_is_the_one_that_was_saved(fitted, path):
    model = fitted()
    save_model(path, model)
    again = load_model(path)
    assert type(again) is type(model)
    np.testing.assert_array_equal(given(again, X * 1.01), given(model, X * 1.01))
    assert re.sub(" at 0x\\w+", "", repr(again)) == re.sub(" at 0x\\w+", "", repr(model))
    assert vars(again).keys() == vars(model).keys()
    assert list(path.parent.iterdir()) == [path]


def test_a_loaded_estimator_goes_on(path):
    model = LSSVMRegressor(random_state=0).partial_fit(X[:60, :1], FLOW[:60])
    save_model(path, model)
    again = load_model(path).partial_fit(X[60:, :1], FLOW[60:])
    expected = model.partial_fit(X[60:, :1], FLOW[60:]).predict(X[:, :1])
    np.testing.assert_array_equal(again.predict(X[:, :1]), expected)
    save_model(path, scaled(uncertainty=True).fit(X, FLOW))
    assert np.isfinite(load_model(path)[-1].predict(np.zeros((1, 3)), return_std=True)[1]).all()


def test_requests_of_metadata_are_kept(path):
    from sklearn import config_context

    with config_context(enable_metadata_routing=True):
        model = LSSVMRegressor().set_fit_request(sample_weight=True).fit(X[:, :1], FLOW)
        save_model(path, model)
        again = load_model(path)
        assert again.get_metadata_routing().fit.requests == {"sample_weight": True}


@pytest.fixture(scope="module")
def recording():
    made = make_valve_recording(n_samples=600, n_later=0, random_state=0)
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


def test_a_simulation_and_a_hybrid_around_it(path, recording):
    simulation = ValveSimulation().fit(recording)
    save_model(path, simulation)
    again = load_model(path)
    np.testing.assert_array_equal(again.predict(recording), simulation.predict(recording))
    assert again.score(recording) == simulation.score(recording)
    table = recording.to_frame()[["command", "opening", "p1", "p2", "temperature"]]
    hybrid = ParallelHybridRegressor(simulation, make_pipeline(StandardScaler(), LSSVMRegressor(C=1.0)))
    hybrid = hybrid.fit(table, recording["flow"])
    save_model(path, hybrid, rows=table)
    np.testing.assert_array_equal(load_model(path).predict(table), hybrid.predict(table))


def slope(a, b):
    return float(a @ b)


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (
            lambda: LSSVMRegressor(slope).fit(SCALED[:9], FLOW[:9]),
            r"LSSVMRegressor.kernel is a function \(slope\)",
        ),
        (
            lambda: make_pipeline(FunctionTransformer(np.log), LSSVMRegressor()).fit(X, FLOW),
            r"is a function \(log\), and a model file holds no code",
        ),
        (
            lambda: SeriesHybridRegressor(regressor=RandomForestRegressor(3)).fit(X, FLOW),
            r"SeriesHybridRegressor.regressor is a RandomForestRegressor, a kind of which",
        ),
        (
            lambda: ValveMechanismTransformer(fluid="brine", density=lambda t: 1000.0 + 0 * t).fit(X),
            "ValveMechanismTransformer.density is a function",
        ),
        # what can be called is not yet a function
        (lambda: SplineTransformer(n_knots=3).fit(X), r"is a BSpline, and a model file holds none"),
        (
            lambda: OneHotEncoder(dtype=np.float64).fit(X[:9]),
            "OneHotEncoder.dtype is the class float64, and a model file holds none",
        ),
    ],
)
def test_what_a_file_does_not_hold_is_refused_in_one_sentence(model, words, path):
    with pytest.raises(InputError, match=words) as caught:
        save_model(path, model())
    assert "joblib.dump" in str(caught.value)
    assert not path.exists()


def test_no_estimator_and_an_unfitted_one(path):
    with pytest.raises(InputError, match="expected a fitted estimator, got dict"):
        save_model(path, {})
    for model in (LSSVMRegressor(), MissingPhysicsFinder()):
        with pytest.raises(NotFittedError):
            save_model(path, model)
    with pytest.raises(InputError, match="cannot work on the rows given to try it"):
        save_model(path, scaled().fit(X, FLOW), rows=X[:, :2])
    assert not path.exists()


class Sly(LSSVMRegressor):
    def predict(self, X):
        return super().predict(X)


def test_a_class_of_ones_own_is_refused(path):
    with pytest.raises(InputError, match="Sly is a Sly, a kind of which model files hold none"):
        save_model(path, Sly().fit(X, FLOW))


def changed(path, model, *change):
    """A file whose content was changed: keys to the place, and what stands there now."""
    save_model(path, model, rows=SCALED[:4])
    content = copy.deepcopy(skops_io.load(path, trusted=[]))
    *inner, last, value = change
    node = content
    for key in inner:
        node = node[key]
    if value is None:
        del node[last]
    else:
        node[last] = value
    skops_io.dump(content, path)


STATE = ("estimator", "state")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("estimator", "class", "os.system"), "a class that is none of a model file's"),
        (("estimator", "class", "sklearn.svm.SVR"), "a class that is none"),
        (("estimator", "class", "sklearn.preprocessing.os"), "a class that is none"),
        (
            ("estimator", "class", "ParallelHybridRegressor"),
            r"parameters of Parallel\w+ are missing",
        ),
        (("estimator", "class", 3), "a class that is none"),
        ((*STATE, "C", None), "parameters of LSSVMRegressor are missing"),
        ((*STATE, "C", -1.0), ""),
        ((*STATE, "kernel", "no kernel"), ""),
        ((*STATE, "n_jobs", 10**9), "threads is out of range"),
        ((*STATE, "predict", "evil"), "no such attribute"),
        ((*STATE, "__class__", "evil"), "no such attribute"),
        ((*STATE, "_values", 1.0), "has no such attribute"),
        ((*STATE, "n_features_in_", -3), "number of columns is none"),
        ((*STATE, "n_features_in_", 4), ""),
        ((*STATE, "dual_coef_", np.zeros(5)), ""),
        ((*STATE, "dual_coef_", np.full(120, np.nan)), "dual_coef_ of the LS-SVM holds no finite numbers"),
        ((*STATE, "dual_coef_", "text"), ""),
        ((*STATE, "dual_coef_", np.zeros(120)), "it gives other numbers here"),
        ((*STATE, "offset_", np.zeros(2)), ""),
        ((*STATE, "_kernel_", None), ""),
        (("trial", "rows", "none"), "its trial is none"),
        (("trial", "result", np.zeros(3)), "it gives other numbers"),
        (("estimator", None), ""),
        (("estimator", {"sklvalve": "text"}), "no part of a model"),
        (("estimator", [1.0, 2.0]), "it holds no estimator"),
    ],
)
def test_a_tampered_file_is_refused_when_it_is_read(path, change, words):
    changed(path, LSSVMRegressor().fit(SCALED, FLOW), *change)
    with pytest.raises(InputError, match=rf"this is no model file .*{words}") as caught:
        load_model(path)
    assert str(caught.value).isprintable()


def test_a_nesting_without_end_is_refused(path):
    save_model(path, LSSVMRegressor().fit(X, FLOW))
    content = skops_io.load(path, trusted=[])
    nested = 1.0
    for _ in range(60):
        nested = [nested]
    content["estimator"]["state"]["nested_"] = nested
    skops_io.dump(content, path)
    with pytest.raises(InputError, match="nested too deep"):
        load_model(path)


def test_predict_of_the_command_line_says_what_it_needs(path, tmp_path, monkeypatch, capsys):
    from sklvalve.cli import main

    monkeypatch.chdir(tmp_path)
    save_model(path, LSSVMRegressor().fit(X, FLOW))
    assert main(["predict", "later.csv", "--model", "model.skops", "--out", "predictions.csv"]) == 2
    assert "model.skops: this holds a LSSVMRegressor and no diagnosis" in capsys.readouterr().err


ODD = [
    None, True, -1, 10**30, 1e308, float("nan"), "text", [], {}, (), np.zeros(0), np.zeros(3),
    np.full((2, 2), np.nan),
    {"sklvalve": "dict", "items": []}, {"sklvalve": "slice", "ends": [0, 0, 0]},
    {"sklvalve": "random state", "state": []}, {"sklvalve": "dtype", "name": "O"},
    {"sklvalve": "texts", "values": ["a"], "shape": [1]},
    {"sklvalve": "estimator", "class": "LSSVMRegressor", "state": {}},
]  # fmt: skip


def _places(node, path=()):
    pairs = (
        node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list | tuple) else ()
    )
    for key, inner in pairs:
        yield (*path, key)
        yield from _places(inner, (*path, key))


def _with(node, path, value):
    if not path:
        return value
    key, *rest = path
    inner = _with(node[key], rest, value)
    if isinstance(node, dict):
        return node | {key: inner}
    return type(node)(inner if k == key else each for k, each in enumerate(node))


@pytest.mark.parametrize(
    "name", ["scaled LS-SVM", "uncertain", "mechanism", "series of names", "mixed", "columns"]
)
def test_a_file_with_any_part_exchanged_is_refused_or_predicts(name):
    model = ESTIMATORS[name]()
    content = content_of_estimator(model)
    places = [path for path in _places(content) if path[0] != "format"]
    rng = np.random.default_rng(0)
    refused = 0
    for _ in range(120):
        path = places[rng.integers(len(places))]
        changed = _with(content, path, copy.deepcopy(ODD[rng.integers(len(ODD))]))
        try:
            loaded = _built_estimator("model.skops", changed, {})
        except InputError:
            refused += 1
            continue
        with np.errstate(all="ignore"):
            given(loaded, X * 1.01)
    assert refused > 30


@pytest.mark.parametrize(
    ("name", "value"),
    [("_kernel_", None), ("_kernel_", -1), ("dual_coef_", np.zeros(3)), ("intercept_", None)],
)
def test_a_file_does_not_decide_whether_it_is_tried(name, value):
    content = content_of_estimator(LSSVMRegressor().fit(SCALED, FLOW))
    content["estimator"]["state"][name], content["trial"] = value, None
    with pytest.raises(ValueError):
        estimator_of_content(content, {})


def test_a_pipeline_without_steps_is_refused():
    content = content_of_estimator(scaled().fit(X, FLOW))
    content["estimator"]["state"]["steps"], content["trial"] = [], None
    with pytest.raises(ValueError, match="no steps"):
        estimator_of_content(content, {})


def test_what_no_file_takes_back_is_not_written(tmp_path):
    model = LSSVMRegressor().fit(SCALED, FLOW)
    model.note = 1.0
    with pytest.raises(InputError, match="holds 'note', which no model file takes back"):
        save_model(tmp_path / "model.skops", model)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("rows", [[["a", "b", "c"]], [[1.0, 2.0], [3.0]]])
def test_rows_that_are_none_are_told(tmp_path, rows):
    with pytest.raises(InputError, match="cannot work on the rows given to try it"):
        save_model(tmp_path / "model.skops", LSSVMRegressor().fit(SCALED, FLOW), rows=rows)


@pytest.mark.parametrize(
    "model",
    [KernelRidge(kernel="rbf"), DummyRegressor(), make_pipeline(StandardScaler(), LogisticRegression())],
    ids=lambda model: type(model).__name__,
)
def test_every_part_in_the_list_is_taken(tmp_path, model):
    labels = np.where(np.median(FLOW) < FLOW, "wide", "shut")
    model.fit(SCALED, labels if hasattr(model, "predict_proba") else FLOW)
    save_model(tmp_path / "model.skops", model, rows=SCALED)
    again = load_model(tmp_path / "model.skops")
    if hasattr(model, "predict_proba"):
        assert list(again.predict(SCALED)) == list(model.predict(SCALED))
    else:
        np.testing.assert_allclose(again.predict(SCALED), model.predict(SCALED), rtol=1e-12)
