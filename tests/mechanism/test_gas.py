# SPDX-License-Identifier: BSD-3-Clause
"""Gas: worked cases, an outside oracle where it is right, and what the flow must do everywhere."""

import json
from pathlib import Path

import hypothesis
import numpy as np
import pytest
from fluids.control_valve import control_valve_choke_P_g, size_control_valve_g
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    GAS_CONSTANT,
    ValidityWarning,
    choked_drop_ratio,
    combined_drop_ratio_factor,
    expansion_factor,
    fitting_loss,
    gas_flow,
    gas_inlet_pressure,
    gas_kv,
    gas_outlet_pressure,
    piping_factor,
    specific_heat_ratio_factor,
)
from sklvalve.mechanism.liquid import FLOW_CONSTANT
from tests.mechanism.gas_duties import KINDS, duties

CASES = json.loads((Path(__file__).parent / "cases.json").read_text(encoding="utf-8"))["cases"]
CASES = {case["id"]: case for case in CASES}

# N9 of the standard follows from its N1, and 24.6 is what it prints
N9 = FLOW_CONSTANT * 3600.0 * np.sqrt(1e3 * GAS_CONSTANT) * 273.15 / 101.325
PRINTED_N9 = N9 / 24.6


def case_of(name):
    case = CASES[name]
    given = {key: entry["value"] for key, entry in case["inputs"].items()}
    wanted = {key: (entry["value"], entry["rel_tol"]) for key, entry in case["expected"].items()}
    return given, wanted


def case_duty(given):
    """Pressures and gas of a case in SI."""
    duty = (1e3 * given["p1"], 1e3 * given["p2"], given["T1"], 1e-3 * given["M"])
    return duty, {"gamma": given["gamma"], "xt": given["x_T"], "compressibility": given["Z1"]}


def test_n9_is_printed_a_little_high():
    assert_allclose(N9, 24.570, atol=5e-4)


def test_example_3_sizes_with_reducers():
    given, wanted = case_of("IEC-3-size")
    duty, known = case_duty(given)
    sizes = [1e-3 * given[name] for name in ("d", "D1", "D2")]
    pipes = dict(zip(("nominal_size", "inlet_pipe", "outlet_pipe"), sizes, strict=True))
    flow = given["Q_s"] / 3600.0
    # the case's figure goes with the printed N9
    kv = gas_kv(flow, *duty, basis="normal", **known, **pipes, strict=True)
    assert_allclose(kv, wanted["Kv"][0], rtol=wanted["Kv"][1])
    assert_allclose(kv, wanted["Kv"][0], rtol=1e-5)
    x = (given["p1"] - given["p2"]) / given["p1"]
    xtp = combined_drop_ratio_factor(kv, sizes[0], *fitting_loss(*sizes), given["x_T"])
    assert_allclose(x, wanted["x"][0], rtol=wanted["x"][1])
    assert_allclose(xtp, wanted["x_TP"][0], rtol=wanted["x_TP"][1])
    assert_allclose(specific_heat_ratio_factor(1.3), wanted["F_gamma"][0], rtol=wanted["F_gamma"][1])
    assert (x >= choked_drop_ratio(given["gamma"], xtp)) == wanted["choked"][0]
    # ours, with a constant that agrees with the others, is 0.16 % larger
    assert_allclose(gas_kv(flow, *duty, basis="normal", **known, **pipes), 71.00, atol=0.01)


def test_example_4_is_not_choked():
    given, wanted = case_of("IEC-4-choke")
    assert (given["x"] >= given["F_gamma"] * given["x_T"]) == wanted["choked"][0]
    assert_allclose(choked_drop_ratio(1.67, given["x_T"]), given["F_gamma"] * given["x_T"], rtol=1e-3)


@pytest.mark.filterwarnings("ignore:gas_kv. 1 of 1 rows have a gamma outside")
def test_example_4_turbulent():
    given, wanted = case_of("IEC-4-turb")
    duty, known = case_duty(given)
    kv = gas_kv(given["Q_s"] / 3600.0, *duty, basis="normal", **known, strict=True)
    assert_allclose(kv, wanted["Kv"][0], rtol=wanted["Kv"][1])


def test_onset_of_choking():
    given, wanted = case_of("choke-g-p2")
    p2 = given["p1"] * (1.0 - choked_drop_ratio(given["gamma"], given["x_T"]))
    assert_allclose(p2, wanted["p2"][0], rtol=wanted["p2"][1])


def test_drop_ratio_from_the_cubic():
    # k = (Q / (C N9 F_P p1))^2 M T Z = x Y^2
    given, wanted = case_of("x-g")
    known = {"gamma": 1.4, "xt": given["x_choked"]}
    flow = 10.0 * np.sqrt(given["k"]) * 1e5 * FLOW_CONSTANT * np.sqrt(0.03 / (GAS_CONSTANT * 300.0))
    p2 = gas_outlet_pressure(flow, 10.0, 1e5, 300.0, 0.03, **known)
    # the case gives k, and k needs no constant: one with the printed figure is met as well
    printed = flow * 1.10 / (FLOW_CONSTANT * 3.6e6 / np.sqrt(1e3 * GAS_CONSTANT))
    strict = gas_outlet_pressure(printed, 10.0, 1e5, 300.0, 0.03, **known, strict=True)
    assert_allclose(1.0 - strict / 1e5, wanted["x"][0], rtol=wanted["x"][1])
    assert_allclose(1.0 - p2 / 1e5, wanted["x"][0], rtol=wanted["x"][1])


def test_agrees_with_fluids_without_reducers():
    (kv, p1, p2, temperature, molar_mass), known = duties("plain", 500, seed=0)
    flow = gas_flow(kv, p1, p2, temperature, molar_mass, basis="normal", **known, strict=True)
    gamma, z, xt = known["gamma"], known["compressibility"], known["xt"]
    rows = zip(temperature, 1e3 * molar_mass, gamma, z, p1, p2, flow, xt, strict=True)
    theirs = [size_control_valve_g(t, m, 1e-5, g, c, a, b, q, xT=x) for t, m, g, c, a, b, q, x in rows]
    assert_allclose(theirs, kv, rtol=1e-6)


def test_agrees_with_fluids_about_choking():
    for xt, gamma in ((0.3, 1.1), (0.7, 1.4), (0.8, 1.6)):
        theirs = control_valve_choke_P_g(xT=xt, gamma=gamma, P1=1e5)
        assert_allclose(1e5 * (1.0 - choked_drop_ratio(gamma, xt)), theirs, rtol=1e-12)


def equation(kv, p1, p2, temperature, molar_mass, known):
    """Mass flow by the standard's equation with the factors as functions of their own."""
    size, pipes = known["nominal_size"], (known["inlet_pipe"], known["outlet_pipe"])
    zeta_sum, zeta_inlet = fitting_loss(size, *pipes)
    xtp = combined_drop_ratio_factor(kv, size, zeta_sum, zeta_inlet, known["xt"])
    x, x_choked = (p1 - p2) / p1, choked_drop_ratio(known["gamma"], xtp)
    density = p1 * molar_mass / (known["compressibility"] * GAS_CONSTANT * temperature)
    capacity = kv * piping_factor(kv, size, zeta_sum) * expansion_factor(x, x_choked)
    return FLOW_CONSTANT * capacity * np.sqrt(np.minimum(x, x_choked) * p1 * density)


def test_reducers_satisfy_the_equations_where_fluids_does_not():
    # fluids puts x_T instead of x_TP into Y and stops at one per cent
    (kv, p1, p2, temperature, molar_mass), known = duties("reducers", 300, seed=0)
    kv = 0.03 * (1e3 * known["nominal_size"]) ** 2 * np.linspace(0.3, 1.0, 300)
    flow = gas_flow(kv, p1, p2, temperature, molar_mass, **known)
    assert_allclose(equation(kv, p1, p2, temperature, molar_mass, known), flow, rtol=1e-12)
    ours = gas_kv(flow, p1, p2, temperature, molar_mass, **known)
    assert_allclose(equation(ours, p1, p2, temperature, molar_mass, known), flow, rtol=1e-12)
    normal = gas_flow(kv, p1, p2, temperature, molar_mass, basis="normal", **known) / PRINTED_N9
    columns = (temperature, 1e3 * molar_mass, known["gamma"], known["compressibility"], p1, p2, normal)
    pipes = (known["inlet_pipe"], known["outlet_pipe"], known["nominal_size"], known["xt"])
    theirs = [
        size_control_valve_g(t, m, 1e-5, g, z, a, b, q, D1=d1, D2=d2, d=d, xT=xt, allow_laminar=False)
        for t, m, g, z, a, b, q, d1, d2, d, xt in zip(*columns, *pipes, strict=True)
    ]
    off = np.abs(equation(np.array(theirs), p1, p2, temperature, molar_mass, known) / flow - 1.0)
    assert np.max(off) > 0.02
    assert np.mean(off > 1e-3) > 0.2


@pytest.mark.parametrize("kind", KINDS)
def test_rises_with_capacity_and_drop(kind):
    (kv, p1, p2, *gas), known = duties(kind, 2000, seed=7)
    known = {key: values[:, None] for key, values in known.items()}
    kv, p1, p2, *gas = (values[:, None] for values in (kv, p1, p2, *gas))
    steps = np.linspace(0.0, 1.0, 60)
    by_kv = gas_flow(kv * steps, p1, p2, *gas, **known)
    assert np.all(np.diff(by_kv, axis=1) > 0.0)
    by_drop = gas_flow(kv, p1, p1 * (1.0 - steps), *gas, **known)
    assert np.all(np.diff(by_drop, axis=1) >= -1e-14 * by_drop[:, 1:])
    by_inlet = gas_flow(kv, p2 * (1.0 + 3.0 * steps), p2, *gas, **known)
    assert np.all(np.diff(by_inlet, axis=1) > 0.0)


def test_smooth_at_choking():
    # one-sided slopes agree: the flow enters choking with slope zero
    known = {"gamma": 1.3, "xt": 0.7}
    p_choked = 1e6 * (1.0 - choked_drop_ratio(1.3, 0.7))
    step = 1e-6 * 1e6
    below, at, above = (
        gas_flow(10.0, 1e6, p_choked + shift, 300.0, 0.029, **known) for shift in (step, 0.0, -step)
    )
    typical = at / 1e6
    assert abs((at - below) / step) < 1e-5 * typical
    assert above == at


@pytest.mark.parametrize("outlet", [0.05, 0.08, 0.2])
def test_reverse_flow_is_the_valve_turned_round(outlet):
    known = {"gamma": 1.3, "xt": 0.7, "nominal_size": 0.05}
    ahead = gas_flow(40.0, 6e5, 4e5, 300.0, 0.029, inlet_pipe=outlet, outlet_pipe=0.08, **known)
    back = gas_flow(40.0, 4e5, 6e5, 300.0, 0.029, inlet_pipe=0.08, outlet_pipe=outlet, **known)
    assert back == -ahead


def test_no_flow():
    known = {"gamma": 1.4, "xt": 0.7}
    assert gas_flow(10.0, 2e5, 2e5, 300.0, 0.029, **known) == 0.0
    assert gas_flow(0.0, 2e5, 1e5, 300.0, 0.029, **known) == 0.0
    assert gas_outlet_pressure(0.0, 10.0, 2e5, 300.0, 0.029, **known) == 2e5
    assert gas_inlet_pressure(0.0, 10.0, 2e5, 300.0, 0.029, **known) == 2e5
    assert gas_kv(0.0, 2e5, 1e5, 300.0, 0.029, **known) == 0.0


def test_into_a_vacuum():
    known = {"gamma": 1.4, "xt": 0.7}
    flow = gas_flow(10.0, 2e5, 0.0, 300.0, 0.029, **known)
    assert_allclose(gas_inlet_pressure(flow, 10.0, 0.0, 300.0, 0.029, **known), 2e5, rtol=1e-12)
    # a valve that cannot choke
    never = {"gamma": 1.6, "xt": 0.95}
    flow = gas_flow(10.0, 2e5, 0.0, 300.0, 0.029, **never)
    assert_allclose(gas_inlet_pressure(flow, 10.0, 0.0, 300.0, 0.029, **never), 2e5, rtol=1e-9)
    assert_allclose(gas_outlet_pressure(flow, 10.0, 2e5, 300.0, 0.029, **never), 0.0, atol=1e-3)


def test_shapes_and_missing_values():
    known = {"gamma": 1.4, "xt": np.array([0.6, 0.7, np.nan])}
    kv, p2 = np.array([[10.0], [20.0]]), [1e5, np.nan, 1e5]
    flow = gas_flow(kv, 3e5, p2, 300.0, 0.029, **known)
    assert flow.shape == (2, 3)
    assert_allclose(flow[:, 0], gas_flow(kv[:, 0], 3e5, 1e5, 300.0, 0.029, gamma=1.4, xt=0.6), rtol=1e-15)
    assert np.all(np.isnan(flow[:, 1:]))
    assert isinstance(gas_flow(10.0, 3e5, 1e5, 300.0, 0.029, gamma=1.4, xt=0.6), float)
    pressure, feasible = gas_outlet_pressure(
        flow, kv, 3e5, 300.0, 0.029, return_feasible=True, warn=False, **known
    )
    assert pressure.shape == feasible.shape == (2, 3)
    assert not np.any(feasible[:, 1:])


def test_what_has_no_answer_is_counted():
    known = {"gamma": 1.4, "xt": 0.7}
    with pytest.warns(ValidityWarning, match="gas_flow: 2 of 3 rows have a pressure below zero"):
        flow = gas_flow(10.0, [2e5, 1e5, -1.0], [-1e5, 0.5e5, -2.0], 300.0, 0.029, **known)
    assert np.isnan(flow).tolist() == [True, False, True]
    with pytest.warns(ValidityWarning, match="gas_flow: 1 of 2 rows have a gamma outside"):
        gas_flow(10.0, 2e5, 1e5, 300.0, 0.029, gamma=[1.4, 1.7], xt=0.7)
    with pytest.warns(ValidityWarning, match="gas_flow: 1 of 2 rows have a negative kv"):
        gas_flow([10.0, -10.0], 2e5, 1e5, 300.0, 0.029, **known)
    with pytest.warns(ValidityWarning, match="gas_kv: 1 of 2 rows have no pressure drop"):
        kv = gas_kv(1.0, 2e5, [2e5, 1e5], 300.0, 0.029, **known)
    assert np.isnan(kv[0])
    with pytest.warns(ValidityWarning, match="gas_kv: 1 of 1 rows have the flow against"):
        assert gas_kv(-1.0, 2e5, 1e5, 300.0, 0.029, **known) < 0.0
    with pytest.warns(ValidityWarning, match="gas_outlet_pressure: 2 of 3 rows ask for a flow"):
        pressure = gas_outlet_pressure([0.1, 0.1, 9.0], [10.0, 0.0, 10.0], 5e5, 300.0, 0.029, **known)
    assert np.isnan(pressure).tolist() == [False, True, True]


def test_no_valve_between_narrow_reducers():
    # what a reducer chokes by itself no valve passes
    known = {"gamma": 1.4, "xt": 0.7, "nominal_size": 0.05, "inlet_pipe": 0.1, "outlet_pipe": 0.1}
    with pytest.warns(ValidityWarning, match="gas_kv: 1 of 2 rows ask for a flow that no such"):
        kv = gas_kv([0.1, 1e3], 3e5, 1e5, 300.0, 0.029, **known)
    assert np.isnan(kv).tolist() == [False, True]


def test_what_is_missing_is_said():
    known = {"gamma": 1.4, "xt": 0.7}
    with pytest.raises(ValueError, match="basis must be one of mass, actual"):
        gas_flow(10.0, 2e5, 1e5, 300.0, 0.029, basis="cubic feet", **known)
    with pytest.raises(ValueError, match="nominal_size is not"):
        gas_kv(1.0, 2e5, 1e5, 300.0, 0.029, inlet_pipe=0.1, **known)


@pytest.mark.parametrize("kind", KINDS)
def test_senseless_rows_neither_raise_nor_warn(kind):
    rng = np.random.default_rng(0)
    odd = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 1e-300, 1e300, 1e5, 2e5, 0.5, 1.4, 300.0])
    names = duties(kind, 1, seed=0)[1]
    for _ in range(20):
        known = {name: rng.choice(odd, 2000) for name in names}
        for function in (gas_flow, gas_kv, gas_outlet_pressure, gas_inlet_pressure):
            duty = (rng.choice(odd, 2000) for _ in range(5))
            assert function(*duty, warn=False, **known).shape == (2000,)


@hypothesis.given(st.floats(1.0, 500.0), st.floats(2e5, 1e7), st.floats(0.0, 1.0), st.floats(0.15, 0.84))
@hypothesis.settings(max_examples=50, deadline=None)
def test_same_for_numbers_and_arrays(kv, p1, ratio, xt):
    known = {"gamma": 1.3, "nominal_size": 0.1, "inlet_pipe": 0.15, "outlet_pipe": 0.2}
    one = gas_flow(kv, p1, p1 * ratio, 300.0, 0.029, xt=xt, **known)
    many = gas_flow([kv] * 3, [p1] * 3, p1 * ratio, 300.0, [0.029] * 3, xt=xt, **known)
    assert_allclose(many, one, rtol=1e-15)
    # four times the molar mass: twice the mass, half the volume
    heavy = gas_flow(kv, p1, p1 * ratio, 300.0, 4.0 * 0.029, xt=xt, **known)
    assert_allclose(heavy, 2.0 * one, rtol=1e-14)
    actual = [
        gas_flow(kv, p1, p1 * ratio, 300.0, mass, xt=xt, basis="actual", **known) for mass in (0.029, 0.116)
    ]
    assert_allclose(actual[1], 0.5 * actual[0], rtol=1e-14)
