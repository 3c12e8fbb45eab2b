# SPDX-License-Identifier: BSD-3-Clause
"""Gas flow on its bases: amounts, volumes and masses of the same gas."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    GAS_CONSTANT,
    GAS_FLOW_BASES,
    gas_density,
    gas_flow,
    gas_mass_flow,
    gas_volume_flow,
)

DUTY = (6e5, 400.0, 0.044, 0.95)


def test_molar_volumes_of_the_reference_states():
    # CODATA: 22.413969 m3/kmol at 0 degC and one atmosphere
    assert_allclose(gas_volume_flow(1.0, "normal", *DUTY) * 0.044, 22.41396954e-3, rtol=1e-9)
    ratio = gas_volume_flow(1.0, "standard", *DUTY) / gas_volume_flow(1.0, "normal", *DUTY)
    assert_allclose(ratio, 288.15 / 273.15, rtol=1e-15)


def test_actual_volume_is_that_of_the_real_gas():
    density = 6e5 * 0.044 / (0.95 * GAS_CONSTANT * 400.0)
    assert_allclose(gas_volume_flow(1.0, "actual", *DUTY), 1.0 / density, rtol=1e-15)
    assert_allclose(gas_density(*DUTY), density, rtol=1e-15)


@pytest.mark.parametrize("basis", GAS_FLOW_BASES)
def test_there_and_back(basis):
    mass = np.random.default_rng(0).normal(size=1000)
    assert_allclose(gas_mass_flow(gas_volume_flow(mass, basis, *DUTY), basis, *DUTY), mass, rtol=1e-15)


@pytest.mark.parametrize("basis", GAS_FLOW_BASES)
@pytest.mark.parametrize("backward", [False, True])
def test_the_valve_counts_at_the_side_where_the_gas_enters(basis, backward):
    p1, p2 = (4e5, 6e5) if backward else (6e5, 4e5)
    known = {"gamma": 1.3, "xt": 0.7, "compressibility": 0.95}
    mass = gas_flow(10.0, p1, p2, 400.0, 0.044, **known)
    counted = gas_flow(10.0, p1, p2, 400.0, 0.044, basis=basis, **known)
    assert_allclose(counted, gas_volume_flow(mass, basis, *DUTY), rtol=1e-15)


def test_no_gas_has_no_density():
    assert np.isnan(gas_density(1e5, [0.0, -1.0, np.nan], 0.029)).all()
    assert np.isnan(gas_density(1e5, 300.0, [0.0, -1.0, np.nan])).all()


def test_an_unknown_basis():
    with pytest.raises(ValueError, match="got 'litres'"):
        gas_volume_flow(1.0, "litres", *DUTY)
