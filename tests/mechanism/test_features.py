# SPDX-License-Identifier: BSD-3-Clause
"""Every feature is what the function of its name gives, for a liquid and for a gas."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import GridSearchCV
from sklearn.pipeline import make_pipeline

import sklvalve.mechanism as m
from sklvalve.mechanism.features import FEATURES
from tests.mechanism.valves import by_position, duties

GAS_ONLY = {"x", "x_choked", "expansion_factor", "f_gamma", "xt", "xtp"}
LIQUID_ONLY = {"pressure_ratio", "p_vc", "sigma", "xf", "xfz", "vapour_pressure", "ff"}
FL, FD, XT = [[0.0, 0.9], [1.0, 0.7]], [[0.0, 0.5], [1.0, 0.3]], [[0.0, 0.75], [1.0, 0.6]]
BORES = {"nominal_size": 0.05, "inlet_pipe": 0.08, "outlet_pipe": 0.1}
GAS = {"gamma": 1.3, "compressibility": 0.95, "basis": "normal", "dynamic_viscosity": 2e-5}


def table(valve, X):
    return dict(zip(valve.features_, valve.transform(X).T, strict=True))


def between(table, opening):
    (_, first), (_, last) = table
    return first + (last - first) * opening


def with_facts(**settings):
    facts = {"fl": FL, "fd": FD, "warn": False, **BORES, **settings}
    return by_position(**facts)


def liquid_valve(**settings):
    """A juice so thick that the small valve is in every regime."""
    facts = {"fluid": "sugar juice", "brix": 72.0, "kv_rated": 20.0, "shutoff": 0.01, "leakage": 1e-3}
    return with_facts(**{**facts, **settings})


def gas_valve(**settings):
    return with_facts(fluid="gas", molar_mass=0.044, xt=XT, **GAS, **settings)


def test_liquid():
    X = duties()
    temperature, opening, p1, p2, flow = X.T
    brix, up, back = 72.0, np.maximum(p1, p2), p2 > p1
    found = table(liquid_valve(features=[name for name in FEATURES if name not in GAS_ONLY]).fit(X), X)
    p_vapour, density = m.juice_vapour_pressure(temperature, brix), m.juice_density(temperature, brix)
    viscosity = m.juice_kinematic_viscosity(temperature, brix)
    trim = {"characteristic": "equal_percentage", "rangeability": 30.0, "shutoff": 0.01, "leakage": 1e-3}
    phi = m.relative_capacity(opening, **trim)
    kv, fl, fd = 20.0 * phi, between(FL, opening), between(FD, opening)
    boiling = {"p_vapour": p_vapour}
    viscous = {"viscosity": viscosity, **BORES, **boiling, "warn": False}
    known = {"fl": fl, "fd": fd, "kv_rated": 20.0, **viscous}
    ff = 0.96 - 0.28 * np.sqrt(p_vapour / 22.064e6)
    pipe_before = np.where(back, 0.1, 0.08)
    zeta_sum, zeta_inlet = m.fitting_loss(0.05, pipe_before, np.where(back, 0.08, 0.1))
    fp = m.piping_factor(kv, 0.05, zeta_sum)
    flp = m.combined_recovery_factor(kv, 0.05, zeta_inlet, fl)
    dp_choked = m.choked_pressure_drop(up, p_vapour, 22.064e6, flp / fp)
    own = m.liquid_flow(kv, p1, p2, density, **known)
    reynolds = m.valve_reynolds_number(own, kv, viscosity, fl=fl, fd=fd, inlet_pipe=pipe_before)
    xfz = m.incipient_xfz(kv, fl, fd, p1=up)
    quiet = {name: value for name, value in known.items() if name != "warn"}
    expected = {
        "opening": opening,
        "dp": p1 - p2,
        "sqrt_dp_over_density": np.sign(p1 - p2) * np.sqrt(np.abs(p1 - p2) / density),
        "pressure_ratio": (p1 - p2) / (up - ff * p_vapour),
        "dp_choked": dp_choked,
        "choked": np.abs(p1 - p2) >= dp_choked,
        "state": m.liquid_state(kv, p1, p2, density, xfz=xfz, **quiet),
        "p_vc": m.vena_contracta_pressure(p1, p2, fl, kv=kv, **boiling, **BORES),
        "sigma": m.cavitation_index(p1, p2, p_vapour),
        "xf": m.pressure_ratio_xf(p1, p2, p_vapour),
        "xfz": xfz,
        "density": density,
        "vapour_pressure": p_vapour,
        "kinematic_viscosity": viscosity,
        "ff": ff,
        "relative_capacity": phi,
        "kv": kv,
        "required_kv": m.liquid_kv(flow, p1, p2, density, **known),
        "required_opening": m.opening_for_flow(
            flow, p1, p2, density, kv_rated=20.0, **trim, fl=FL, fd=FD, **viscous
        ),
        "fl": fl,
        "fd": fd,
        "fp": fp,
        "flp": flp,
        "reynolds": reynolds,
        "fr": m.reynolds_factor(reynolds, m.trim_parameter(kv, 0.05, kv_rated=20.0), fl),
        "flow": own,
        "mass_flow": own * density,
        "outlet_pressure": m.liquid_outlet_pressure(flow, kv, p1, density, **known),
        "inlet_pressure": m.liquid_inlet_pressure(flow, kv, p2, density, **known),
    }
    assert set(expected) == set(found) == set(FEATURES) - GAS_ONLY
    for name, values in expected.items():
        assert_allclose(found[name], values, rtol=1e-11, err_msg=name)
    assert {0, 2, 3, 4, 5} <= set(found["state"])
    assert 0.0 < found["fr"][found["dp"] != 0.0].min() < 0.99 < found["fr"].max()
    assert found["fp"].min() < 0.99


def test_gas():
    X = duties()
    temperature, opening, p1, p2, flow = X.T
    up, back = np.maximum(p1, p2), p2 > p1
    flow = X[:, 4] = np.sign(p1 - p2) * 0.2 * opening
    valve = gas_valve(features=[name for name in FEATURES if name not in LIQUID_ONLY]).fit(X)
    found = table(valve, X)
    trim = {"characteristic": "equal_percentage", "rangeability": 30.0}
    phi = m.relative_capacity(opening, **trim)
    kv, fl, fd, xt = 40.0 * phi, between(FL, opening), between(FD, opening), between(XT, opening)
    gas, here = {**GAS, **BORES, "warn": False}, (temperature, 0.044)
    known = {"xt": xt, "fl": fl, "fd": fd, "kv_rated": 40.0, **gas}
    pipe_before = np.where(back, 0.1, 0.08)
    zeta_sum, zeta_inlet = m.fitting_loss(0.05, pipe_before, np.where(back, 0.08, 0.1))
    x = np.abs(p1 - p2) / up
    xtp = m.combined_drop_ratio_factor(kv, 0.05, zeta_sum, zeta_inlet, xt)
    x_choked = m.choked_drop_ratio(1.3, xtp)
    density = m.gas_density(up, *here, 0.95)
    own = m.gas_flow(kv, p1, p2, *here, **known)
    mass = m.gas_mass_flow(own, "normal", up, *here, 0.95)
    reynolds = m.valve_reynolds_number(mass, kv, 2e-5, fl=fl, fd=fd, inlet_pipe=pipe_before)
    silent = {name: value for name, value in known.items() if name not in ("warn", "basis")}
    expected = {
        "opening": opening,
        "dp": p1 - p2,
        "sqrt_dp_over_density": np.sign(p1 - p2) * np.sqrt(np.abs(p1 - p2) / density),
        "dp_choked": x_choked * up,
        "choked": x >= x_choked,
        "state": m.gas_state(kv, p1, p2, *here, **silent),
        "x": x,
        "x_choked": x_choked,
        "expansion_factor": m.expansion_factor(x, x_choked),
        "f_gamma": np.full(200, 1.3 / 1.4),
        "density": density,
        "kinematic_viscosity": 2e-5 / density,
        "relative_capacity": phi,
        "kv": kv,
        "required_kv": m.gas_kv(flow, p1, p2, *here, **known),
        "required_opening": m.opening_for_gas_flow(
            flow, p1, p2, *here, kv_rated=40.0, **trim, xt=XT, fl=FL, fd=FD, **gas
        ),
        "fl": fl,
        "fd": fd,
        "xt": xt,
        "fp": m.piping_factor(kv, 0.05, zeta_sum),
        "flp": m.combined_recovery_factor(kv, 0.05, zeta_inlet, fl),
        "xtp": xtp,
        "reynolds": reynolds,
        "fr": m.reynolds_factor(reynolds, m.trim_parameter(kv, 0.05, kv_rated=40.0), fl),
        "flow": own,
        "mass_flow": mass,
        "outlet_pressure": m.gas_outlet_pressure(flow, kv, p1, *here, **known),
        "inlet_pressure": m.gas_inlet_pressure(flow, kv, p2, *here, **known),
    }
    assert set(expected) == set(found) == set(FEATURES) - LIQUID_ONLY
    for name, values in expected.items():
        assert_allclose(found[name], values, rtol=1e-11, err_msg=name)
    assert {0, 3, 5} <= set(found["state"])


def test_default_features_of_a_gas():
    valve = gas_valve().fit(duties())
    assert valve.features_ == ["relative_capacity", "dp", "sqrt_dp_over_density", "x", "density"]


def test_a_measured_ratio_of_cavitation_decides_the_state():
    X = duties()
    often = table(by_position(xfz=0.05, features=["state"], warn=False).fit(X), X)["state"]
    never = table(by_position(features=["state"], warn=False).fit(X), X)["state"]
    late = [[0.0, 0.99], [1.0, 0.99]]
    rarely = table(by_position(xfz=late, features=["state"], warn=False).fit(X), X)["state"]
    assert_array_equal(never, rarely)
    assert (often == 4).sum() > 20 > (never == 4).sum() == 0


def test_by_the_letter():
    X = duties()
    X[:, 1] = 0.3
    letter = table(liquid_valve(strict=True, features=["flow", "reynolds"]).fit(X), X)
    smooth = table(liquid_valve(features=["flow", "reynolds"]).fit(X), X)
    slow = (smooth["reynolds"] < 1e4) & (smooth["flow"] != 0.0)
    assert slow.any()
    # the letter has no reducers in flow that is not turbulent
    assert not np.isclose(letter["flow"][slow], smooth["flow"][slow], rtol=1e-6).all()


def test_viscous_liquid_without_vapour_pressure_does_not_choke():
    X = duties()
    oil = {"fluid": "oil", "density": 900.0, "kinematic_viscosity": 2e-5}
    out = table(with_facts(**oil, features=["flow", "fr", "state"]).fit(X), X)
    assert np.isfinite(out["flow"]).all()
    assert out["fr"].min() < 0.9
    assert out["state"].max() == 3


@pytest.mark.parametrize("make", [liquid_valve, gas_valve])
@pytest.mark.parametrize("output", ["flow", "outlet_pressure"])
@pytest.mark.parametrize("bare", [False, True])
def test_the_mechanism_is_its_own_inverse_with_all_facts(make, output, bare):
    X = duties()
    own = make(output="flow").fit(X)
    X[:, 4] = own.predict(X)
    none = {"inlet_pipe": None, "outlet_pipe": None, "fd": None if make is liquid_valve else FD}
    valve = make(output=output, **(none if bare else {})).fit(X)
    kv = by_position(features=["kv"]).fit_transform(X)[:, 0] * 0.6
    y = valve.forward(X, kv)
    known = np.isfinite(y) & (X[:, 2] != X[:, 3])
    assert known.sum() > 30
    again = valve.invert(X, y)
    found = known & np.isfinite(again)
    assert found.sum() > 0.9 * known.sum()
    assert_allclose(again[found], kv[found], rtol=1e-6)


@pytest.mark.parametrize("make", [liquid_valve, gas_valve])
@pytest.mark.parametrize("output", ["flow", "outlet_pressure"])
def test_sensitivity_is_the_derivative_with_all_facts(make, output):
    X = duties()
    X[:, 4] = 0.5 * make().fit(X).predict(X)
    valve = make(output=output).fit(X)
    kv = by_position(features=["kv"]).fit_transform(X)[:, 0] * 0.5
    step = 1e-6 * kv
    slope = (valve.forward(X, kv + step) - valve.forward(X, kv - step)) / (2.0 * step)
    found = valve.sensitivity(X, kv)
    known = np.isfinite(slope)
    assert known.sum() > 100
    # steep where choking is near, and without a derivative at a change of regime
    assert np.isclose(found, slope, rtol=1e-3, atol=1e-9)[known].mean() > 0.97


def test_slope_of_a_shut_valve():
    X = duties()[20:40]
    slope = liquid_valve(kv_rated=None).fit(X).sensitivity(X, 0.0)
    assert_array_equal(np.sign(slope), np.sign(X[:, 2] - X[:, 3]))


@pytest.mark.parametrize("library", ["pandas", "polars"])
@pytest.mark.parametrize("make", [liquid_valve, gas_valve])
def test_set_output_of_everything(library, make):
    pytest.importorskip(library)
    names = [name for name in FEATURES if name not in (GAS_ONLY if make is liquid_valve else LIQUID_ONLY)]
    X = duties()
    frame = make(features=names).set_output(transform=library).fit_transform(X)
    assert type(frame).__module__.startswith(library)
    assert list(frame.columns) == names
    assert_array_equal(frame.to_numpy(), make(features=names).fit_transform(X))


def test_a_grid_finds_the_facts():
    X = duties()
    y = liquid_valve().fit(X).predict(X)
    model = make_pipeline(liquid_valve(features=["flow"]), LinearRegression())
    grid = {"valvemechanismtransformer__brix": [60.0, 72.0], "valvemechanismtransformer__fl": [0.6, FL]}
    search = GridSearchCV(model, grid, cv=3, error_score="raise").fit(X, y)
    assert list(search.best_params_.values()) == [72.0, FL]


class TestRefused:
    @pytest.mark.parametrize(
        ("settings", "message"),
        [
            ({"fluid": "gas", "molar_mass": 0.029, "gamma": 1.4}, "give xt="),
            ({"fluid": "gas", "gamma": 1.4, "xt": 0.7}, "molar mass of the gas .* give molar_mass="),
            ({"fluid": "gas", "molar_mass": 0.029, "xt": 0.7}, "give gamma="),
            ({"molar_mass": 0.029}, "molar_mass does not belong to fluid='water'"),
            ({"fluid": "gas", "brix": 15.0}, "brix does not belong to fluid='gas'"),
            ({"inlet_pipe": 0.1}, "a pipe is given without nominal_size"),
            ({"features": ["x"]}, "there is no 'x' of a liquid"),
            ({"features": ["reynolds"]}, "give fd="),
            ({"features": ["reynolds"], "fd": 0.4}, "give nominal_size="),
            ({"fluid": "sugar juice"}, "needs its brix"),
        ],
    )
    def test_in_one_sentence(self, settings, message):
        with pytest.raises(ValueError, match=message):
            by_position(**settings).fit(duties())

    def test_a_gas_needs_its_temperature(self):
        with pytest.raises(ValueError, match="this needs the role 'temperature'"):
            gas_valve(temperature=None).fit(duties())

    def test_an_unknown_feature_lists_all(self):
        with pytest.raises(ValueError, match="use some of " + ", ".join(FEATURES)):
            by_position(features=["sigme"]).fit(duties())
