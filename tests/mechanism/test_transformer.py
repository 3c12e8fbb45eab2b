# SPDX-License-Identifier: BSD-3-Clause
"""The transformer: columns by role, features by name, and the mechanism of a hybrid."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from sklearn.base import clone
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import GridSearchCV
from sklearn.pipeline import make_pipeline

from sklvalve.mechanism import (
    ValveMechanismTransformer,
    liquid_flow,
    water_density,
    water_vapour_pressure,
)
from tests.mechanism.valves import COLUMNS, ROLES, VALVE, by_position, duties, own_flow


def test_names_and_positions_are_the_same():
    pd = pytest.importorskip("pandas")
    X = duties()
    frame = pd.DataFrame(X, columns=COLUMNS)
    by_name = ValveMechanismTransformer(**ROLES, **VALVE).fit(frame)
    assert by_name.columns_ == {role: COLUMNS.index(name) for role, name in ROLES.items()}
    assert_array_equal(by_name.transform(frame), by_position().fit_transform(X))
    assert_array_equal(by_name.predict(frame), by_position().fit(X).predict(X))


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_set_output(library):
    pytest.importorskip(library)
    names = ["dp", "flow"]
    frame = by_position(features=names).set_output(transform=library).fit_transform(duties())
    assert type(frame).__module__.startswith(library)
    assert list(frame.columns) == names


def test_flow_mechanism_is_its_own_inverse():
    X = duties()
    valve = by_position(warn=False).fit(X)
    kv = np.random.default_rng(1).uniform(0.5, 40.0, len(X))
    again = valve.invert(X, valve.forward(X, kv))
    no_drop = X[:, 2] == X[:, 3]
    assert_array_equal(np.isnan(again), no_drop)
    assert_allclose(again[~no_drop], kv[~no_drop], rtol=1e-9)


def test_outlet_pressure_mechanism_is_its_own_inverse():
    X = duties()
    valve = by_position(output="outlet_pressure", warn=False).fit(X)
    kv = by_position(features=["kv"]).fit_transform(X)[:, 0]
    p2 = valve.forward(X, kv)
    assert_allclose(valve.predict(X), p2, rtol=0.0)
    choked_ahead = by_position(features=["pressure_ratio"]).fit_transform(X)[:, 0] >= 0.64
    assert 20 < choked_ahead.sum() < 180
    assert_array_equal(np.isnan(p2), choked_ahead)
    assert_allclose(p2[~choked_ahead], X[~choked_ahead, 3], rtol=1e-9)
    # no flow tells nothing of the valve that it does not pass
    undetermined = choked_ahead | (X[:, 4] == 0.0)
    again = valve.invert(X, X[:, 3])
    assert_array_equal(np.isnan(again), undetermined)
    assert_allclose(again[~undetermined], kv[~undetermined], rtol=1e-9)


@pytest.mark.parametrize("output", ["flow", "outlet_pressure"])
@pytest.mark.parametrize("fl", [None, 0.8])
def test_sensitivity_is_the_derivative(output, fl):
    X = duties()
    valve = by_position(output=output, fl=fl, warn=False).fit(X)
    kv = by_position(features=["kv"]).fit_transform(X)[:, 0] * 1.1
    step = 1e-6 * kv
    slope = (valve.forward(X, kv + step) - valve.forward(X, kv - step)) / (2.0 * step)
    found = valve.sensitivity(X, kv)
    assert np.isfinite(slope).sum() > 50
    assert_allclose(found, slope, rtol=1e-5, atol=1e-9)


def test_predict_is_there_with_a_rated_capacity_only():
    X = duties()
    assert_allclose(by_position().fit(X).predict(X), own_flow(X), rtol=1e-12)
    assert not hasattr(by_position(kv_rated=None), "predict")


def test_default_features_are_those_that_can_be_had():
    X = duties()
    everything = by_position().fit(X)
    assert list(everything.get_feature_names_out()) == [
        "relative_capacity", "dp", "sqrt_dp_over_density", "pressure_ratio", "density", "vapour_pressure",
    ]  # fmt: skip
    without_p2 = by_position(p2=None, output="outlet_pressure", warn=False).fit(X)
    assert without_p2.features_ == ["relative_capacity", "density", "vapour_pressure"]
    assert without_p2.transform(X).shape == (200, 3)
    assert_array_equal(
        without_p2.predict(X), by_position(output="outlet_pressure", warn=False).fit(X).predict(X)
    )


def test_without_temperature_the_liquid_is_at_20_degrees():
    X = duties()
    valve = by_position(temperature=None, features=["density"]).fit(X)
    assert_allclose(valve.transform(X)[:, 0], water_density(293.15), rtol=0.0)


def test_another_liquid():
    X = duties()
    oil = {"fluid": "oil", "density": 870.0, "vapour_pressure": 10.0, "critical_pressure": 2e6}
    valve = by_position(**oil, fl=0.9).fit(X)
    known = {"fl": 0.9, "p_vapour": 10.0, "p_critical": 2e6}
    assert_allclose(valve.forward(X, 10.0), liquid_flow(10.0, X[:, 2], X[:, 3], 870.0, **known), rtol=1e-14)


def test_fl_over_travel():
    X = duties()
    table = [[0.0, 0.95], [1.0, 0.75]]
    valve = by_position(fl=table).fit(X)
    p_vapour = water_vapour_pressure(X[:, 0])
    fl = 0.95 - 0.2 * X[:, 1]
    flow = liquid_flow(10.0, X[:, 2], X[:, 3], water_density(X[:, 0]), fl=fl, p_vapour=p_vapour)
    assert_allclose(valve.forward(X, 10.0), flow, rtol=1e-12)


def test_gaps_stay_gaps():
    X = duties()
    X[5, 2] = np.nan
    X[7, 0] = np.nan
    valve = by_position(features=["dp", "density", "flow"]).fit(X)
    out = valve.transform(X)
    assert_array_equal(np.isnan(out[5]), [True, False, True])
    assert_array_equal(np.isnan(out[7]), [False, True, True])
    assert np.isfinite(np.delete(out, [5, 7], axis=0)).all()


def test_in_a_pipeline_and_a_grid():
    X = duties()
    y = own_flow(X)
    model = make_pipeline(by_position(features=["flow"], warn=False), LinearRegression())
    grid = GridSearchCV(model, {"valvemechanismtransformer__rangeability": [10.0, 30.0, 90.0]}, cv=3).fit(
        X, y
    )
    assert grid.best_params_ == {"valvemechanismtransformer__rangeability": 30.0}
    assert_allclose(grid.predict(X), y, rtol=1e-6, atol=1e-9)


class TestForOutput:
    def test_the_flow_stands_where_p2_stood(self):
        X = duties()
        valve = by_position(flow=None, warn=False, features=["dp", "density", "flow"]).fit(X[:, :4])
        behind = valve.for_output("outlet_pressure")
        through = X[:, :4].copy()
        through[:, 3] = X[:, 4]
        assert behind.columns_ == {"opening": 1, "p1": 2, "temperature": 0, "flow": 3}
        assert (behind.p2, behind.flow, behind.output) == (None, 3, "outlet_pressure")
        assert behind.features_ == ["density"]
        assert_allclose(
            behind.predict(through), by_position(output="outlet_pressure", warn=False).fit(X).predict(X)
        )
        assert_allclose(behind.for_output("flow").predict(X[:, :4]), valve.predict(X[:, :4]), rtol=0.0)
        assert (valve.p2, valve.flow, valve.output) == (3, None, "flow")

    def test_a_column_for_each_is_kept(self):
        X = duties()
        valve = by_position(warn=False).fit(X)
        behind = valve.for_output("outlet_pressure")
        assert behind.columns_ == valve.columns_
        assert valve.output_columns == behind.output_columns == {3, 4}
        assert_array_equal(
            behind.predict(X), by_position(output="outlet_pressure", warn=False).fit(X).predict(X)
        )

    def test_named_columns(self):
        pd = pytest.importorskip("pandas")
        frame = pd.DataFrame(duties(), columns=COLUMNS)
        roles = {**ROLES, "flow": None}
        valve = ValveMechanismTransformer(**roles, **VALVE, warn=False).fit(frame[COLUMNS[:4]])
        behind = valve.for_output("outlet_pressure", "F")
        assert list(behind.feature_names_in_) == ["t", "h", "pin", "F"]
        assert clone(behind).fit(frame[["t", "h", "pin", "F"]]).columns_ == behind.columns_
        assert np.isfinite(behind.predict(frame[["t", "h", "pin", "F"]])).sum() > 50

    def test_refused(self):
        X = duties()
        with pytest.raises(ValueError, match="output must be one of flow, outlet_pressure; got 'p1'"):
            by_position().fit(X).for_output("p1")
        with pytest.raises(ValueError, match="outlet_pressure needs a column of flow, and there is none"):
            by_position(p2=None, flow=None).fit(X).for_output("outlet_pressure")


def test_copies():
    X = duties()
    valve = by_position().fit(X)
    assert_array_equal(pickle.loads(pickle.dumps(valve)).predict(X), valve.predict(X))
    assert clone(valve).get_params() == valve.get_params()


def test_safe_saving():
    skops = pytest.importorskip("skops.io")
    X = duties()
    valve = by_position().fit(X)
    saved = skops.dumps(valve)
    name = "sklvalve.mechanism.transformer.ValveMechanismTransformer"
    assert skops.get_untrusted_types(data=saved) == [name]
    assert_array_equal(skops.loads(saved, trusted=[name]).predict(X), valve.predict(X))
