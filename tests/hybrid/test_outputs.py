# SPDX-License-Identifier: BSD-3-Clause
"""One learnt f(x) for the flow and for the outlet pressure."""

import warnings

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures

from sklvalve.hybrid import SeriesHybridRegressor
from sklvalve.mechanism import ValidityWarning, ValveMechanismTransformer, gas_flow
from tests.hybrid.mechanisms import Gain

FACTS = {"fl": 0.9, "fd": 0.4, "nominal_size": 0.05, "inlet_pipe": 0.08, "outlet_pipe": 0.08}


def duties(n=120, seed=0):
    """p1, p2, opening and temperature, and the true flow coefficient; one row in ten chokes."""
    rng = np.random.default_rng(seed)
    X = rng.uniform([5e5, 2e5, 0.2, 330.0], [6e5, 4.5e5, 1.0, 350.0], (n, 4))
    X[::10, 1] = 5e4
    return X, 40.0 * 30.0 ** (X[:, 2] - 1.0)


def valve(**settings):
    roles = {"p1": 0, "p2": 1, "opening": 2, "temperature": 3}
    return ValveMechanismTransformer(**{**roles, **FACTS, **settings})


def fitted(X, kv, mechanism):
    flow = mechanism.fit(X).forward(X, kv)
    model = SeriesHybridRegressor(mechanism, LinearRegression(), link="log", regressor_columns=[2])
    return model.fit(X, flow), flow


def flow_for_p2(X, flow):
    return np.column_stack([X[:, 0], flow, X[:, 2:]])


def test_both_outputs_have_one_regressor():
    X, kv = duties()
    model, flow = fitted(X, kv, valve())
    behind = model.for_output("outlet_pressure")
    through = flow_for_p2(X, flow)
    choked = np.arange(len(X)) % 10 == 0
    assert behind.regressor_ is model.regressor_
    np.testing.assert_allclose(model.predict(X), flow, rtol=1e-9)
    np.testing.assert_allclose(behind.predict_parameter(through), kv, rtol=1e-9)
    np.testing.assert_allclose(behind.predict(through[~choked]), X[~choked, 1], rtol=1e-7)
    # the hybrid itself is what it was
    assert model.mechanism_.columns_ == {"opening": 2, "p1": 0, "p2": 1, "temperature": 3}
    assert model.mechanism.output == "flow"
    assert behind.get_params()["mechanism__output"] == "outlet_pressure"


def test_what_the_valve_cannot_pass_is_nan_and_counted():
    X, kv = duties()
    model, flow = fitted(X, kv, valve())
    through = flow_for_p2(X, flow * np.where(np.arange(120) < 7, 5.0, 0.9))
    with pytest.warns(ValidityWarning, match="7 of 120 rows ask for a flow that the valve cannot pass"):
        p2 = model.for_output("outlet_pressure").predict(through)
    np.testing.assert_array_equal(np.isnan(p2), np.arange(120) < 7)


def test_there_and_back_again():
    X, kv = duties()
    model, _ = fitted(X, kv, valve())
    again = model.for_output("outlet_pressure").for_output("flow")
    np.testing.assert_array_equal(again.predict(X), model.predict(X))
    np.testing.assert_array_equal(model.for_output("flow").predict(X), model.predict(X))


def test_learnt_from_the_outlet_pressure_it_gives_the_flow():
    X, kv = duties()
    X = X[np.arange(120) % 10 != 0]
    kv = kv[np.arange(120) % 10 != 0]
    flow = valve().fit(X).forward(X, kv)
    mechanism = valve(p2=None, flow=1, output="outlet_pressure")
    model = SeriesHybridRegressor(mechanism, LinearRegression(), link="log", regressor_columns=[2])
    model.fit(flow_for_p2(X, flow), X[:, 1])
    np.testing.assert_allclose(model.for_output("flow").predict(X), flow, rtol=1e-6)


def test_a_gas_too():
    rng = np.random.default_rng(0)
    X = rng.uniform([5e5, 3.5e5, 0.2, 290.0], [6e5, 4.5e5, 1.0, 330.0], (80, 4))
    kv = 20.0 * X[:, 2] ** 2
    gas = {"gamma": 1.4, "xt": 0.7}
    flow = gas_flow(kv, X[:, 0], X[:, 1], X[:, 3], 0.029, **gas)
    mechanism = ValveMechanismTransformer(
        p1=0, p2=1, opening=2, temperature=3, fluid="gas", molar_mass=0.029, **gas
    )
    regressor = make_pipeline(PolynomialFeatures(2), LinearRegression())
    model = SeriesHybridRegressor(mechanism, regressor, regressor_columns=[2], sensitivity_weights=False)
    p2 = model.fit(X, flow).for_output("outlet_pressure").predict(flow_for_p2(X, flow))
    np.testing.assert_allclose(p2, X[:, 1], rtol=1e-7)


class TestFrames:
    def frame(self):
        pd = pytest.importorskip("pandas")
        X, kv = duties()
        X = pd.DataFrame(X[np.arange(120) % 10 != 0], columns=["P1", "P2", "X", "T"])
        mechanism = ValveMechanismTransformer(p1="P1", p2="P2", opening="X", temperature="T", **FACTS)
        flow = mechanism.fit(X).forward(X, kv[np.arange(120) % 10 != 0])
        model = SeriesHybridRegressor(mechanism, LinearRegression(), link="log", regressor_columns=["X", "T"])
        return X, flow, model.fit(X, flow)

    def test_the_column_is_renamed(self):
        X, flow, model = self.frame()
        behind = model.for_output("outlet_pressure", "F")
        through = X.rename(columns={"P2": "F"}).assign(F=flow)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            p2 = behind.predict(through)
        assert list(behind.feature_names_in_) == ["P1", "F", "X", "T"]
        assert behind.mechanism.flow == "F"
        assert behind.mechanism.p2 is None
        assert np.nanmedian(np.abs(p2 / X["P2"] - 1.0)) < 1e-6
        assert list(model.for_output("outlet_pressure").feature_names_in_) == ["P1", "flow", "X", "T"]

    def test_the_copy_can_be_fitted_anew(self):
        X, flow, model = self.frame()
        behind = clone(model.for_output("outlet_pressure", "F"))
        through = X.rename(columns={"P2": "F"}).assign(F=flow)
        behind.fit(through, X["P2"])
        np.testing.assert_allclose(behind.predict_parameter(through), model.predict_parameter(X), rtol=1e-5)

    def test_one_frame_with_a_column_for_each(self):
        X, flow, model = self.frame()
        X = X.assign(F=flow)
        both = clone(model).set_params(mechanism__flow="F").fit(X, flow)
        behind = both.for_output("outlet_pressure")
        assert list(behind.feature_names_in_) == ["P1", "P2", "X", "T", "F"]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            p2 = behind.predict(X)
        assert np.nanmedian(np.abs(p2 / X["P2"] - 1.0)) < 1e-6


class TestRefused:
    def test_a_regressor_that_sees_the_output(self):
        X, kv = duties()
        model, flow = fitted(X, kv, valve())
        model.set_params(regressor_columns=None).fit(X, flow)
        with pytest.raises(ValueError, match=r"The regressor sees the column 1, which is an output"):
            model.for_output("outlet_pressure")
        np.testing.assert_array_equal(model.for_output("flow").predict(X), model.predict(X))

    def test_an_unknown_output(self):
        X, kv = duties()
        model, _ = fitted(X, kv, valve())
        with pytest.raises(ValueError, match="output must be one of flow, outlet_pressure; got 'p2'"):
            model.for_output("p2")

    def test_before_fit(self):
        with pytest.raises(NotFittedError):
            SeriesHybridRegressor().for_output("flow")

    def test_a_mechanism_with_one_output(self):
        assert not hasattr(SeriesHybridRegressor(Gain(), Ridge()), "for_output")
