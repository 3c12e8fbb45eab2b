# SPDX-License-Identifier: BSD-3-Clause
"""Fluids by temperature: stored reference values, an outside oracle where it is there, and the border."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    WATER_ANTOINE,
    WATER_CLAUSIUS_CLAPEYRON,
    Fluid,
    ValidityWarning,
    antoine,
    clausius_clapeyron,
    fluid_from,
    water_density,
    water_kinematic_viscosity,
    water_vapour_pressure,
)

# IAPWS-95 by CoolProp 8.0.0: temperature [K], vapour pressure [Pa]
VAPOUR = [(273.16, 611.655), (293.15, 2339.32), (323.15, 12351.95), (373.15, 101418.0)]
# the check values that IAPWS SR1-86 prints: temperature [K], pressure [Pa], density [kg/m3]
PRINTED = [(273.16, 611.657, 999.789), (373.1243, 0.101325e6, 958.365), (647.096, 22.064e6, 322.0)]


@pytest.mark.parametrize(("temperature", "p_vapour"), VAPOUR)
def test_vapour_pressure_of_water(temperature, p_vapour):
    assert_allclose(water_vapour_pressure(temperature), p_vapour, rtol=3e-4)
    assert_allclose(antoine(temperature, **WATER_ANTOINE), p_vapour, rtol=1.3e-2)
    assert_allclose(clausius_clapeyron(temperature, **WATER_CLAUSIUS_CLAPEYRON), p_vapour, rtol=0.14)


@pytest.mark.parametrize(("temperature", "p_vapour", "density"), PRINTED)
def test_printed_check_values(temperature, p_vapour, density):
    assert_allclose(water_vapour_pressure(temperature), p_vapour, rtol=1e-6)
    assert_allclose(water_density(temperature), density, rtol=1e-6)


def test_viscosity_check_value():
    # IAPWS SR6-08 prints 889.996 uPa s at 298.15 K
    assert_allclose(water_kinematic_viscosity(298.15) * water_density(298.15), 889.996e-6, rtol=1e-6)


def test_water_against_coolprop():
    properties = pytest.importorskip("CoolProp.CoolProp").PropsSI
    temperature = np.linspace(273.16, 423.15, 60)
    theirs = {what: properties(what, "T", temperature, "Q", 0, "Water") for what in "PDV"}
    assert_allclose(water_vapour_pressure(temperature), theirs["P"], rtol=1e-4)
    assert_allclose(water_density(temperature), theirs["D"], rtol=1e-5)
    assert_allclose(water_kinematic_viscosity(temperature), theirs["V"] / theirs["D"], rtol=2e-3)


def test_antoine_in_the_other_form():
    # refitted constants for kPa and the natural logarithm
    p_vapour = antoine(323.15, a=16.444863, b=3917.543, c=231.2298, form="ln_kPa")
    assert_allclose(p_vapour, 12351.95, rtol=5e-3)


def test_clausius_clapeyron_has_the_slope_of_equation_3():
    step = 1e-3
    low, high = np.log(clausius_clapeyron([350.0 - step, 350.0 + step], **WATER_CLAUSIUS_CLAPEYRON))
    assert_allclose((high - low) / (2 * step), 42911.0 / (8.314462618 * 350.0**2), rtol=1e-6)


def test_papers_gas_constant_is_wrong():
    # with 287 J/(kg K) and 2257 kJ/kg from 100 degC the vapour pressure at 150 degC comes out 157 % high
    wrong = 101325.0 * np.exp(-2.257e6 / 287.0 * (1 / 423.15 - 1 / 373.15))
    assert wrong / water_vapour_pressure(423.15) > 2.5
    right = clausius_clapeyron(423.15, p_ref=101325.0, t_ref=373.15, enthalpy=2.257e6 * 0.018015)
    assert_allclose(right, water_vapour_pressure(423.15), rtol=0.07)


@pytest.mark.parametrize("formula", [water_vapour_pressure, water_density, water_kinematic_viscosity])
def test_outside_water(formula):
    with pytest.warns(ValidityWarning, match="2 of 4 rows have a temperature outside"):
        values = formula([20.0, 300.0, 700.0, np.nan])
    assert np.isfinite(values[1])
    assert np.isnan(values[2])
    assert np.isnan(values[3])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        formula([-1.0, 0.0, 20.0, 700.0], warn=False)


def test_antoine_pole():
    with pytest.warns(ValidityWarning, match="1 of 2 rows"):
        assert np.isnan(antoine([10.0, 300.0], **WATER_ANTOINE)[0])
    with pytest.raises(ValueError, match="form must be 'log10_mmHg' or 'ln_kPa'; got 'bar'"):
        antoine(300.0, a=1.0, b=1.0, c=1.0, form="bar")


def test_absolute_zero_is_nan():
    with pytest.warns(ValidityWarning, match="2 of 4 rows have a temperature at or below 0 K"):
        p_vapour = clausius_clapeyron([0.0, -1.0, 300.0, np.nan], **WATER_CLAUSIUS_CLAPEYRON)
    assert np.isnan(p_vapour).tolist() == [True, True, False, True]


class TestFluidFrom:
    def test_water_at_no_temperature_is_at_20_degrees(self):
        water = fluid_from()
        assert water.density() == water_density(293.15)
        assert water.vapour_pressure() == water_vapour_pressure(293.15)
        assert water.kinematic_viscosity() == water_kinematic_viscosity(293.15)
        assert water.critical_pressure == 22.064e6

    def test_numbers_replace_formulas(self):
        juice = fluid_from("water", density=1060.0)
        assert_allclose(juice.density([300.0, 350.0]), [1060.0, 1060.0])
        assert juice.vapour_pressure(350.0) == water_vapour_pressure(350.0)

    def test_the_users_function(self):
        oil = fluid_from("oil", density=lambda temperature: 900.0 - 0.6 * (np.asarray(temperature) - 293.15))
        assert_allclose(oil.density([293.15, 303.15]), [900.0, 894.0])
        assert oil.density() == 900.0

    def test_what_is_not_given_is_said(self):
        oil = fluid_from("oil", density=870.0)
        assert oil.knows("density")
        assert not oil.knows("vapour_pressure")
        assert not oil.knows("critical_pressure")
        with pytest.raises(ValueError, match="the fluid 'oil' has no vapour_pressure: give vapour_pressure="):
            oil.vapour_pressure(300.0)

    def test_a_fluid_can_be_amended(self):
        oil = fluid_from(Fluid("oil", {"density": 870.0}), vapour_pressure=10.0, critical_pressure=2e6)
        assert (oil.density(), oil.vapour_pressure(), oil.critical_pressure) == (870.0, 10.0, 2e6)

    def test_unknown_fluid(self):
        with pytest.raises(
            ValueError, match=r"unknown fluid 'mead': use 'water', .* or give at least its density"
        ):
            fluid_from("mead")

    @pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf, "heavy", [1.0]])
    def test_no_number(self, value):
        with pytest.raises(ValueError, match="density must be a positive number"):
            fluid_from("oil", density=value)

    def test_quiet_where_asked(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            fluid_from().density([20.0], warn=False)
            fluid_from("oil", density=lambda temperature: 870.0).density([20.0], warn=False)
