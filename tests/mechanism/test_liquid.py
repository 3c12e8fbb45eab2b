# SPDX-License-Identifier: BSD-3-Clause
"""Liquid flow both ways: published cases, an outside oracle, round trips and the shape of the curves."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import (
    ValidityWarning,
    choked_pressure_drop,
    critical_pressure_ratio_factor,
    liquid_flow,
    liquid_inlet_pressure,
    liquid_kv,
    liquid_outlet_pressure,
)

HOUR = 3600.0
# worked examples 1 and 2 of IEC 60534-2-1 (water at about 90 degC), as quoted by fluids 1.3.1
HOT_WATER = {"density": 965.4, "p_vapour": 70.1e3, "p_critical": 22.12e6}
PSI = 6894.757293168


class TestPublished:
    def test_example_1_sizing(self):
        kv = liquid_kv(360 / HOUR, 680e3, 220e3, **HOT_WATER, fl=0.9)
        assert_allclose(kv, 165.0, rtol=1e-3)

    def test_example_1_flow(self):
        flow = liquid_flow(165.0, 680e3, 220e3, **HOT_WATER, fl=0.9)
        assert_allclose(flow * HOUR, 360.0, rtol=1e-3)

    def test_example_1_is_not_choked(self):
        drop = choked_pressure_drop(680e3, 70.1e3, 22.12e6, 0.9)
        assert_allclose(drop, 497e3, rtol=1e-3)
        assert drop > 460e3

    def test_example_2_sizing(self):
        assert_allclose(liquid_kv(360 / HOUR, 680e3, 220e3, **HOT_WATER, fl=0.6), 238.0, rtol=1e-3)

    def test_example_2_is_choked(self):
        assert_allclose(choked_pressure_drop(680e3, 70.1e3, 22.12e6, 0.6), 221e3, rtol=1e-3)

    def test_ff_of_hot_water(self):
        # fluids 1.3.1, documentation
        assert_allclose(critical_pressure_ratio_factor(70.1e3, 22.12e6), 0.9442375225233299, rtol=1e-12)

    def test_onset_of_choking(self):
        # fluids 1.3.1, its tests
        p2 = 680e3 - choked_pressure_drop(680e3, 69.68289291024722e3, 22048.32e3, 0.6)
        assert_allclose(p2, 458.8875306077305e3, rtol=1e-9)

    def test_onset_of_choking_crane(self):
        # Crane TP-410 example 7-28, without the piping factor
        p2 = 80.6 * PSI - choked_pressure_drop(80.6 * PSI, 4.75 * PSI, 3198.0 * PSI, 0.9)
        assert_allclose(p2 / PSI, 18.966, rtol=1e-4)

    def test_outlet_pressure(self):
        # closed form with reference numbers of its own
        p2 = liquid_outlet_pressure(300 / HOUR, 165.0, 680e3, **HOT_WATER, fl=0.9)
        assert_allclose(p2, 360.572850208008e3, rtol=1e-6)

    def test_by_hand(self):
        # 25 / sqrt(2 bar)
        assert_allclose(liquid_kv(25 / HOUR, 6e5, 4e5, 999.1026), 17.678, rtol=1e-4)


class TestAgainstFluids:
    @pytest.fixture(scope="class")
    def size(self):
        return pytest.importorskip("fluids.control_valve").size_control_valve_l

    def test_sizing_over_random_duties(self, size):
        rng = np.random.default_rng(0)
        n = 500
        p1 = rng.uniform(2e5, 3e6, n)
        p2 = p1 * rng.uniform(0.02, 0.98, n)
        density = rng.uniform(600.0, 1200.0, n)
        p_vapour = p1 * rng.uniform(0.0, 0.7, n)
        fl = rng.uniform(0.4, 0.98, n)
        flow = 10.0 ** rng.uniform(-4, 0, n)
        theirs = [
            size(
                rho=density[i], Psat=p_vapour[i], Pc=22.064e6, mu=1e-3, P1=p1[i], P2=p2[i], Q=flow[i],
                FL=fl[i], allow_laminar=False,
            )
            for i in range(n)
        ]  # fmt: skip
        ours = liquid_kv(flow, p1, p2, density, fl=fl, p_vapour=p_vapour)
        choked = p1 - p2 >= choked_pressure_drop(p1, p_vapour, 22.064e6, fl)
        assert 50 < choked.sum() < 450
        assert_allclose(ours, theirs, rtol=1e-6)

    def test_without_choking(self, size):
        theirs = size(
            rho=870.0, Psat=1e3, Pc=22e6, mu=1e-3, P1=9e5, P2=1e5, Q=0.01, FL=0.9,
            allow_choked=False, allow_laminar=False,
        )  # fmt: skip
        assert_allclose(liquid_kv(0.01, 9e5, 1e5, 870.0), theirs, rtol=1e-6)


# duties of a real plant: no drop so small that the subtraction p1 - p2 itself loses nine digits
duties = st.fixed_dictionaries(
    {
        "kv": st.floats(0.01, 2000.0),
        "p1": st.floats(2e5, 1e7),
        "drop": st.floats(0.01, 0.99),
        "density": st.floats(500.0, 1500.0),
        "fl": st.floats(0.3, 1.0),
        "vapour": st.floats(0.0, 0.9),
    }
)


def as_arguments(duty):
    known = {"density": duty["density"], "fl": duty["fl"], "p_vapour": duty["vapour"] * duty["p1"]}
    return duty["kv"], duty["p1"], duty["p1"] * (1.0 - duty["drop"]), known


class TestRoundTrips:
    @given(duties)
    @settings(max_examples=50, deadline=None)
    def test_kv(self, duty):
        kv, p1, p2, known = as_arguments(duty)
        assert_allclose(liquid_kv(liquid_flow(kv, p1, p2, **known), p1, p2, **known), kv, rtol=1e-9)

    @given(duties)
    @settings(max_examples=50, deadline=None)
    def test_outlet_pressure(self, duty):
        kv, p1, p2, known = as_arguments(duty)
        limit = choked_pressure_drop(p1, known["p_vapour"], 22.064e6, known["fl"])
        again, feasible = liquid_outlet_pressure(
            liquid_flow(kv, p1, p2, **known), kv, p1, **known, return_feasible=True, warn=False
        )
        if p1 - p2 < limit * (1.0 - 1e-9):
            assert feasible
            assert_allclose(again, p2, rtol=1e-9, atol=1e-9 * p1)
        elif p1 - p2 > limit * (1.0 + 1e-9):
            assert not feasible
            assert np.isnan(again)

    @given(duties)
    @settings(max_examples=50, deadline=None)
    def test_inlet_pressure(self, duty):
        kv, p1, p2, known = as_arguments(duty)
        flow = liquid_flow(kv, p1, p2, **known)
        assert_allclose(liquid_inlet_pressure(flow, kv, p2, **known), p1, rtol=1e-9)

    def test_reversed_outlet_pressure(self):
        # the valve passes a flow backwards, choked and not: p2 is then the pressure before it
        known = {"density": 965.4, "fl": 0.6, "p_vapour": 70.1e3}
        p2 = np.array([300e3, 680e3])
        flow = liquid_flow(100.0, 220e3, p2, **known)
        assert np.all(flow < 0.0)
        assert_allclose(liquid_outlet_pressure(flow, 100.0, 220e3, **known), p2, rtol=1e-12)

    def test_without_choking(self):
        flow = liquid_flow(20.0, 5e5, 1e5, 900.0)
        assert_allclose(liquid_outlet_pressure(flow, 20.0, 5e5, 900.0), 1e5, rtol=1e-12)
        assert_allclose(liquid_inlet_pressure(flow, 20.0, 1e5, 900.0), 5e5, rtol=1e-12)


class TestShape:
    @given(duties, st.floats(1.0001, 10.0))
    @settings(max_examples=50, deadline=None)
    def test_rises_with_kv(self, duty, factor):
        kv, p1, p2, known = as_arguments(duty)
        low, high = liquid_flow([kv, kv * factor], p1, p2, **known)
        assert high > low > 0.0

    @given(duties)
    @settings(max_examples=50, deadline=None)
    def test_never_falls_with_the_drop_and_is_constant_once_choked(self, duty):
        kv, p1, _, known = as_arguments(duty)
        p2 = p1 * np.linspace(1.0, 0.0, 101)
        flow = liquid_flow(kv, p1, p2, **known)
        choked = p1 - p2 >= choked_pressure_drop(p1, known["p_vapour"], 22.064e6, known["fl"])
        assert np.all(np.diff(flow) >= 0.0)
        assert np.all(np.diff(flow[~choked]) > 0.0)
        assert np.unique(flow[choked]).size <= 1

    @given(duties)
    @settings(max_examples=50, deadline=None)
    def test_odd_in_the_drop(self, duty):
        kv, p1, p2, known = as_arguments(duty)
        assert liquid_flow(kv, p2, p1, **known) == -liquid_flow(kv, p1, p2, **known)

    def test_zero_drop(self):
        assert liquid_flow(10.0, 3e5, 3e5, 1000.0) == 0.0

    def test_choking_only_takes_away(self):
        p2 = np.linspace(1e4, 9e5, 50)
        free = liquid_flow(10.0, 1e6, p2, 958.0)
        choked = liquid_flow(10.0, 1e6, p2, 958.0, fl=0.7, p_vapour=1e5)
        assert np.all(choked <= free)
        assert np.any(choked < 0.9 * free)

    def test_scalars_arrays_and_broadcasting(self):
        kv, p1 = np.array([1.0, 2.0]), np.array([[3e5], [4e5], [5e5]])
        many = liquid_flow(kv, p1, 1e5, 1000.0, fl=0.9, p_vapour=2e3)
        assert many.shape == (3, 2)
        one = liquid_flow(2.0, 4e5, 1e5, 1000.0, fl=0.9, p_vapour=2e3)
        assert np.ndim(one) == 0
        assert many[1, 1] == one

    def test_float32_is_computed_in_double(self):
        flow = liquid_flow(np.float32(2.0), np.float32(4e5), np.float32(1e5), np.float32(1000.0))
        assert flow.dtype == np.float64
        assert flow == liquid_flow(2.0, 4e5, 1e5, 1000.0)


class TestOutsideValidity:
    def test_nan_in_nan_out_without_a_word(self):
        flow = liquid_flow([1.0, np.nan], [3e5, 3e5], [1e5, 1e5], 1000.0, fl=0.9, p_vapour=2e3)
        assert_array_equal(np.isnan(flow), [False, True])
        assert np.isnan(liquid_outlet_pressure(np.nan, 1.0, 3e5, 1000.0))
        assert np.isnan(liquid_inlet_pressure(1e-3, 1.0, np.nan, 1000.0))

    def test_boiling_before_the_valve(self):
        with pytest.warns(ValidityWarning, match="2 of 3 rows have liquid at or below its vapour pressure"):
            flow = liquid_flow(1.0, [1.2e5, 0.99e5, 0.5e5], 0.4e5, 958.0, fl=0.9, p_vapour=1e5)
        assert_array_equal(np.isnan(flow), [False, False, True])

    def test_negative_kv_continues_linearly(self):
        with pytest.warns(ValidityWarning, match="1 of 2 rows have a negative kv"):
            flow = liquid_flow([1.0, -1.0], 3e5, 1e5, 1000.0)
        assert flow[1] == -flow[0]

    @pytest.mark.parametrize("density", [0.0, -5.0])
    def test_no_density(self, density):
        with pytest.warns(ValidityWarning, match="density that is not positive"):
            assert np.isnan(liquid_flow(1.0, 3e5, 1e5, density))

    def test_sizing_without_drop(self):
        with pytest.warns(ValidityWarning, match="1 of 2 rows have no pressure drop"):
            kv = liquid_kv(1e-3, 3e5, [3e5, 1e5], 1000.0)
        assert_array_equal(np.isnan(kv), [True, False])

    def test_sizing_against_the_drop(self):
        with pytest.warns(ValidityWarning, match="flow against the pressure drop"):
            kv = liquid_kv(-1e-3, 3e5, 1e5, 1000.0)
        assert_allclose(liquid_flow(kv, 3e5, 1e5, 1000.0, warn=False), -1e-3, rtol=1e-12)

    def test_infeasible_outlet_pressure(self):
        most = liquid_flow(10.0, 6e5, 1e4, 965.4, fl=0.8, p_vapour=70e3)
        with pytest.warns(ValidityWarning, match="2 of 3 rows ask for a flow that the valve cannot pass"):
            p2, feasible = liquid_outlet_pressure(
                most * np.array([0.9, 1.0, 1.1]),
                10.0,
                6e5,
                965.4,
                fl=0.8,
                p_vapour=70e3,
                return_feasible=True,
            )
        assert_array_equal(feasible, [True, False, False])
        assert_array_equal(np.isnan(p2), ~feasible)

    def test_shut_valve_has_no_outlet_pressure(self):
        with pytest.warns(ValidityWarning, match="2 of 2 rows"):
            p2 = liquid_outlet_pressure([0.0, 1e-3], 0.0, 6e5, 1000.0)
        assert np.all(np.isnan(p2))

    def test_shut_valve_has_no_inlet_pressure(self):
        with pytest.warns(ValidityWarning, match="1 of 1 rows"):
            assert np.isnan(liquid_inlet_pressure(1e-3, 0.0, 1e5, 1000.0))

    def test_vacuum_is_said(self):
        with pytest.warns(ValidityWarning, match="fall below zero absolute"):
            assert liquid_outlet_pressure(1.0, 10.0, 2e5, 1000.0) < 0.0

    def test_warn_false_is_quiet(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            liquid_flow([-1.0, 1.0], [0.5e5, 3e5], 0.4e5, [958.0, -1.0], fl=0.9, p_vapour=1e5, warn=False)
            liquid_kv([1e-3, -1e-3], [3e5, 3e5], [3e5, 1e5], 0.0, fl=0.9, p_vapour=4e5, warn=False)
            liquid_outlet_pressure(1.0, [0.0, 1.0], 2e5, 1000.0, warn=False)
            liquid_inlet_pressure(1.0, [0.0, 1.0], 2e5, 1000.0, warn=False)

    @pytest.mark.parametrize("p_vapour", [-1.0, 23e6])
    def test_ff_without_liquid(self, p_vapour):
        assert np.isnan(critical_pressure_ratio_factor(p_vapour))

    def test_fl_needs_a_vapour_pressure(self):
        with pytest.raises(ValueError, match="fl is given but p_vapour is not"):
            liquid_flow(1.0, 3e5, 1e5, 1000.0, fl=0.9)
