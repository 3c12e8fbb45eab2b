# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from sklearn import config_context
from sklearn.dummy import DummyRegressor
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.hybrid.parallel import _weighted_median
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValidityWarning, ValveMechanismTransformer, liquid_flow
from sklvalve.metrics import mape, rmse
from tests.hybrid.mechanisms import Gain, Orifice, Plain


def test_the_prediction_is_physics_plus_residual():
    rng = np.random.default_rng(0)
    X = rng.uniform(-3, 3, (200, 1))
    y = 2 * X[:, 0] + np.sin(3 * X[:, 0])
    model = ParallelHybridRegressor(LinearRegression(), LSSVMRegressor(gamma=2.0)).fit(X, y)
    expected = model.mechanism_.predict(X) + model.regressor_.predict(X)
    np.testing.assert_array_equal(model.predict(X), expected)
    assert rmse(y, model.predict(X)) < 0.02 < rmse(y, model.mechanism_.predict(X))
    assert model.parameter_ is None


def test_a_residual_that_is_nothing_leaves_physics_alone(recording):
    X, _, _ = recording
    y = Orifice().forward(X, 2.0)
    model = ParallelHybridRegressor(Orifice(), Ridge()).fit(X, y)
    np.testing.assert_allclose(model.predict(X), y, rtol=1e-9)


def test_the_parameter_is_the_given_one_or_the_median_of_the_inverse(recording):
    X, _, _ = recording
    y = Orifice().forward(X, 2.0)
    y[:20] += 1e6
    assert ParallelHybridRegressor(Orifice(), Ridge()).fit(X, y).parameter_ == pytest.approx(2.0)
    given = ParallelHybridRegressor(Orifice(), DummyRegressor(), parameter=1.5).fit(X, y)
    assert given.parameter_ == 1.5
    np.testing.assert_allclose(
        given.predict(X), Orifice().forward(X, 1.5) + given.regressor_.predict(X), rtol=1e-12
    )
    X = np.arange(9.0)[:, None]
    assert ParallelHybridRegressor(Plain(), Ridge()).fit(X, X[:, 0] + 4).parameter_ == 4.0


def test_weighted_median_counts_rows():
    values = np.array([5.0, 1.0, 3.0, 9.0])
    count = np.array([1, 2, 4, 2])
    assert _weighted_median(values, count) == np.median(np.repeat(values, count)) == 3.0
    assert _weighted_median(values, np.array([1e-9, 1e-9, 1e-9, 1.0])) == 9.0


def test_the_valve_with_its_data_sheet_and_a_trim_that_differs():
    rng = np.random.default_rng(0)
    opening, p1, p2 = rng.uniform([0.2, 5e5, 2e5], [1.0, 6e5, 4e5], (300, 3)).T
    X = np.column_stack([opening, p1, p2])
    flow = liquid_flow(40 * opening**1.3, p1, p2, 998.2)
    sheet = ValveMechanismTransformer(kv_rated=40.0, characteristic="linear")
    model = ParallelHybridRegressor(sheet, make_pipeline(StandardScaler(), LSSVMRegressor(C=1e4)))
    model.fit(X[:200], flow[:200])
    assert (
        mape(flow[200:], model.predict(X[200:])) < 0.5 < 5 < mape(flow[200:], sheet.fit(X).predict(X[200:]))
    )


def test_rows_without_a_prediction_of_physics_are_left_out(recording):
    X, y, _ = recording

    class Holes(Gain):
        def forward(self, X, parameter):
            return np.where(np.arange(len(X)) < 5, np.nan, 1.0)

    model = ParallelHybridRegressor(Holes("x"), LSSVMRegressor(), parameter=1.0, regressor_columns=["x"])
    with pytest.warns(ValidityWarning, match="in 295 of 300 rows; left out: 5"):
        model.fit(X, y)
    assert len(model.regressor_.X_fit_) == 295
    assert np.isnan(model.predict(X)).sum() == 5


def test_series_inside_parallel_is_the_mixed_form(recording):
    X, y, true = recording
    leak = 30.0 * X["x"].to_numpy() ** 2
    series = SeriesHybridRegressor(Orifice(), LSSVMRegressor("linear"), link="log", regressor_columns=["x"])
    regressor = make_pipeline(StandardScaler(), LSSVMRegressor())
    mixed = ParallelHybridRegressor(series, regressor).fit(X, y + leak)
    assert rmse(true + leak, mixed.predict(X)) < 0.5 * rmse(true + leak, mixed.mechanism_.predict(X))
    assert list(mixed.mechanism_.mechanism_.get_params()) == ["p1", "p2"]


def test_parallel_inside_series_as_the_regressor_is_the_mixed_form(recording):
    X, y, true = recording
    parameter = ParallelHybridRegressor(LinearRegression(), LSSVMRegressor(gamma=5.0))
    mixed = SeriesHybridRegressor(Orifice(), parameter, regressor_columns=["x"]).fit(X, y)
    alone = SeriesHybridRegressor(Orifice(), LinearRegression(), regressor_columns=["x"]).fit(X, y)
    assert rmse(true, mixed.predict(X)) < 0.2 * rmse(true, alone.predict(X))


def test_parallel_inside_series_as_the_mechanism_is_the_mixed_form(recording):
    X, y, true = recording
    inner = ParallelHybridRegressor(Orifice(), Ridge(), regressor_columns=["x"])
    mixed = SeriesHybridRegressor(inner, LSSVMRegressor(gamma=5.0), regressor_columns=["x"]).fit(X, y)
    assert rmse(true, mixed.predict(X)) < 0.7 * rmse(true, mixed.mechanism_.predict(X))
    fitted = mixed.mechanism_
    np.testing.assert_allclose(fitted.forward(X, fitted.invert(X, y)), y, rtol=1e-9, atol=1e-9)
    slope = fitted.sensitivity(X, np.ones(300))
    np.testing.assert_allclose(
        slope, fitted.forward(X, np.full(300, 2.0)) - fitted.forward(X, np.ones(300)), rtol=1e-9, atol=1e-9
    )


def test_parallel_is_a_mechanism_only_where_its_own_is_one():
    assert hasattr(ParallelHybridRegressor(Orifice()), "invert")
    assert not hasattr(ParallelHybridRegressor(Ridge()), "forward")
    assert not hasattr(ParallelHybridRegressor(Gain()), "sensitivity")


class ForwardOnly:
    def forward(self, X, parameter):
        return parameter * np.ones(len(X))


def test_a_parameter_that_cannot_be_had_is_told(recording):
    X, y, _ = recording
    with pytest.raises(ValueError, match=r"ForwardOnly has neither predict nor invert; set parameter"):
        ParallelHybridRegressor(ForwardOnly(), Ridge()).fit(X, y)
    with pytest.raises(ValueError, match=r"parameter is for a mechanism with forward, which Ridge has not"):
        ParallelHybridRegressor(Ridge(), Ridge(), parameter=1.0).fit(X, y)
    with pytest.raises(ValueError, match=r"can be inverted for its parameter in none of the 300 rows"):
        ParallelHybridRegressor(Orifice(), Ridge()).fit(X.assign(p1=X["p2"]), y)
    with pytest.raises(ValueError, match="The 'mechanism' parameter"):
        ParallelHybridRegressor(StandardScaler(), Ridge()).fit(X, y)


def test_weights_reach_both_models_with_routing_on_and_off():
    rng = np.random.default_rng(0)
    X = rng.normal(size=(60, 1))
    y = np.exp(X[:, 0])
    weight = rng.integers(0, 3, 60)
    repeated = ParallelHybridRegressor(Ridge(), LSSVMRegressor())
    repeated = repeated.fit(np.repeat(X, weight, axis=0), np.repeat(y, weight)).predict(X)
    off = ParallelHybridRegressor(Ridge(), LSSVMRegressor()).fit(X, y, sample_weight=weight).predict(X)
    with config_context(enable_metadata_routing=True):
        models = [model.set_fit_request(sample_weight=True) for model in (Ridge(), LSSVMRegressor())]
        on = ParallelHybridRegressor(*models).fit(X, y, sample_weight=weight).predict(X)
    np.testing.assert_allclose(off, repeated, rtol=1e-8)
    np.testing.assert_allclose(on, off, rtol=1e-10)
