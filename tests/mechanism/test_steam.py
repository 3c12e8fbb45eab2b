# SPDX-License-Identifier: BSD-3-Clause
"""Saturated steam and the boiling point: printed check values, an outside oracle, the border."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import (
    STEAM_MOLAR_MASS,
    ValidityWarning,
    steam_density,
    steam_kinematic_viscosity,
    water_saturation_temperature,
    water_vapour_pressure,
)
from sklvalve.mechanism.steam import _dynamic_viscosity


@pytest.mark.parametrize(
    ("temperature", "density"), [(273.16, 0.00485426), (373.1243, 0.597586), (647.096, 322.0)]
)
def test_density_check_values(temperature, density):
    # printed in IAPWS SR1-86
    assert_allclose(steam_density(temperature), density, rtol=1e-6)


@pytest.mark.parametrize(
    ("temperature", "density", "viscosity"),
    [
        (298.15, 998.0, 889.735100),
        (373.15, 1000.0, 307.883622),
        (873.15, 1.0, 32.619287),
        (1173.15, 400.0, 64.154608),
    ],
)
def test_viscosity_check_values(temperature, density, viscosity):
    # printed in IAPWS R12-08, uPa s
    assert_allclose(_dynamic_viscosity(temperature, density) * 1e6, viscosity, rtol=1e-7)


def test_against_coolprop():
    properties = pytest.importorskip("CoolProp.CoolProp").PropsSI
    temperature = np.linspace(273.16, 640.0, 80)
    theirs = {what: properties(what, "T", temperature, "Q", 1, "Water") for what in "DV"}
    assert_allclose(steam_density(temperature), theirs["D"], rtol=1e-3)
    assert_allclose(steam_kinematic_viscosity(temperature), theirs["V"] / theirs["D"], rtol=2e-3)
    upto200 = temperature < 473.15
    assert_allclose(steam_density(temperature)[upto200], theirs["D"][upto200], rtol=2e-4)


def test_thin_steam_is_an_ideal_gas():
    ideal = water_vapour_pressure(280.0) * STEAM_MOLAR_MASS / (8.314462618 * 280.0)
    assert_allclose(steam_density(280.0), ideal, rtol=2e-3)


def test_boiling_point_of_100_000():
    temperature = np.random.default_rng(22).uniform(273.15, 647.096, 100_000)
    again = water_saturation_temperature(water_vapour_pressure(temperature))
    assert_allclose(again, temperature, rtol=1e-12)
    ends = np.array([273.15, 647.096])
    assert_allclose(water_saturation_temperature(water_vapour_pressure(ends)), ends, rtol=1e-14)


def test_pressure_that_does_not_boil():
    with pytest.warns(ValidityWarning, match="3 of 5 rows have a pressure outside 611 to 22064000 Pa"):
        temperature = water_saturation_temperature([0.0, -1.0, 1e5, 3e7, np.nan])
    assert_array_equal(np.isnan(temperature), [True, True, False, True, True])


@pytest.mark.parametrize("formula", [steam_density, steam_kinematic_viscosity])
def test_outside_steam(formula):
    with pytest.warns(ValidityWarning, match=f"{formula.__name__}: 2 of 4 rows have a temperature outside"):
        values = formula([20.0, 400.0, 700.0, np.nan])
    assert_array_equal(np.isnan(values)[1:], [False, True, True])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        formula([-1.0, 0.0, 20.0, 700.0], warn=False)
        water_saturation_temperature([0.0, 1e9], warn=False)


def test_scalars_stay_scalars():
    for formula in (steam_density, steam_kinematic_viscosity, water_saturation_temperature):
        assert np.ndim(formula(640.0)) == 0
