# SPDX-License-Identifier: BSD-3-Clause
"""Viscosity and reducers where they have no answer, or miss a datum."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import (
    ValidityWarning,
    liquid_flow,
    liquid_inlet_pressure,
    liquid_kv,
    liquid_outlet_pressure,
    vena_contracta_pressure,
)

OIL = {"density": 900.0, "fl": 0.9, "fd": 0.46, "viscosity": 1e-3, "nominal_size": 0.1}
PIPES = {"nominal_size": 0.08, "inlet_pipe": 0.1, "outlet_pipe": 0.12}


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (liquid_flow, (50.0, 5e5, 3e5)),
        (liquid_kv, (1e-2, 5e5, 3e5)),
        (liquid_outlet_pressure, (1e-2, 50.0, 5e5)),
        (liquid_inlet_pressure, (1e-2, 50.0, 3e5)),
    ],
)
class TestEveryDirection:
    def test_missing_data(self, function, arguments):
        with pytest.raises(ValueError, match="viscosity is given without fl and fd and nominal_size"):
            function(*arguments, 900.0, viscosity=1e-3)
        with pytest.raises(ValueError, match="a pipe is given without nominal_size"):
            function(*arguments, 900.0, outlet_pipe=0.1)

    def test_thin_liquid_in_equal_pipes_is_as_without(self, function, arguments):
        plain = function(*arguments, 900.0, fl=0.9, p_vapour=1e4)
        bores = dict.fromkeys(("nominal_size", "inlet_pipe", "outlet_pipe"), 0.1)
        more = function(*arguments, 900.0, fl=0.9, p_vapour=1e4, viscosity=1e-9, fd=0.46, **bores)
        assert_allclose(more, plain, rtol=1e-14)

    def test_one_pipe_leaves_the_other_end_as_it_is(self, function, arguments):
        one = function(*arguments, 900.0, nominal_size=0.08, inlet_pipe=0.1)
        assert one == function(*arguments, 900.0, nominal_size=0.08, inlet_pipe=0.1, outlet_pipe=0.08)
        assert one != function(*arguments, 900.0)

    def test_viscosity_that_is_none(self, function, arguments):
        oil = OIL | {"viscosity": [1e-3, 0.0, -1.0]}
        with pytest.warns(ValidityWarning, match="2 of 3 rows have a viscosity that is not positive"):
            found = function(*arguments, **oil)
        assert_array_equal(np.isnan(found), [False, True, True])

    def test_nan_in_nan_out_without_a_word(self, function, arguments):
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            for name in ("fl", "fd", "viscosity", "nominal_size", "density"):
                assert np.isnan(function(*arguments, **(OIL | {name: np.nan}), warn=False)), name
            assert np.isnan(function(*arguments, 900.0, **(PIPES | {"inlet_pipe": np.nan}), warn=False))

    def test_beyond_the_accuracy_of_the_standard(self, function, arguments):
        if function is liquid_kv:
            arguments = (0.2, *arguments[1:])
        else:
            arguments = tuple(700.0 if value == 50.0 else value for value in arguments)
        with pytest.warns(ValidityWarning, match="1 of 1 rows have a kv beyond 0.047 N18 d2"):
            function(*arguments, 900.0, nominal_size=0.095, inlet_pipe=0.12, outlet_pipe=0.1)


def test_shut_and_still():
    assert liquid_flow(0.0, 5e5, 3e5, **OIL) == 0.0
    assert liquid_flow(50.0, 5e5, 5e5, **OIL) == 0.0
    assert liquid_kv(0.0, 5e5, 3e5, **OIL) == 0.0
    assert liquid_outlet_pressure(0.0, 50.0, 5e5, **OIL) == 5e5
    assert liquid_inlet_pressure(0.0, 50.0, 5e5, **OIL) == 5e5


def test_negative_capacity_continues_linearly_and_sizing_against_the_drop():
    assert liquid_flow(-50.0, 5e5, 3e5, **OIL, warn=False) == -liquid_flow(50.0, 5e5, 3e5, **OIL)
    with pytest.warns(ValidityWarning, match="flow against the pressure drop"):
        kv = liquid_kv(-1e-3, 5e5, 3e5, **OIL)
    assert kv == -liquid_kv(1e-3, 5e5, 3e5, **OIL)


def test_flow_that_a_piped_viscous_valve_cannot_pass():
    known = OIL | {"p_vapour": 2e5}
    most = liquid_flow(50.0, 5e5, 1e4, **known)
    with pytest.warns(ValidityWarning, match="2 of 3 rows ask for a flow that the valve cannot pass"):
        p2, feasible = liquid_outlet_pressure(
            most * np.array([0.9, 1.0, 1.1]), 50.0, 5e5, **known, return_feasible=True
        )
    assert_array_equal(feasible, [True, False, False])
    assert_array_equal(np.isnan(p2), ~feasible)


def test_reducers_that_give_back_more_than_the_valve_takes():
    # the wider pipe behind it gives back more pressure than its reducer takes
    pipes = {"nominal_size": 0.1, "inlet_pipe": 0.1, "outlet_pipe": 0.2}
    with (
        pytest.warns(ValidityWarning, match="1 of 2 rows have no flow that satisfies the equations"),
        pytest.warns(ValidityWarning, match="1 of 2 rows have a kv beyond"),
    ):
        flow = liquid_flow([10.0, 900.0], 5e5, 3e5, 900.0, **pipes)
    assert_array_equal(np.isnan(flow), [False, True])


def test_vena_contracta_between_reducers():
    # at the onset of choking the pressure is F_F p_v, with reducers as without
    p2 = np.linspace(679e3, 10e3, 2000)
    known = {"p_vapour": 70.1e3, "p_critical": 22.12e6}
    p_vc = vena_contracta_pressure(680e3, p2, 0.9, kv=150.0, **PIPES, **known)
    flow = liquid_flow(150.0, 680e3, p2, 965.4, fl=0.9, **PIPES, **known)
    choked = flow >= flow[-1]
    floor = 0.9442375225233299 * 70.1e3
    assert 100 < choked.sum() < 1900
    assert_allclose(p_vc[choked], floor, rtol=1e-12)
    assert np.all(p_vc[~choked] > floor)
    assert np.all(np.diff(p_vc[~choked]) < 0.0)
    turned = {"nominal_size": 0.08, "inlet_pipe": 0.12, "outlet_pipe": 0.1}
    assert_array_equal(vena_contracta_pressure(p2, 680e3, 0.9, kv=150.0, **turned, **known), p_vc)
    with pytest.raises(ValueError, match="a pipe is given without kv"):
        vena_contracta_pressure(5e5, 3e5, 0.9, **PIPES)
