# SPDX-License-Identifier: BSD-3-Clause
"""Constants of vapour-pressure formulas from points."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    WATER_ANTOINE,
    ValidityWarning,
    antoine,
    clausius_clapeyron,
    fit_antoine,
    fit_clausius_clapeyron,
    fluid_from,
    water_vapour_pressure,
)

TEMPERATURE = np.linspace(273.16, 423.15, 300)


def relative_error(formula, constants):
    return formula(TEMPERATURE, **constants) / water_vapour_pressure(TEMPERATURE) - 1.0


def test_best_line_of_water():
    # published for 0.01 to 150 degC: ln(p/Pa) = 25.2241 - 5116.44 / T, off by 8.0 %, 3.1 % rms
    constants = fit_clausius_clapeyron(TEMPERATURE, water_vapour_pressure(TEMPERATURE))
    slope = constants["enthalpy"] / 8.314462618
    assert_allclose(slope, 5116.44, rtol=1e-4)
    assert_allclose(np.log(constants["p_ref"]) + slope / constants["t_ref"], 25.2241, rtol=1e-5)
    error = relative_error(clausius_clapeyron, constants)
    assert_allclose(np.max(np.abs(error)), 0.080, atol=0.001)
    assert_allclose(np.sqrt(np.mean(error**2)), 0.031, atol=0.001)


def test_best_antoine_of_water():
    # published for 0.01 to 150 degC: ln(p/kPa) = 16.444863 - 3917.543 / (231.2298 + t),
    # off by 0.50 %, 0.16 % rms
    constants = fit_antoine(TEMPERATURE, water_vapour_pressure(TEMPERATURE))
    assert_allclose([constants[key] for key in "abc"], [16.444863, 3917.543, 231.2298], rtol=3e-4)
    error = relative_error(antoine, constants)
    assert_allclose(np.max(np.abs(error)), 0.0050, atol=2e-4)
    assert_allclose(np.sqrt(np.mean(error**2)), 0.0016, atol=1e-4)


@given(st.floats(20e3, 80e3), st.floats(250.0, 450.0), st.floats(1e2, 1e6), st.floats(200.0, 600.0))
@settings(max_examples=50, deadline=None)
def test_a_line_is_found_about_any_reference(enthalpy, t_ref, p_ref, other):
    truth = {"p_ref": p_ref, "t_ref": t_ref, "enthalpy": enthalpy}
    temperature = np.linspace(280.0, 400.0, 5)
    points = clausius_clapeyron(temperature, **truth)
    again = fit_clausius_clapeyron(temperature, points, t_ref=t_ref)
    assert_allclose([again[key] for key in truth], list(truth.values()), rtol=1e-9)
    elsewhere = fit_clausius_clapeyron(temperature, points, t_ref=other)
    assert elsewhere["t_ref"] == other
    assert_allclose(clausius_clapeyron(temperature, **elsewhere), points, rtol=1e-9)


@pytest.mark.parametrize("form", ["log10_mmHg", "ln_kPa"])
@pytest.mark.parametrize("n_points", [3, 40])
def test_an_antoine_curve_is_found_in_both_forms(form, n_points):
    temperature = np.linspace(280.0, 370.0, n_points)
    points = antoine(temperature, **WATER_ANTOINE)
    constants = fit_antoine(temperature, points, form=form)
    assert constants["form"] == form
    assert_allclose(antoine(temperature, **constants), points, rtol=1e-10)
    if form == "log10_mmHg":
        assert_allclose([constants[key] for key in "abc"], [WATER_ANTOINE[key] for key in "abc"], rtol=1e-7)


def test_a_fitted_curve_serves_a_fluid_and_keeps_quiet():
    constants = fit_antoine(TEMPERATURE, water_vapour_pressure(TEMPERATURE))
    brine = fluid_from("brine", density=1070.0, vapour_pressure=partial(antoine, **constants))
    assert_allclose(brine.vapour_pressure(353.15), water_vapour_pressure(353.15), rtol=6e-3)
    assert np.isnan(brine.vapour_pressure(10.0, warn=False))
    with pytest.warns(ValidityWarning, match="1 of 1 rows"):
        brine.vapour_pressure(10.0)


@pytest.mark.parametrize(
    ("fit", "temperature", "p_vapour", "message"),
    [
        (fit_clausius_clapeyron, [300.0, 310.0], [1e3], "two rows of the same length"),
        (fit_clausius_clapeyron, [300.0, 300.0], [1e3, 1e3], "at least 2 different temperatures .* got 1"),
        (fit_clausius_clapeyron, [300.0, -5.0], [1e3, 1e3], "every temperature of the points must be a pos"),
        (fit_clausius_clapeyron, [300.0, 310.0], [1e3, np.nan], "every p_vapour of the points must be a pos"),
        (fit_antoine, [300.0, 310.0], [1e3, 2e3], "at least 3 different temperatures .* got 2"),
        # pressures that rise ever faster on this scale have their pole above
        (fit_antoine, [300.0, 350.0, 400.0], [1e3, 1e4, 1e6], "no Antoine curve has its pole below"),
    ],
)
def test_points_that_will_not_do(fit, temperature, p_vapour, message):
    with pytest.raises(ValueError, match=message):
        fit(temperature, p_vapour)


def test_switches_that_will_not_do():
    with pytest.raises(ValueError, match="t_ref must be a positive temperature"):
        fit_clausius_clapeyron([300.0, 310.0], [1e3, 2e3], t_ref=0.0)
    with pytest.raises(ValueError, match="form must be 'log10_mmHg' or 'ln_kPa'; got 'bar'"):
        fit_antoine([300.0, 310.0, 320.0], [1e3, 2e3, 3e3], form="bar")
