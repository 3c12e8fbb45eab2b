# SPDX-License-Identifier: BSD-3-Clause
"""Reynolds factor and what follows: against other code, its own equation and the letter of the standard."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.special import lambertw

from sklvalve.mechanism import (
    ValidityWarning,
    liquid_kv,
    nonturbulent_flow_ratio,
    nonturbulent_kv,
    reynolds_factor,
    trim_parameter,
    valve_reynolds_number,
)

N = 2000
rng = np.random.default_rng(0)
SIZE = rng.uniform(0.015, 0.4, N)
KV = 10.0 ** rng.uniform(-4.0, np.log10(0.04), N) * (1e3 * SIZE) ** 2
FL = rng.uniform(0.3, 1.0, N)
REYNOLDS = 10.0 ** rng.uniform(-3.0, 7.0, N)
TRIM = trim_parameter(KV, SIZE)


class TestAgainstFluids:
    @pytest.fixture(scope="class")
    def theirs(self):
        return pytest.importorskip("fluids.control_valve")

    def test_valve_reynolds_number(self, theirs):
        flow, viscosity, fd = rng.uniform(1e-4, 1.0, N), 10.0 ** rng.uniform(-7, 0, N), rng.uniform(0.1, 1, N)
        expected = [
            theirs.Reynolds_valve(nu=nu, Q=q * 3600.0, D1=1e3 * size, FL=fl, Fd=d, C=kv)
            for nu, q, size, fl, d, kv in zip(viscosity, flow, SIZE, FL, fd, KV, strict=True)
        ]
        ours = valve_reynolds_number(flow, KV, viscosity, fl=FL, fd=fd, inlet_pipe=SIZE)
        assert_allclose(ours, expected, rtol=1e-12)

    def test_the_letter_of_the_standard(self, theirs):
        # given the kind of trim; it forgets the limits of 1 for full-size trim and for turbulent flow
        full = KV / (1e3 * SIZE) ** 2 >= 0.016 * 0.865
        assert 100 < full.sum() < N - 100
        expected = [
            theirs.Reynolds_factor(FL=fl, C=kv, d=1e3 * size, Rev=re, full_trim=kind)
            for fl, kv, size, re, kind in zip(FL, KV, SIZE, REYNOLDS, full.tolist(), strict=True)
        ]
        assert_allclose(
            reynolds_factor(REYNOLDS, TRIM, FL, strict=True), np.minimum(expected, 1.0), rtol=1e-12
        )


class TestFactor:
    def test_default_is_the_letter_where_that_does_not_jump(self):
        smooth, letter = (reynolds_factor(REYNOLDS, TRIM, FL, strict=strict) for strict in (False, True))
        just_above = reynolds_factor(10.0, TRIM, FL, strict=True)
        jumps = just_above < reynolds_factor(10.0 * (1.0 - 1e-12), TRIM, FL, strict=True) * (1.0 - 1e-9)
        assert 20 < jumps.sum() < N - 100
        assert_allclose(smooth[~jumps], letter[~jumps], rtol=1e-12)
        outside = (REYNOLDS < 10.0) | (REYNOLDS >= 1e4)
        assert_allclose(smooth[outside], letter[outside], rtol=1e-12)
        assert np.all(smooth >= letter * (1.0 - 1e-12))

    @pytest.mark.parametrize("fl", [0.3, 0.6, 0.98])
    @pytest.mark.parametrize("trim", [1.0, 1.2, 3.0, 9.0, 100.0])
    def test_rises_without_jumps_and_slower_than_the_flow(self, trim, fl):
        reynolds = np.geomspace(1e-4, 1e6, 20_001)
        factor = reynolds_factor(reynolds, trim, fl)
        rise = np.diff(np.log(factor)) / np.diff(np.log(reynolds))
        assert np.all(rise >= 0.0)
        assert np.all(rise <= 0.5 + 1e-9)
        assert factor[-1] == 1.0
        assert np.all(reynolds_factor(np.geomspace(1e4, 1e6), trim, fl) == 1.0)

    def test_jumps_by_the_letter(self):
        # n = 1, F_L = 0.98: from 0.084 down to 0.02 at a Reynolds number of 10
        below, at = reynolds_factor([10.0 - 1e-9, 10.0], 1.0, 0.98, strict=True)
        assert_allclose([below, at], [0.0839, 0.0199], rtol=3e-3)
        assert_allclose(*reynolds_factor([10.0 - 1e-9, 10.0], 1.0, 0.98), rtol=1e-9)

    def test_ends(self):
        assert reynolds_factor(0.0, 1.2, 0.9) == 0.0
        assert reynolds_factor(np.inf, 1.2, 0.9) == 1.0
        assert_array_equal(np.isnan(reynolds_factor([np.nan, -1.0, 1.0], 1.2, 0.9)), [True, True, False])
        assert np.isnan(reynolds_factor(np.nan, 1.2, 0.9, strict=True))
        assert isinstance(reynolds_factor(100.0, 1.2, 0.9), float)


class TestRatio:
    @pytest.mark.parametrize("strict", [False, True])
    def test_solves_its_equation(self, strict):
        n = 100_000
        many = np.random.default_rng(1)
        trim, fl = 10.0 ** many.uniform(-0.5, 3.0, n), many.uniform(0.2, 1.0, n)
        reynolds = 10.0 ** many.uniform(-4.0, 8.0, n)
        ratio = nonturbulent_flow_ratio(reynolds, trim, fl, strict=strict)
        known = np.isfinite(ratio)
        assert np.mean(known) > (0.98 if strict else 1.0 - 1e-12)
        assert_allclose(
            reynolds_factor(reynolds * ratio, trim, fl, strict=strict)[known], ratio[known], rtol=1e-12
        )

    def test_transitional_is_lambert_w(self):
        trim, fl = 3.0, 0.8
        reynolds = np.geomspace(2e3, 9e3, 50)
        slope = 0.33 * np.sqrt(fl) * trim**-0.25 / np.log(10.0)
        c = 1.0 + slope * np.log(reynolds / 1e4)
        expected = -slope * lambertw(-np.exp(-c / slope) / slope, -1).real
        assert_allclose(nonturbulent_flow_ratio(reynolds, trim, fl), expected, rtol=1e-12)

    def test_does_not_overflow(self):
        ratio = nonturbulent_flow_ratio([0.0, 1e-300, 1e300, np.inf], 1e8, 0.9)
        assert_array_equal(ratio[[0, 2, 3]], [0.0, 1.0, 1.0])
        assert 0.0 < ratio[1] < 1e-290
        assert np.isnan(nonturbulent_flow_ratio(np.nan, 1.2, 0.9))

    @given(st.floats(1.0, 9.1), st.floats(0.2, 1.0))
    @settings(max_examples=50, deadline=None)
    def test_flow_rises_between_linear_and_square(self, trim, fl):
        reynolds = np.geomspace(1e-4, 1e6, 2001)
        rise = np.diff(np.log(nonturbulent_flow_ratio(reynolds, trim, fl))) / np.diff(np.log(reynolds))
        assert np.all(rise >= -1e-9)
        assert np.all(rise <= 1.0 + 1e-9)


class TestTrim:
    def test_kind_by_the_rated_capacity(self):
        size = 0.1
        flip = 0.016 * 0.865 * 1e4
        at, below = trim_parameter([flip, np.nextafter(flip, 0.0)], size)
        assert_allclose(at, 1.60e-3 / (flip / 1e4) ** 2, rtol=1e-12)
        assert_allclose(below, 1.0 + 140.0 * (flip / 1e4) ** (2 / 3), rtol=1e-12)
        kv = np.linspace(1.0, 300.0, 20)
        assert np.ptp(trim_parameter(kv, size, kv_rated=300.0)) == 0.0
        letter = trim_parameter(kv, size, kv_rated=300.0, strict=True)
        assert_allclose(letter, 1.60e-3 / (kv / 1e4) ** 2, rtol=1e-12)


class TestPaperEquation7:
    def test_is_sizing_with_the_factor_that_sizing_finds(self):
        known = {"fl": 0.9, "fd": 0.46, "viscosity": 2e-3, "nominal_size": 0.15, "kv_rated": 120.0}
        kv = liquid_kv(103.2 / 3600.0, 680e3, 500e3, 965.4, **known)
        reynolds = valve_reynolds_number(103.2 / 3600.0, kv, 2e-3, fl=0.9, fd=0.46, inlet_pipe=0.15)
        fr = reynolds_factor(reynolds, trim_parameter(120.0, 0.15), 0.9)
        assert_allclose(nonturbulent_kv(103.2 / 3600.0, 680e3, 500e3, 965.4, fr), kv, rtol=1e-12)
        assert_allclose(kv, 120.0, rtol=1e-3)

    def test_the_limit_of_the_paper_would_jump(self):
        # "non-turbulent below 1000": the factor is far from 1 there
        factors = reynolds_factor(1000.0, [1.2, 4.0, 8.0], 0.9)
        assert_allclose(factors, [0.70, 0.78, 0.81], atol=0.006)

    def test_no_answer(self):
        with pytest.warns(ValidityWarning, match="nonturbulent_kv: 3 of 5 rows"):
            kv = nonturbulent_kv([0.1, 0.1, -0.1, 0.1, np.nan], [5e5, 3e5, 5e5, 5e5, 5e5], 3e5, 900.0,
                                 [0.5, 0.5, 0.5, 0.0, 0.5])  # fmt: skip
        assert_array_equal(np.isnan(kv), [False, True, True, True, True])
        assert nonturbulent_kv(-0.1, 3e5, 5e5, 900.0, 0.5) == kv[0]


def test_reynolds_number_without_an_answer():
    known = {"fl": 0.9, "fd": 0.4, "inlet_pipe": 0.1}
    reynolds = valve_reynolds_number(0.01, [10.0, 0.0, 10.0], [1e-6, 1e-6, 0.0], **known)
    assert_array_equal(np.isnan(reynolds), [False, True, True])
    assert valve_reynolds_number(-0.01, 10.0, 1e-6, **known) == reynolds[0]
    # a reducer slows the approach, and with it the Reynolds number by little
    wide = valve_reynolds_number(0.01, 10.0, 1e-6, **(known | {"inlet_pipe": 0.2}))
    assert 0.99 * reynolds[0] < wide < reynolds[0]


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize("rated", [np.nan, 0.0, -5.0])
def test_a_trim_of_unknown_rated_capacity_has_no_number(rated, strict):
    assert np.isnan(trim_parameter(1.0, 0.05, kv_rated=rated, strict=strict))
