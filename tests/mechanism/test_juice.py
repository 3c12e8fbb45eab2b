# SPDX-License-Identifier: BSD-3-Clause
"""Sugar juice against tables of sucrose solutions, and as a fluid."""

import pickle
import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from sklearn.base import clone

from sklvalve.mechanism import (
    ValidityWarning,
    ValveMechanismTransformer,
    fluid_from,
    juice_density,
    juice_kinematic_viscosity,
    juice_vapour_pressure,
    water_density,
    water_kinematic_viscosity,
    water_vapour_pressure,
)

# CRC Handbook, sucrose in water at 20 degC: percent by mass, density [kg/m3]
DENSITY = [(5, 1017.8), (15, 1059.2), (30, 1127.0), (50, 1229.5), (60, 1286.4), (72, 1359.9)]
# the same, viscosity: percent by mass, temperature [degC], [mPa s]
VISCOSITY = [
    (20, 20, 1.960), (20, 50, 0.970), (20, 80, 0.590),
    (40, 20, 6.200), (40, 50, 2.497), (40, 80, 1.334),
    (60, 20, 56.5), (60, 50, 14.01), (60, 80, 5.40),
]  # fmt: skip


@pytest.mark.parametrize(("brix", "density"), DENSITY)
def test_density(brix, density):
    assert_allclose(juice_density(293.15, brix), density, rtol=4e-3)


def test_density_against_coolprop():
    properties = pytest.importorskip("CoolProp.CoolProp").PropsSI
    for temperature in (333.15, 363.15):
        parts = [
            properties("D", "T", temperature, "P", 1e6, f"INCOMP::Food{part}")
            for part in ("Water", "Carbohydrate")
        ]
        for share in (0.15, 0.65):
            theirs = 1.0 / ((1.0 - share) / parts[0] + share / parts[1])
            # their water is a food engineer's, ours that of IAPWS
            assert_allclose(juice_density(temperature, 100.0 * share), theirs, rtol=2e-3)


@pytest.mark.parametrize(("brix", "celsius", "viscosity"), VISCOSITY)
def test_viscosity(brix, celsius, viscosity):
    temperature = 273.15 + celsius
    dynamic = juice_kinematic_viscosity(temperature, brix) * juice_density(temperature, brix)
    assert_allclose(dynamic * 1e3, viscosity, rtol=0.08)


@pytest.mark.parametrize(("brix", "activity"), [(0.0, 1.0), (15.0, 0.990), (65.0, 0.865)])
def test_vapour_pressure(brix, activity):
    temperature = np.array([300.0, 360.0])
    ratio = juice_vapour_pressure(temperature, brix) / water_vapour_pressure(temperature)
    assert_allclose(ratio, activity, atol=5e-4)


def test_no_sugar_is_water():
    assert_allclose(juice_density(350.0, 0.0), water_density(350.0), rtol=1e-14)
    assert_allclose(juice_vapour_pressure(350.0, 0.0), water_vapour_pressure(350.0), rtol=1e-14)
    assert_allclose(juice_kinematic_viscosity(293.15, 0.0), water_kinematic_viscosity(293.15), rtol=0.04)


@pytest.mark.parametrize("formula", [juice_density, juice_vapour_pressure, juice_kinematic_viscosity])
def test_brix_that_is_none(formula):
    with pytest.warns(ValidityWarning, match="2 of 4 rows have a brix outside 0 to 85 %"):
        values = formula(300.0, [-1.0, 15.0, 90.0, np.nan])
    assert_array_equal(np.isnan(values), [True, False, True, True])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        formula([20.0, 182.0, 300.0, 700.0], 99.0, warn=False)
        formula([20.0, 182.0, 300.0, 700.0], 15.0, warn=False)
    assert np.ndim(formula(300.0, 15.0)) == 0


class TestFluid:
    def test_it_brings_every_property(self):
        juice = fluid_from("sugar juice", brix=65.0)
        assert juice.density(353.15) == juice_density(353.15, 65.0)
        assert juice.vapour_pressure(353.15) == juice_vapour_pressure(353.15, 65.0)
        assert juice.kinematic_viscosity(353.15) == juice_kinematic_viscosity(353.15, 65.0)
        assert juice.critical_pressure == 22.064e6
        assert juice.name == "sugar juice of 65 %"
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            juice.density([20.0], warn=False)

    def test_it_serves_the_transformer(self):
        X = np.array([[0.5, 6e5, 4e5, 353.15]])
        juice = fluid_from("sugar juice", brix=15.0)
        valve = ValveMechanismTransformer(temperature=3, kv_rated=40.0, fluid=juice, features=["density"])
        again = pickle.loads(pickle.dumps(clone(valve).fit(X)))
        assert_allclose(again.transform(X), [[juice_density(353.15, 15.0)]])

    @pytest.mark.parametrize("brix", [None, -1.0, 90.0, [10.0, 20.0], np.nan])
    def test_it_needs_its_brix(self, brix):
        with pytest.raises(ValueError, match="sugar juice needs its brix"):
            fluid_from("sugar juice", brix=brix)

    def test_no_other_has_a_brix(self):
        with pytest.raises(ValueError, match="brix belongs to the fluid 'sugar juice'"):
            fluid_from("water", brix=10.0)
