# SPDX-License-Identifier: BSD-3-Clause
"""Gas by the letter of the standard: its printed constants, in its own units, in every function."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    GAS_CONSTANT,
    GAS_FLOW_BASES,
    gas_flow,
    gas_inlet_pressure,
    gas_kv,
    gas_outlet_pressure,
    gas_state,
)
from tests.mechanism.gas_duties import duties


def by_hand(basis, kv, p1, x, temperature, molar_mass, z, xt, gamma):
    """The printed equations in kPa, K, kg/kmol, kg/h and m3/h."""
    x_choked = gamma / 1.4 * xt
    x = min(x, x_choked)
    through = kv * (1.0 - x / (3.0 * x_choked))
    if basis == "mass":
        return through * 1.10 * p1 * np.sqrt(x * molar_mass / (temperature * z))
    if basis == "actual":
        density = p1 * molar_mass / (z * GAS_CONSTANT * temperature)
        return through * 3.16 * np.sqrt(x * p1 * density) / density
    n9 = {"normal": 24.6, "standard": 26.0}[basis]
    return through * n9 * p1 * np.sqrt(x / (molar_mass * temperature * z))


@pytest.mark.parametrize("basis", GAS_FLOW_BASES)
@pytest.mark.parametrize("x", [0.1, 0.9])
def test_the_printed_equations(basis, x):
    wanted = by_hand(basis, 10.0, 600.0, x, 350.0, 44.0, 0.95, 0.6, 1.3)
    known = {"gamma": 1.3, "xt": 0.6, "compressibility": 0.95, "basis": basis}
    duty = (10.0, 6e5, 6e5 * (1.0 - x), 350.0, 0.044)
    assert_allclose(3600.0 * gas_flow(*duty, **known, strict=True), wanted, rtol=1e-12)
    # the constants of the default are not rounded
    off = 3600.0 * gas_flow(*duty, **known) / wanted - 1.0
    assert 2e-4 < abs(off) < 5e-3


@pytest.mark.parametrize("basis", GAS_FLOW_BASES)
@pytest.mark.parametrize("kind", ["plain", "reducers", "viscous reducers"])
def test_there_and_back(basis, kind):
    (kv, p1, p2, *gas), known = duties(kind, 2000, seed=31)
    known |= {"basis": basis, "strict": True}
    flow = gas_flow(kv, p1, p2, *gas, **known)
    assert_allclose(gas_kv(flow, p1, p2, *gas, **known), kv, rtol=1e-9)
    before = gas_inlet_pressure(flow, kv, p2, *gas, warn=False, **known)
    behind = gas_outlet_pressure(flow, kv, p1, *gas, warn=False, **known)
    for found, high, low in ((before, before, p2), (behind, p1, behind)):
        there = ~np.isnan(found)
        assert np.mean(there) > 0.1
        assert_allclose(gas_flow(kv, high, low, *gas, **known)[there], flow[there], rtol=1e-9)


@pytest.mark.parametrize("basis", GAS_FLOW_BASES)
def test_the_state_is_that_of_the_strict_flow(basis):
    valve = {"gamma": 1.4, "xt": 0.7, "fl": 0.9, "fd": 0.46, "nominal_size": 0.05, "kv_rated": 30.0}
    duty = (10.0, 6e5, 5e5, 300.0, 0.029)
    viscosity = np.linspace(1e-4, 2e-2, 200_001)
    onset = []
    for strict in (False, True):
        known = {**valve, "basis": basis, "strict": strict, "dynamic_viscosity": viscosity}
        state = gas_state(*duty, **known)
        onset.append(viscosity[np.argmax(state == 2)])
    # a printed constant moves the Reynolds number, and with it the viscosity where turbulence ends
    exact = {name: value for name, value in valve.items() if name in ("gamma", "xt")}
    flows = [gas_flow(*duty, **exact, basis=basis, strict=strict) for strict in (False, True)]
    assert_allclose(onset[1] / onset[0], flows[1] / flows[0], rtol=3e-4)
    assert onset[1] != onset[0]
