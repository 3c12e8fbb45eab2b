# SPDX-License-Identifier: BSD-3-Clause
"""The paper's orifice form, and that it is the same valve as the standard's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import (
    ValidityWarning,
    area_from_kv,
    estimate_fl,
    liquid_flow,
    orifice_area,
    orifice_flow,
    vena_contracta_pressure,
)

positive_drops = st.tuples(st.floats(2e5, 5e6), st.floats(0.01, 0.9)).map(
    lambda d: (d[0], d[0] * (1.0 - d[1]))
)


def test_equation_1_by_hand():
    # sqrt(2 * 2e5 / 1000) = 20 m/s; 0.6 * 0.001 m2 / sqrt(1 - 0.5**4)
    flow = orifice_flow(1e-3, 3e5, 1e5, 1000.0, velocity_coef=0.6, beta=0.5)
    assert_allclose(flow, 0.6 * 1e-3 * 20.0 / np.sqrt(1.0 - 0.0625), rtol=1e-14)


def test_identity_of_area_and_capacity():
    # 19.633 mm2 for each F_L Kv
    assert_allclose(area_from_kv(1.0, 1.0), 19.633e-6, rtol=1e-4)


def test_vena_contracta_of_example_1():
    # IEC 60534-2-1 worked example 1
    p_vc = vena_contracta_pressure(680e3, 220e3, 0.9, p_vapour=70.1e3, p_critical=22.12e6)
    assert_allclose(p_vc, 112.09876543209884e3, rtol=1e-9)


def test_vena_contracta_from_a_flow():
    # reference numbers for 300 m3/h through the same valve
    p_vc = vena_contracta_pressure(680e3, 360.572850208008e3, 0.9)
    assert_allclose(p_vc, 285.6454940839605e3, rtol=1e-6)


@given(
    st.floats(0.1, 500.0), st.floats(0.3, 1.0), positive_drops, st.floats(500.0, 1500.0), st.floats(0.0, 0.6)
)
@settings(max_examples=50, deadline=None)
def test_same_flow_as_the_standard(kv, fl, pressures, density, vapour):
    p1, p2 = pressures
    p_vapour = vapour * p1
    p_vc = vena_contracta_pressure(p1, p2, fl, p_vapour=p_vapour)
    for pipe_area in (None, 10.0 * area_from_kv(kv, fl)):
        area = area_from_kv(kv, fl, pipe_area=pipe_area)
        ours = orifice_flow(area, p1, p_vc, density, pipe_area=pipe_area)
        assert_allclose(ours, liquid_flow(kv, p1, p2, density, fl=fl, p_vapour=p_vapour), rtol=1e-9)


@given(st.floats(1e-6, 1e-2), positive_drops, st.floats(0.3, 1.0), st.floats(1.2, 100.0))
@settings(max_examples=50, deadline=None)
def test_round_trip(area, pressures, velocity_coef, wider):
    p1, p_vc = pressures
    for pipe in ({}, {"beta": 0.7}, {"pipe_area": wider * area}):
        coefs = {"velocity_coef": velocity_coef, **pipe}
        flow = orifice_flow(area, p1, p_vc, 900.0, **coefs)
        assert_allclose(orifice_area(flow, p1, p_vc, 900.0, **coefs), area, rtol=1e-9)


@given(positive_drops, st.floats(0.3, 1.0))
@settings(max_examples=50, deadline=None)
def test_fl_comes_back(pressures, fl):
    p1, p2 = pressures
    assert_allclose(estimate_fl(p1, p2, vena_contracta_pressure(p1, p2, fl, warn=False)), fl, rtol=1e-9)


def test_vena_contracta_floor_is_the_boiling_pressure():
    p_vc = vena_contracta_pressure(6e5, np.linspace(6e5, 0.0, 50), 0.7, p_vapour=1e5)
    assert np.all(np.diff(p_vc) <= 0.0)
    assert_allclose(p_vc[-1], (0.96 - 0.28 * np.sqrt(1e5 / 22.064e6)) * 1e5, rtol=1e-12)


def test_outside_validity():
    with pytest.warns(ValidityWarning, match="1 of 3 rows have p_vc above p1"):
        flow = orifice_flow(1e-3, [3e5, 3e5, np.nan], [1e5, 4e5, 1e5], 1000.0)
    assert_array_equal(np.isnan(flow), [False, True, True])
    with pytest.warns(ValidityWarning, match="2 of 3 rows have no pressure drop"):
        area = orifice_area(1e-3, 3e5, [1e5, 3e5, 4e5], 1000.0)
    assert_array_equal(np.isnan(area), [False, True, True])
    assert np.isnan(orifice_flow(1e-3, 3e5, 1e5, 1000.0, pipe_area=0.5e-3))
    assert np.isnan(estimate_fl(3e5, 1e5, 3e5))
    assert np.isnan(estimate_fl(3e5, 4e5, 2e5))


@pytest.mark.parametrize("function", [orifice_flow, orifice_area])
def test_beta_and_pipe_area_are_one_datum(function):
    with pytest.raises(ValueError, match="give beta or pipe_area, not both"):
        function(1e-3, 3e5, 1e5, 1000.0, beta=0.5, pipe_area=1e-2)
