# SPDX-License-Identifier: BSD-3-Clause
"""A parameter that is set behind a fit counts from the next fit on: what is predicted stays the same."""

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression

from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValveMechanismTransformer
from tests.test_refits import CASES, VALVE, X, Y

#: Parameters that change no number: how many threads work, and whether a warning is given.
NOT_OF_THE_FIT = {"n_jobs": 1, "warn": False}


def _set_each(model, remembered):
    """Set each parameter, also of the models inside, to what no code could work with."""
    before = remembered(model)
    for name, value in model.get_params().items():
        other = NOT_OF_THE_FIT.get(name.split("__")[-1], f"no {name}")
        model.set_params(**{name: other})
        np.testing.assert_array_equal(remembered(model), before, err_msg=name)
        model.set_params(**{name: value})


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", CASES)
def test_parameters_set_behind_a_fit_change_no_prediction(case):
    _set_each(case.fitted(), case.remembered)


@pytest.mark.filterwarnings("ignore::sklvalve.mechanism.ValidityWarning")
def test_of_hybrids_with_models_of_ones_own():
    A, flow = VALVE
    valve = ValveMechanismTransformer(kv_rated=40.0, fl=0.9)
    models = [
        SeriesHybridRegressor(valve, LSSVMRegressor(), link="log", regressor_columns=[0]),
        ParallelHybridRegressor(valve, LinearRegression(), parameter=3.0, regressor_columns=[0]),
        ParallelHybridRegressor(valve, LinearRegression()),
    ]
    for model in models:
        _set_each(model.fit(A, flow), lambda fitted: fitted.predict(A[:9]))
    series, parallel, _ = models
    _set_each(series, lambda fitted: fitted.predict_parameter(A[:9]))
    through = np.column_stack([A[:, :2], flow])[:9]
    _set_each(series, lambda fitted: fitted.for_output("outlet_pressure").predict(through))
    for method in ("forward", "sensitivity", "invert"):
        _set_each(parallel, lambda fitted, method=method: getattr(fitted, method)(A[:9], flow[:9]))


def test_columns_that_are_changed_in_place():
    columns = [0]
    model = SeriesHybridRegressor(regressor_columns=columns).fit(*VALVE)
    before = model.predict(VALVE[0][:9])
    columns.append(1)
    np.testing.assert_array_equal(model.predict(VALVE[0][:9]), before)


@pytest.mark.parametrize("method", ["forward", "invert", "sensitivity"])
def test_of_the_mechanism(method):
    A, flow = VALVE
    A = np.column_stack([A, np.full(len(A), 350.0)])
    more = {"fluid": "sugar juice", "brix": 40.0, "temperature": 3, "fd": 0.4, "nominal_size": 0.05}
    valve = ValveMechanismTransformer(kv_rated=40.0, fl=0.9, **more).fit(A)
    _set_each(valve, lambda fitted: getattr(fitted, method)(A[:9], flow[:9]))


def test_the_other_output_of_a_mechanism_is_that_of_the_fit():
    A, _ = VALVE
    valve = ValveMechanismTransformer(kv_rated=40.0).fit(A)
    through = np.column_stack([A[:, :2], valve.predict(A)])
    behind = valve.set_params(kv_rated=1.0).for_output("outlet_pressure")
    np.testing.assert_allclose(behind.predict(through), A[:, 2])
    np.testing.assert_allclose(behind.fit(through).predict(through), A[:, 2])


def test_predict_of_a_mechanism_comes_and_goes_with_the_fit():
    valve = ValveMechanismTransformer().fit(VALVE[0])
    assert not hasattr(valve.set_params(kv_rated=40.0), "predict")
    assert hasattr(valve.fit(VALVE[0]), "predict")


def test_of_the_pruned_machine_and_the_graph():
    model = LSSVMRegressor("poly", degree=2, coef0=2.0, gamma=0.2, random_state=0).fit(X, Y)
    others = [("degree", 3), ("coef0", 0.0), ("kernel", "rbf"), ("C", 1e-6), ("bias", "none")]
    before = model.pruned(10).predict(X[:9])
    for name, value in others:
        old = getattr(model, name)
        np.testing.assert_array_equal(
            model.set_params(**{name: value}).pruned(10).predict(X[:9]), before, err_msg=name
        )
        model.set_params(**{name: old})


def test_of_the_graph():
    pytest.importorskip("onnx", reason="needs onnx, of the extra `onnx`")
    from sklvalve.lssvm import to_onnx

    model = LSSVMRegressor("poly", degree=2, coef0=2.0, gamma=0.2).fit(X, Y)
    before = to_onnx(model).SerializeToString()
    for name, value in [("degree", 3), ("coef0", 0.0), ("kernel", "rbf"), ("kernel", "precomputed")]:
        old = getattr(model, name)
        assert to_onnx(model.set_params(**{name: value})).SerializeToString() == before, name
        model.set_params(**{name: old})
