# SPDX-License-Identifier: BSD-3-Clause
import io
import warnings

import joblib
import numpy as np
import pytest
from sklearn.dummy import DummyRegressor
from sklearn.linear_model import Ridge
from sklearn.model_selection import GridSearchCV, KFold
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import FunctionTransformer, StandardScaler
from sklearn.utils.validation import _get_feature_names

from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValidityWarning, ValveMechanismTransformer, liquid_flow, liquid_outlet_pressure
from sklvalve.metrics import mape, neg_mape_scorer
from tests.hybrid.mechanisms import Gain, Orifice, Plain, SensitiveGain


def trim_model(**kwargs):
    regressor = LSSVMRegressor(gamma=5.0, C=1e3)
    return SeriesHybridRegressor(Orifice(), regressor, link="log", regressor_columns=["x"], **kwargs)


def test_the_parameter_of_the_mechanism_is_learnt(recording):
    X, y, true = recording
    model = trim_model().fit(X, y)
    np.testing.assert_allclose(model.predict_parameter(X), 50 ** (X["x"] - 1), rtol=0.1)
    assert mape(true, model.predict(X)) < 2.0
    np.testing.assert_array_equal(model.predict(X), model.mechanism_.forward(X, model.predict_parameter(X)))


def test_the_series_form_extrapolates_over_what_physics_knows(recording):
    X, y, true = recording
    seen = (X["p1"] - X["p2"] < 1.5e5).to_numpy()
    black_box = make_pipeline(StandardScaler(), LSSVMRegressor(C=1e4)).fit(X[seen], y[seen])
    hybrid = trim_model().fit(X[seen], y[seen])
    assert mape(true[~seen], hybrid.predict(X[~seen])) < 2.0 < mape(true[~seen], black_box.predict(X[~seen]))


def test_rows_that_cannot_be_inverted_are_left_out_and_counted(recording):
    X, y, _ = recording
    X = X.copy()
    X.loc[:9, "p1"] = X.loc[:9, "p2"]
    with pytest.warns(ValidityWarning, match=r"in 290 of 300 rows; left out: 10"):
        model = trim_model().fit(X, np.maximum(y, 0.1))
    assert len(model.regressor_.X_fit_) == 290
    alone = trim_model().fit(X[10:], np.maximum(y[10:], 0.1))
    np.testing.assert_allclose(model.predict(X[10:]), alone.predict(X[10:]), rtol=1e-9)


def test_log_link_leaves_out_what_is_negative_and_predicts_positive(recording):
    X, y, _ = recording
    y = y.copy()
    y[:3] = [-1.0, -2.0, -3.0]
    with pytest.warns(ValidityWarning, match="left out: 3"):
        model = trim_model().fit(X, y)
    assert (model.predict_parameter(X) > 0).all()


def shut(recording, rows):
    """The recording with a shut valve, through which nothing flows, in its first rows."""
    X, y, _ = recording
    X, y = X.copy(), np.maximum(y, 0.1)
    X.loc[: rows - 1, "x"], y[:rows] = 0.0, 0.0
    return X, y


@pytest.mark.parametrize("sensitivity_weights", [False, True])
def test_log_link_takes_a_shut_valve_at_its_floor_and_warns(recording, sensitivity_weights):
    X, y = shut(recording, 40)
    model = trim_model().set_params(sensitivity_weights=sensitivity_weights)
    with pytest.warns(ValidityWarning, match=r"40 of 300 rows is under .* as of a shut valve") as caught:
        model.fit(X, y)
    assert caught[0].filename == __file__
    largest = np.max(y[40:] / np.sqrt(X["p1"] - X["p2"])[40:])
    assert model.floor_ == pytest.approx(1e-3 * largest, rel=1e-12)
    assert len(model.regressor_.X_fit_) == 300
    predicted = model.predict_parameter(X)
    assert (predicted > 0.0).all()
    if not sensitivity_weights:
        np.testing.assert_allclose(predicted[:40], model.floor_, rtol=0.2)


def test_the_floor_can_be_given_and_is_nothing_to_the_identity(recording):
    X, y = shut(recording, 5)
    with pytest.warns(ValidityWarning, match="5 of 300 rows is under 0.001"):
        assert trim_model().set_params(floor=1e-3).fit(X, y).floor_ == 1e-3
    assert trim_model().set_params(link="identity").fit(X, y).floor_ is None
    with pytest.raises(ValueError, match="'floor' parameter"):
        trim_model().set_params(floor=0.0).fit(X, y)
    with pytest.raises(ValueError, match="in none of the 300 rows"):
        trim_model().fit(X, 0.0 * y)


@pytest.mark.parametrize("kind", [SeriesHybridRegressor, ParallelHybridRegressor])
def test_a_search_over_a_model_that_is_none_is_refused_in_one_sentence(kind):
    X, y = np.random.default_rng(0).uniform([0.2, 5e5, 2e5], [1.0, 6e5, 4e5], (30, 3)), np.ones(30)
    for key, example in (
        ("regressor__C", r"LSSVMRegressor\(\)"),
        ("mechanism__fl", "ValveMechanismTransformer"),
    ):
        sentence = f"{key} cannot be set, because {key[:9]} is None.*{example}"
        with pytest.raises(ValueError, match=sentence):
            GridSearchCV(kind(), {key: [0.8, 0.9]}).fit(X, y)
    searched = kind().set_params(regressor=LSSVMRegressor(), regressor__C=3.0)
    assert searched.regressor.C == 3.0
    with pytest.raises(ValueError, match="Invalid parameter 'no'"):
        kind().set_params(no=1)


def test_no_usable_row_is_one_clear_sentence(recording):
    X, y, _ = recording
    with pytest.raises(ValueError, match=r"in none of the 300 rows: check units and columns"):
        trim_model().fit(X.assign(p1=X["p2"]), y)


def test_weights_by_sensitivity_beat_none_near_zero_pressure_drop(recording):
    X, y, true = recording
    X = X.copy()
    X.loc[::2, "p1"] = X.loc[::2, "p2"] + 1.0
    true = 50 ** (X["x"] - 1) * np.sqrt(X["p1"] - X["p2"])
    y = np.asarray(true) + 2.0 * np.random.default_rng(1).normal(size=300)
    error = {}
    for weights in (True, False):
        model = SeriesHybridRegressor(
            Orifice(), LSSVMRegressor(gamma=5.0), regressor_columns=["x"], sensitivity_weights=weights
        )
        far = X["p1"] - X["p2"] > 1e4
        error[weights] = mape(true[far], model.fit(X, y).predict(X[far]))
    assert error[True] < 0.5 * error[False]


@pytest.mark.parametrize(
    "regressor", [None, LSSVMRegressor(), make_pipeline(StandardScaler(), LSSVMRegressor()), Ridge()]
)
@pytest.mark.parametrize("link", ["identity", "log"])
def test_weight_k_is_the_row_k_times_together_with_sensitivity(regressor, link):
    rng = np.random.default_rng(0)
    X = rng.normal(size=(60, 2))
    y = np.exp(np.sin(X[:, 1])) + 0.05 * rng.normal(size=60)
    count = rng.integers(0, 3, 60)
    model = SeriesHybridRegressor(SensitiveGain(), regressor, link=link)
    weighted = model.fit(X, y, sample_weight=count).predict(X)
    repeated = model.fit(np.repeat(X, count, axis=0), np.repeat(y, count)).predict(X)
    np.testing.assert_allclose(weighted, repeated, rtol=1e-8)
    assert not np.allclose(weighted, model.fit(X, y).predict(X), rtol=1e-4)


def test_a_regressor_without_weights_refuses_given_ones_but_not_sensitivity():
    X, y = np.ones((20, 1)) * np.arange(20)[:, None], np.arange(20.0)
    model = SeriesHybridRegressor(SensitiveGain(), KNeighborsRegressor())
    with pytest.raises(TypeError, match="KNeighborsRegressor takes none"):
        model.fit(X, y, sample_weight=np.ones(20))
    assert np.isfinite(model.fit(X, y).predict(X)).all()


def test_weights_that_leave_nothing_are_refused():
    X, y = np.arange(20.0)[:, None], np.arange(20.0) - 0.5
    model = SeriesHybridRegressor(Gain(), Ridge(), link="log")
    weight = np.zeros(20)
    with pytest.raises(ValueError, match="zero"):
        model.fit(X, y, sample_weight=weight)
    weight[0] = 1.0
    with (
        pytest.warns(ValidityWarning, match="19 of 20"),
        pytest.raises(ValueError, match="leave a weight above zero"),
    ):
        model.set_params(mechanism=SensitiveGain()).fit(X, y, sample_weight=weight)


def test_a_plain_object_is_a_mechanism_and_is_not_touched():
    X, plain = np.arange(10.0)[:, None], Plain()
    model = SeriesHybridRegressor(plain, DummyRegressor()).fit(X, X[:, 0] + 3)
    np.testing.assert_allclose(model.predict([[100.0]]), [103.0])
    assert model.mechanism_ is not plain
    assert plain.__dict__ == {}


def test_inner_models_are_cloned(recording):
    X, y, _ = recording
    mechanism, regressor = Orifice(), LSSVMRegressor()
    SeriesHybridRegressor(mechanism, regressor, regressor_columns=["x"]).fit(X, y)
    assert not hasattr(regressor, "dual_coef_")


def test_columns_of_the_regressor_by_name_and_position(recording):
    X, y, _ = recording
    by_name = SeriesHybridRegressor(Orifice(), LSSVMRegressor(), regressor_columns=["x"]).fit(X, y)
    by_position = SeriesHybridRegressor(Orifice(), LSSVMRegressor(), regressor_columns=[1]).fit(X, y)
    np.testing.assert_array_equal(by_name.predict(X), by_position.predict(X))
    assert list(by_name.regressor_.feature_names_in_) == ["x"]
    with pytest.raises(ValueError, match=r"holds 'z', but the columns are p1, x, p2"):
        SeriesHybridRegressor(Orifice(), regressor_columns=["z"]).fit(X, y)
    with pytest.raises(ValueError, match=r"holds 7, but X has 3 columns"):
        SeriesHybridRegressor(Orifice(), regressor_columns=[7]).fit(X, y)
    with pytest.raises(ValueError, match=r"holds 'x', but the columns have no names"):
        SeriesHybridRegressor(Gain(), regressor_columns=["x"]).fit(X.to_numpy(), y)


class Short(Plain):
    def invert(self, X, y):
        return y[:3]


def test_a_mechanism_that_gives_the_wrong_shape_is_named():
    X = np.arange(10.0)[:, None]
    with pytest.raises(ValueError, match=r"invert of the mechanism must give one number for each of 10 rows"):
        SeriesHybridRegressor(Short(), Ridge()).fit(X, X[:, 0])
    with pytest.raises(ValueError, match="The 'mechanism' parameter"):
        SeriesHybridRegressor(Ridge()).fit(X, X[:, 0])


def valve_data(seed=0, n=200):
    rng = np.random.default_rng(seed)
    opening, p1, p2 = rng.uniform([0.3, 5e5, 1e5], [1.0, 6e5, 4e5], (n, 3)).T
    return opening, p1, p2, 40 * 50 ** (opening - 1)


def test_the_valve_gives_flow():
    opening, p1, p2, kv = valve_data()
    flow = liquid_flow(kv, p1, p2, 998.2)
    X = np.column_stack([opening, p1, p2])
    model = SeriesHybridRegressor(link="log", regressor_columns=[0]).fit(X[:150], flow[:150])
    assert mape(flow[150:], model.predict(X[150:])) < 1.0


def test_the_valve_gives_outlet_pressure():
    opening, p1, p2, kv = valve_data()
    flow = liquid_flow(kv, p1, p2, 998.2)
    X = np.column_stack([opening, p1, flow])
    mechanism = ValveMechanismTransformer(p2=None, flow=2, features=["density"], output="outlet_pressure")
    model = SeriesHybridRegressor(mechanism, link="log", regressor_columns=[0]).fit(X[:150], p2[:150])
    np.testing.assert_allclose(
        model.predict(X[150:]),
        liquid_outlet_pressure(flow[150:], model.predict_parameter(X[150:]), p1[150:], model_density()),
        rtol=1e-9,
    )
    assert mape(p2[150:], model.predict(X[150:])) < 5.0


def model_density():
    return ValveMechanismTransformer(p1=0, p2=0, features=["density"]).fit_transform(np.ones((1, 1)))[0, 0]


def test_grid_search_reaches_both_models_in_a_pipeline_of_a_data_frame(recording):
    X, y, true = recording
    X = X.assign(noise=X["p1"].to_numpy()[::-1])
    pipeline = Pipeline(
        [("keep", FunctionTransformer().set_output(transform="pandas")), ("hybrid", trim_model())]
    )
    grid = {"hybrid__mechanism__p1": ["noise", "p1"], "hybrid__regressor__C": [1e-3, 1e3]}
    search = GridSearchCV(pipeline, grid, scoring=neg_mape_scorer, cv=KFold(3), error_score="raise")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        search.fit(X, y)
    assert search.best_params_ == {"hybrid__mechanism__p1": "p1", "hybrid__regressor__C": 1e3}
    assert mape(true, search.predict(X)) < 2.0
    assert list(search.best_estimator_["hybrid"].feature_names_in_) == ["p1", "x", "p2", "noise"]


def test_grid_search_chooses_the_column_of_the_valves_opening():
    pd = pytest.importorskip("pandas")
    opening, p1, p2, kv = valve_data()
    X = pd.DataFrame({"p1": p1, "p2": p2, "x": opening, "wrong": opening[::-1]})
    y = liquid_flow(kv, p1, p2, 998.2)
    mechanism = ValveMechanismTransformer(
        opening="wrong", p1="p1", p2="p2", kv_rated=40.0, characteristic="equal_percentage", rangeability=50.0
    )
    model = ParallelHybridRegressor(mechanism, make_pipeline(StandardScaler(), LSSVMRegressor()))
    grid = {"mechanism__opening": ["wrong", "x"], "regressor__lssvmregressor__C": [0.1, 10.0]}
    search = GridSearchCV(model, grid, scoring=neg_mape_scorer, cv=3, error_score="raise").fit(X, y)
    assert search.best_params_["mechanism__opening"] == "x"
    assert search.best_score_ > -1.0


def test_saved_and_loaded_hybrids_predict_the_same():
    sio = pytest.importorskip("skops.io")
    opening, p1, p2, kv = valve_data()
    X, y = np.column_stack([opening, p1, p2]), liquid_flow(kv, p1, p2, 998.2)
    inner = SeriesHybridRegressor(link="log", regressor_columns=[0])
    for model in (inner, ParallelHybridRegressor(inner, Ridge())):
        expected = model.fit(X, y).predict(X)
        file = io.BytesIO()
        joblib.dump(model, file)
        file.seek(0)
        np.testing.assert_array_equal(joblib.load(file).predict(X), expected)
        saved = sio.dumps(model)
        untrusted = sio.get_untrusted_types(data=saved)
        assert all(name.startswith("sklvalve.") for name in untrusted)
        np.testing.assert_array_equal(sio.loads(saved, trusted=untrusted).predict(X), expected)


def test_polars_frames_work():
    pl = pytest.importorskip("polars")
    opening, p1, p2, kv = valve_data(n=60)
    X = pl.DataFrame({"x": opening, "p1": p1, "p2": p2})
    if _get_feature_names(X) is None:
        pytest.skip("this scikit-learn does not read the column names of this polars")
    y = liquid_flow(kv, p1, p2, 998.2)
    mechanism = ValveMechanismTransformer(opening="x", p1="p1", p2="p2")
    model = SeriesHybridRegressor(mechanism, link="log", regressor_columns=["x"]).fit(X, y)
    np.testing.assert_array_equal(model.predict(X), model.fit(X.to_pandas(), y).predict(X.to_pandas()))
    assert mape(y, model.predict(X)) < 3.0
