# SPDX-License-Identifier: BSD-3-Clause
"""Gas that is not turbulent: the equations hold, regimes join, and limits are those of physics."""

import numpy as np
import pytest
from fluids.control_valve import size_control_valve_g
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    GAS_CONSTANT,
    ValidityWarning,
    choked_drop_ratio,
    gas_flow,
    gas_inlet_pressure,
    gas_kv,
    gas_outlet_pressure,
)
from sklvalve.mechanism.gas_roots import root_between
from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.mechanism.viscosity import reynolds_factor, trim_parameter, valve_reynolds_number
from tests.mechanism.gas_duties import duties

VALVE = {"gamma": 1.4, "xt": 0.7, "fl": 0.9, "fd": 0.46, "nominal_size": 0.05, "kv_rated": 30.0}
AIR = (300.0, 0.029)


def reynolds_of(flow, kv, known):
    # mass flow by dynamic viscosity is volume flow by kinematic viscosity
    jet = {name: known[name] for name in ("fl", "fd")}
    pipe = known.get("inlet_pipe", known["nominal_size"])
    return valve_reynolds_number(flow, kv, known["dynamic_viscosity"], inlet_pipe=pipe, **jet)


def test_the_flow_solves_its_own_implicit_equation():
    (kv, p1, p2, temperature, molar_mass), known = duties("viscous", 20_000, seed=11)
    flow = gas_flow(kv, p1, p2, temperature, molar_mass, **known)
    reynolds = reynolds_of(flow, kv, known)
    trim = trim_parameter(kv, known["nominal_size"], kv_rated=known["kv_rated"])
    x, x_choked = (p1 - p2) / p1, choked_drop_ratio(known["gamma"], known["xt"])
    x_s = np.minimum(x, x_choked)
    turbulent = np.clip((reynolds - 1e3) / 9e3, 0.0, 1.0)
    through = turbulent * np.sqrt(x_s) * (1.0 - x_s / (3.0 * x_choked))
    through += (1.0 - turbulent) * np.sqrt(x * (1.0 - x / 2.0))
    density = p1 * molar_mass / (known["compressibility"] * GAS_CONSTANT * temperature)
    factor = reynolds_factor(reynolds, trim, known["fl"])
    assert_allclose(FLOW_CONSTANT * factor * kv * through * np.sqrt(p1 * density), flow, rtol=1e-11)
    # every regime is among them
    for low, high in ((0.0, 10.0), (10.0, 1e3), (1e3, 1e4), (1e4, np.inf)):
        assert np.sum((reynolds > low) & (reynolds < high)) > 500


def test_turbulent_flow_does_not_feel_the_viscosity():
    duty = (10.0, 6e5, [5e5, 2e5], *AIR)
    turbulent = gas_flow(*duty, gamma=1.4, xt=0.7)
    assert_allclose(gas_flow(*duty, dynamic_viscosity=1.8e-5, **VALVE), turbulent, rtol=1e-15)


def test_laminar_flow_goes_with_the_difference_of_the_squares():
    p2 = np.array([5.9e5, 5e5, 2e5, 0.0])
    flow = gas_flow(10.0, 6e5, p2, *AIR, dynamic_viscosity=50.0, **VALVE)
    assert np.all(reynolds_of(flow, 10.0, {**VALVE, "dynamic_viscosity": 50.0}) < 5.0)
    assert_allclose(flow / flow[-1], 1.0 - (p2 / 6e5) ** 2, rtol=1e-12)
    twice = gas_flow(10.0, 6e5, p2, *AIR, dynamic_viscosity=100.0, **VALVE)
    assert_allclose(twice, flow / 2.0, rtol=1e-12)


@pytest.mark.parametrize("p2", [5.9e5, 4e5, 1e5])
def test_regimes_join_as_the_viscosity_falls(p2):
    viscosity = np.geomspace(100.0, 1e-5, 200_001)
    flow = gas_flow(10.0, 6e5, p2, *AIR, dynamic_viscosity=viscosity, **VALVE)
    reynolds = reynolds_of(flow, 10.0, {**VALVE, "dynamic_viscosity": viscosity})
    assert reynolds[0] < 10.0
    assert reynolds[-1] > 1e4
    # no step is larger than the laminar law allows: flow falls with the first power of viscosity at most
    assert np.max(np.abs(np.diff(np.log(flow)))) < 1.01 * np.log(viscosity[0] / viscosity[1])
    # a turning jet expands worse, which takes back a little near 10 000
    assert np.min(np.diff(reynolds)) > 0.0


@pytest.mark.parametrize("viscosity", [2e-3, 5e-3, 2e-2, 1.0])
def test_smooth_where_the_turbulent_part_chokes(viscosity):
    p_choked = 6e5 * (1.0 - choked_drop_ratio(1.4, 0.7))
    p2 = p_choked + 30.0 * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    flow = gas_flow(10.0, 6e5, p2, *AIR, dynamic_viscosity=viscosity, **VALVE)
    slopes = np.diff(flow) / 30.0
    assert np.all(slopes < 0.0)
    assert_allclose(slopes[1], slopes[2], rtol=1e-3)


def test_small_steps_give_small_changes_over_pressure():
    p2 = np.linspace(6e5, 0.0, 100_001)
    for viscosity in (1e-3, 3e-3, 1e-2, 0.1):
        flow = gas_flow(10.0, 6e5, p2, *AIR, dynamic_viscosity=viscosity, **VALVE)
        steps = np.diff(flow)
        assert np.all(steps >= 0.0)
        # the largest possible slope is that of the root at the origin
        assert np.max(steps[100:]) < 1e-3 * flow[-1]


def test_fluids_oversizes_a_laminar_valve():
    # its Reynolds number takes the normal flow for the actual one, and it returns a trial value
    duty = {"gamma": 1.4, "xt": 0.7, "fl": 0.9, "fd": 1.0, "nominal_size": 0.025, "dynamic_viscosity": 1.8e-5}
    flow = gas_flow(0.01, 10e5, 9.99e5, *AIR, basis="normal", kv_rated=0.01, **duty)
    ours = gas_kv(flow, 10e5, 9.99e5, *AIR, basis="normal", kv_rated=0.01, **duty)
    assert_allclose(ours, 0.01, rtol=1e-9)
    sizes = {"D1": 0.025, "D2": 0.025, "d": 0.025, "FL": 0.9, "Fd": 1.0, "xT": 0.7}
    theirs = size_control_valve_g(300.0, 29.0, 1.8e-5, 1.4, 1.0, 10e5, 9.99e5, flow, **sizes)
    passed = gas_flow(theirs, 10e5, 9.99e5, *AIR, basis="normal", kv_rated=0.01, **duty)
    assert abs(passed / flow - 1.0) > 0.05


def test_volume_at_an_unknown_inlet_pressure_is_not_enough():
    # the mass flow, and with it the regime, would depend on the answer: there may be two
    known = {**VALVE, "dynamic_viscosity": 1e-2, "basis": "actual"}
    with pytest.warns(ValidityWarning, match="gas_inlet_pressure: 1 of 1 rows"):
        assert np.isnan(gas_inlet_pressure(0.01, 10.0, 5e5, *AIR, **known))
    flow = gas_flow(10.0, 6e5, 5e5, *AIR, **known)
    assert_allclose(gas_outlet_pressure(flow, 10.0, 6e5, *AIR, **known), 5e5, rtol=1e-9)


def test_no_flow():
    known = {**VALVE, "dynamic_viscosity": 1e-2}
    assert gas_flow(10.0, 2e5, 2e5, *AIR, **known) == 0.0
    assert gas_flow(0.0, 2e5, 1e5, *AIR, **known) == 0.0
    assert gas_kv(0.0, 2e5, 1e5, *AIR, **known) == 0.0
    assert gas_outlet_pressure(0.0, 10.0, 2e5, *AIR, **known) == 2e5
    assert gas_inlet_pressure(0.0, 10.0, 2e5, *AIR, **known) == 2e5
    flow = gas_flow(10.0, 2e5, 0.0, *AIR, **known)
    assert_allclose(gas_inlet_pressure(flow, 10.0, 0.0, *AIR, **known), 2e5, rtol=1e-9)


def test_what_is_missing_is_said():
    with pytest.raises(ValueError, match="dynamic_viscosity is given"):
        gas_flow(10.0, 2e5, 1e5, *AIR, gamma=1.4, xt=0.7, dynamic_viscosity=1e-5)


def test_shapes_and_missing_values():
    known = {**VALVE, "dynamic_viscosity": np.array([1e-2, np.nan, 1e-3])}
    flow = gas_flow([[10.0], [20.0]], 3e5, 1e5, *AIR, **known)
    assert flow.shape == (2, 3)
    assert np.all(np.isnan(flow) == [False, True, False])
    kv = gas_kv(flow, 3e5, 1e5, *AIR, **known)
    assert_allclose(kv[:, [0, 2]], [[10.0, 10.0], [20.0, 20.0]], rtol=1e-9)
    assert np.all(np.isnan(kv[:, 1]))


def test_root_in_a_bracket():
    target = np.array([0.1, 1.0, 7.9, 9.0])
    roots = root_between(lambda v: v**3 - target, np.zeros(4), np.full(4, 2.0))
    assert_allclose(roots[:3], np.cbrt(target[:3]), rtol=1e-14)
    assert np.isnan(roots[3])
