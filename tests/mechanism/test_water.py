# SPDX-License-Identifier: BSD-3-Clause
"""Water and what is made from it where there is no liquid water, and the numbers they share."""

import ast
import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from sklvalve import mechanism
from sklvalve.mechanism import (
    ValidityWarning,
    juice_density,
    juice_kinematic_viscosity,
    juice_vapour_pressure,
    steam_density,
    steam_kinematic_viscosity,
    water_density,
    water_kinematic_viscosity,
    water_vapour_pressure,
)

WATER = [water_density, water_kinematic_viscosity, water_vapour_pressure]
STEAM = [steam_density, steam_kinematic_viscosity]
JUICE = [juice_density, juice_kinematic_viscosity, juice_vapour_pressure]
# degrees Celsius taken for kelvins, and the border
TEMPERATURE = np.array([0.0, 20.0, 90.0, 229.99, 230.0, 293.15, 647.096, 647.1, np.nan])
LIQUID = [False, False, False, False, True, True, True, False, False]


@pytest.mark.parametrize("formula", WATER + STEAM)
def test_no_number_where_there_is_no_water(formula):
    with pytest.warns(ValidityWarning, match=r"of 9 rows have a temperature outside .*NaN"):
        values = formula(TEMPERATURE)
    assert_array_equal(np.isfinite(values), LIQUID)
    assert np.all(values[LIQUID] > 0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_array_equal(formula(TEMPERATURE, warn=False), values)


@pytest.mark.parametrize("formula", JUICE)
def test_no_juice_without_water(formula):
    values = formula(TEMPERATURE, 15.0, warn=False)
    assert_array_equal(np.isfinite(values), LIQUID)
    assert np.all(values[LIQUID] > 0.0)


@pytest.mark.parametrize("number", [22.064e6, 647.096, 0.018015268])
def test_each_number_of_water_stands_in_one_file(number):
    files = Path(mechanism.__file__).parent.glob("*.py")
    trees = {path.name: ast.parse(path.read_text(encoding="utf-8")) for path in files}
    holders = [
        name
        for name, tree in trees.items()
        if any(isinstance(node, ast.Constant) and node.value == number for node in ast.walk(tree))
    ]
    assert holders == ["_constants.py"]
