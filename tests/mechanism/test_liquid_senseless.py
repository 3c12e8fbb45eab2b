# SPDX-License-Identifier: BSD-3-Clause
"""Data that cannot be give NaN and are counted; missing ones give NaN in silence; nothing else complains."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from sklvalve.mechanism import (
    LIQUID_STATES,
    ValidityWarning,
    cavitation_index,
    combined_recovery_factor,
    fitting_loss,
    incipient_xfz,
    liquid_flow,
    liquid_inlet_pressure,
    liquid_kv,
    liquid_outlet_pressure,
    liquid_state,
    nonturbulent_flow_ratio,
    opening_for_flow,
    piping_factor,
    pressure_ratio_xf,
    reynolds_factor,
    valve_reynolds_number,
    vena_contracta_pressure,
)

VALVE = {
    "fl": 0.9,
    "fd": 0.4,
    "nominal_size": 0.05,
    "kv_rated": 20.0,
    "inlet_pipe": 0.06,
    "outlet_pipe": 0.07,
}
LIQUID = {"density": 1000.0, "viscosity": 1e-5, "p_vapour": 2e3}
DUTIES = {
    liquid_flow: {"kv": 10.0, "p1": 6e5, "p2": 4e5},
    liquid_kv: {"flow": 3e-3, "p1": 6e5, "p2": 4e5},
    liquid_outlet_pressure: {"flow": 3e-3, "kv": 10.0, "p1": 6e5},
    liquid_inlet_pressure: {"flow": 3e-3, "kv": 10.0, "p2": 4e5},
}
NONSENSE = [
    *((name, value) for name in VALVE for value in (0.0, -0.5)),
    ("p_vapour", -1.0),
    ("p_vapour", 3e7),
    ("p_critical", 0.0),
    ("p1", -1e5),
    ("p2", -1e5),
]


def told(function, *arguments, **known):
    """The result and what was warned of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = function(*arguments, **known)
    assert all(warning.category is ValidityWarning for warning in caught)
    assert all(warning.filename == __file__ for warning in caught)
    return found, [str(warning.message) for warning in caught]


@pytest.mark.parametrize("function", DUTIES, ids=lambda function: function.__name__)
class TestEveryDirection:
    @pytest.mark.parametrize(("name", "value"), NONSENSE)
    @pytest.mark.parametrize("strict", [False, True])
    def test_nonsense_is_counted_once_and_its_row_alone_is_lost(self, function, name, value, strict):
        duty = {**DUTIES[function], **VALVE, **LIQUID, "p_critical": 22e6}
        # by the letter the rated capacity only chooses the kind of trim
        if name not in duty or (strict and name == "kv_rated"):
            return
        good = function(**duty, strict=strict)
        found, messages = told(
            function, **(duty | {name: np.array([duty[name], value, np.nan])}), strict=strict
        )
        assert found[0] == good
        assert np.all(np.isnan(found[1:]))
        assert len(messages) == 1
        assert messages[0].startswith(f"{function.__name__}: 1 of 3 rows hold what cannot be")
        quiet = {**duty, name: value, "strict": strict, "warn": False}
        assert told(function, **quiet)[1] == []

    def test_a_density_that_cannot_be_is_told_as_that(self, function):
        duty = {**DUTIES[function], **VALVE, **LIQUID, "density": [1000.0, -1.0, 0.0]}
        found, messages = told(function, **duty)
        assert_array_equal(np.isnan(found), [False, True, True])
        assert [message.split("rows ")[1] for message in messages] == [
            "have a density that is not positive and give NaN."
        ]

    @pytest.mark.parametrize(
        "name", ["p_vapour", "p_critical", "density", "viscosity", "fl", "kv", "flow", "p1", "kv_rated"]
    )
    def test_missing_data_are_no_flow_that_cannot_pass(self, function, name):
        duty = {**DUTIES[function], **VALVE, **LIQUID, "p_critical": 22e6}
        if name not in duty:
            return
        found, messages = told(function, **(duty | {name: [duty[name], np.nan]}))
        assert_array_equal(np.isnan(found), [False, True])
        assert messages == []

    def test_missing_vapour_pressure_without_pipes_and_viscosity(self, function):
        duty = {**DUTIES[function], "density": 1000.0, "fl": 0.9, "p_vapour": [2e3, np.nan]}
        found, messages = told(function, **duty)
        assert_array_equal(np.isnan(found), [False, True])
        assert messages == []

    def test_data_that_are_not_used_do_not_matter(self, function):
        duty = {**DUTIES[function], "density": 1000.0}
        found, messages = told(function, **duty, nominal_size=-0.05, fd=-1.0, kv_rated=0.0)
        assert found == function(**duty)
        assert messages == []

    @pytest.mark.parametrize("name", ["p1", "p2", "flow", "kv", "density", "viscosity", "fl", "nominal_size"])
    def test_the_infinite_brings_no_other_warning(self, function, name):
        duty = {**DUTIES[function], **VALVE, **LIQUID}
        for whole in (duty, {**DUTIES[function], "density": 1000.0}):
            if name in whole:
                assert told(function, **(whole | {name: np.inf}), warn=False)[1] == []


def test_both_pressures_infinite():
    assert told(liquid_flow, 10.0, np.inf, np.inf, 1000.0, warn=False)[1] == []
    assert np.isnan(liquid_kv(1e-3, np.inf, np.inf, **LIQUID, **VALVE, warn=False))


def test_states_of_nonsense_are_unknown():
    for name, value in NONSENSE:
        duty = {"kv": 10.0, "p1": 6e5, "p2": 4e5, **VALVE, **LIQUID} | {name: value}
        assert LIQUID_STATES[liquid_state(**duty)] == "unknown", name
    assert liquid_state(10.0, -1e6, -2e6, 1000.0) == -2
    assert liquid_state(10.0, 6e5, 4e5, 1000.0, fl=0.9, fd=-1.0, p_vapour=2e3) == -2


class TestVenaContracta:
    def test_boiling_before_the_valve(self):
        p_vapour = [2e3, 1.02e6, 2e6, np.nan]
        p_vc, messages = told(vena_contracta_pressure, 1e6, 1e5, 0.9, p_vapour=p_vapour)
        assert_array_equal(np.isnan(p_vc), [False, False, True, True])
        assert np.all(p_vc[:2] < 1e6)
        assert len(messages) == 1
        assert "2 of 4 rows have liquid at or below its vapour pressure" in messages[0]

    def test_below_zero_absolute(self):
        with pytest.warns(ValidityWarning, match="1 of 2 rows fall below zero absolute: give p_vapour"):
            p_vc = vena_contracta_pressure(1e6, [1e5, 8e5], 0.9)
        assert p_vc[0] < 0.0 < p_vc[1]

    @pytest.mark.parametrize(
        "known", [{"p1": -1e5}, {"fl": -0.9}, {"fl": 0.0}, {"p_vapour": -1.0}, {"p_critical": 1e3}]
    )
    def test_nonsense(self, known):
        duty = {"p1": 6e5, "p2": 4e5, "fl": 0.9, "p_vapour": 2e3} | known
        p_vc, messages = told(vena_contracta_pressure, **duty)
        assert np.isnan(p_vc)
        assert ["1 of 1 rows hold what cannot be" in message for message in messages] == [True]
        assert told(vena_contracta_pressure, **duty, warn=False)[1] == []


def test_cavitation():
    for function in (cavitation_index, pressure_ratio_xf):
        found, messages = told(
            function, [6e5, -1e5, 6e5, np.nan], [4e5, -2e5, 4e5, 4e5], [2e3, 2e3, -1.0, 2e3]
        )
        assert_array_equal(np.isnan(found), [False, True, True, True])
        assert any("2 of 4 rows hold what cannot be" in message for message in messages)
        for p1, p2, p_vapour in ((np.inf, np.inf, 2e3), (np.inf, 4e5, 2e3), (np.inf, 4e5, np.inf)):
            assert told(function, p1, p2, p_vapour, warn=False)[1] == []
    assert np.all(np.isnan(incipient_xfz(10.0, [0.0, -0.9, 0.9, 0.9], [0.4, 0.4, -0.4, 0.0])))


def test_parts_of_the_equations():
    known = {"viscosity": 1e-5, "fl": 0.9, "fd": 0.4, "inlet_pipe": 0.05}
    for name in known:
        for value in (0.0, -0.5):
            assert np.isnan(told(valve_reynolds_number, 1e-3, 10.0, **(known | {name: value}))[0]), name
    for function in (reynolds_factor, nonturbulent_flow_ratio):
        for strict in (False, True):
            for bad in ((-1.0, 1.2, 0.9), (100.0, 0.0, 0.9), (100.0, -1.0, 0.9), (100.0, 1.2, 0.0)):
                found, messages = told(function, *bad, strict=strict)
                assert np.isnan(found), bad
                assert messages == []
    assert np.all(np.isnan(told(fitting_loss, [0.05, -0.05, 0.0], [0.0, 0.06, 0.06], 0.07)[0]))
    assert np.all(np.isnan(told(combined_recovery_factor, 10.0, [0.0, -1.0, 0.05], 1.0, [0.9, 0.9, -0.9])[0]))


def test_piping_factor_of_no_bore():
    found, messages = told(piping_factor, [0.0, 10.0, 10.0], [0.0, -0.05, 0.05], 0.5)
    assert_array_equal(np.isnan(found), [True, True, False])
    assert messages == ["piping_factor: 2 of 3 rows have a nominal_size that is not positive and give NaN."]
    assert told(piping_factor, [0.0, 10.0], [0.0, 0.0], 0.5, warn=False)[1] == []


def test_opening_for_an_infinite_flow():
    trim = {"kv_rated": 20.0, "characteristic": "linear"}
    for known in ({}, {name: VALVE[name] for name in ("fl", "fd", "nominal_size")} | {"viscosity": 1e-5}):
        found, messages = told(opening_for_flow, np.inf, 6e5, 4e5, 1000.0, **trim, **known)
        assert np.isnan(found)
        assert "1 of 1 rows ask for more than the valve passes" in messages[0]
        assert told(opening_for_flow, 1e-3, np.inf, np.inf, 1000.0, **trim, **known, warn=False)[1] == []
