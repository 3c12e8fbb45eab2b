# SPDX-License-Identifier: BSD-3-Clause
"""Gas data that make no sense or are missing: NaN, counted as what they are, and never an exception."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    ValidityWarning,
    choked_drop_ratio,
    combined_drop_ratio_factor,
    expansion_factor,
    fitting_loss,
    gas_density,
    gas_flow,
    gas_inlet_pressure,
    gas_kv,
    gas_mass_flow,
    gas_outlet_pressure,
    gas_volume_flow,
)
from tests.mechanism.gas_duties import KINDS, duties

GAS = {"temperature": 300.0, "molar_mass": 0.029, "compressibility": 1.0, "gamma": 1.4, "xt": 0.7}
JET = {"dynamic_viscosity": 1.8e-5, "fl": 0.9, "fd": 0.46, "kv_rated": 20.0, "nominal_size": 0.05}
PIPES = {"inlet_pipe": 0.08, "outlet_pipe": 0.08}
KNOWN = {**GAS, **JET, **PIPES}
FUNCTIONS = {
    "gas_flow": (gas_flow, (10.0, 6e5, 5e5)),
    "gas_kv": (gas_kv, (0.2, 6e5, 5e5)),
    "gas_outlet_pressure": (gas_outlet_pressure, (0.2, 10.0, 6e5)),
    "gas_inlet_pressure": (gas_inlet_pressure, (0.2, 10.0, 5e5)),
}


def said_by(function, *args, **known):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = function(*args, **known)
    assert all(warning.category is ValidityWarning for warning in caught)
    # the warning points to the line that called
    assert all(warning.filename == __file__ for warning in caught)
    return found, [str(warning.message) for warning in caught]


@pytest.mark.parametrize("where", FUNCTIONS)
@pytest.mark.parametrize("name", KNOWN)
def test_senseless_data_are_counted(where, name):
    function, duty = FUNCTIONS[where]
    values = KNOWN[name] * np.array([1.0, 0.0, -1.0, np.inf])
    found, said = said_by(function, *duty, **{**KNOWN, name: values})
    assert np.isnan(found).tolist() == [False, True, True, True]
    assert said == [f"{where}: 3 of 4 rows have a {name} that is not positive and finite: NaN."]


@pytest.mark.parametrize("where", FUNCTIONS)
@pytest.mark.parametrize("name", KNOWN)
def test_missing_data_are_not_counted(where, name):
    function, duty = FUNCTIONS[where]
    found, said = said_by(function, *duty, **{**KNOWN, name: np.array([KNOWN[name], np.nan])})
    assert np.isnan(found).tolist() == [False, True]
    assert said == []


@pytest.mark.parametrize("where", FUNCTIONS)
@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_missing_duty_is_not_counted(where, at):
    function, duty = FUNCTIONS[where]
    duty = [np.array([value, np.nan]) if i == at else value for i, value in enumerate(duty)]
    found, said = said_by(function, *duty, **KNOWN)
    assert np.isnan(found).tolist() == [False, True]
    assert said == []


@pytest.mark.parametrize("where", FUNCTIONS)
def test_several_senseless_data_are_named_together(where):
    function, duty = FUNCTIONS[where]
    odd = {"temperature": np.array([-1.0, 300.0, 300.0]), "fl": np.array([0.9, 0.9, 0.0])}
    found, said = said_by(function, *duty, **{**KNOWN, **odd})
    assert np.isnan(found).tolist() == [True, False, True]
    assert said == [f"{where}: 2 of 3 rows have a temperature or fl that is not positive and finite: NaN."]


@pytest.mark.parametrize("where", FUNCTIONS)
def test_what_is_not_used_may_be_anything(where):
    function, duty = FUNCTIONS[where]
    unused = {"fl": -1.0, "fd": np.nan, "kv_rated": 0.0, "nominal_size": -1.0}
    found, said = said_by(function, *duty, **GAS, **unused)
    assert found == function(*duty, **GAS)
    assert said == []


@pytest.mark.parametrize("where", FUNCTIONS)
def test_senseless_pressures_are_counted(where):
    function, duty = FUNCTIONS[where]
    known = duty[2] * np.array([1.0, -1.0, np.inf])
    found, said = said_by(function, *duty[:2], known, **KNOWN)
    assert np.isnan(found).tolist() == [False, True, True]
    assert [f"{where}: 2 of 3 rows have a pressure below zero" in words for words in said] == [True]


def test_a_vast_capacity_is_counted():
    found, said = said_by(gas_flow, [10.0, np.inf, 1e200], 6e5, 5e5, **KNOWN)
    assert np.isnan(found).tolist() == [False, True, True]
    assert said == ["gas_flow: 2 of 3 rows have a kv too large to reckon with: NaN."]


def test_impossible_reducers_are_counted_by_the_factor():
    zeta_sum, zeta_inlet = fitting_loss(0.05, 0.05, 0.07)
    found, said = said_by(combined_drop_ratio_factor, [10.0, 500.0], 0.05, zeta_sum, zeta_inlet, 0.7)
    assert np.isnan(found).tolist() == [False, True]
    assert [words.startswith("combined_drop_ratio_factor: 1 of 2 rows") for words in said] == [True]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("warn", [False, True])
def test_no_data_raise_anything_else(kind, warn):
    rng = np.random.default_rng(1)
    odd = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 1e-300, 1e300, 1e5, 2e5, 0.5, 1.4, 300.0])
    names = duties(kind, 1, seed=0)[1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        for _ in range(5):
            known = {name: rng.choice(odd, 2000) for name in names}
            for function, _ in FUNCTIONS.values():
                duty = (rng.choice(odd, 2000) for _ in range(5))
                assert function(*duty, warn=warn, **known).shape == (2000,)


def test_factors_and_units_raise_nothing():
    odd = np.array([np.nan, np.inf, -np.inf, 0.0, -1.0, 1e-300, 1e300, 0.5])
    columns = [column.ravel() for column in np.meshgrid(*[odd] * 5)]
    a, b, c, d, e = columns
    combined_drop_ratio_factor(a, b, c, d, e, warn=False)
    choked_drop_ratio(a, b)
    expansion_factor(a, b)
    assert np.all(np.isnan(gas_density(a, b, c, d)[a < 0.0]))
    for basis in ("actual", "normal"):
        flow = gas_volume_flow(a, basis, b, c, d, e)
        assert gas_mass_flow(flow, basis, b, c, d, e).shape == a.shape


def test_volume_at_an_unknown_inlet_pressure_is_enough_in_turbulent_flow():
    valve = {"gamma": 1.4, "xt": 0.7, "fl": 0.9, "fd": 0.4, "nominal_size": 0.05, "kv_rated": 20.0}
    known = {**valve, "dynamic_viscosity": 1.8e-5, "basis": "actual"}
    flow = gas_flow(10.0, 6e5, 5e5, 300.0, 0.029, **known)
    found, said = said_by(gas_inlet_pressure, flow, 10.0, 5e5, 300.0, 0.029, **known)
    assert_allclose(found, 6e5, rtol=1e-12)
    assert said == []
    back = gas_outlet_pressure(-flow, 10.0, 5e5, 300.0, 0.029, **known)
    assert_allclose(back, 6e5, rtol=1e-12)


@pytest.mark.parametrize("kind", ["viscous", "viscous reducers"])
def test_volumes_before_viscous_valves(kind):
    (kv, p1, p2, *gas), known = duties(kind, 20_000, seed=41)
    known["basis"] = "actual"
    flow = gas_flow(kv, p1, p2, *gas, **known)
    found, said = said_by(gas_inlet_pressure, flow, kv, p2, *gas, **known)
    there = ~np.isnan(found)
    assert 0.1 < np.mean(there) < 0.9
    # what is found passes the volume, and the rest is said
    assert_allclose(gas_flow(kv, found, p2, *gas, **known)[there], flow[there], rtol=1e-9)
    lost = f"gas_inlet_pressure: {np.sum(~there)} of 20000 rows have a volume at the unknown inlet pressure"
    assert [words.startswith(lost) for words in said] == [True]
