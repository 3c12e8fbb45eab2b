# SPDX-License-Identifier: BSD-3-Clause
"""Effects of line and meters against computations of their own, and what holds for all of the flow side."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import minimize_scalar

from sklvalve.mismatch.effects._reynolds import _between_the_laws
from sklvalve.mismatch.effects.flow_inertia import water_column
from sklvalve.simulation import Tolerance

from .hand_chain import BY_KEY, apply, chain_of

# ---- line


def test_a_line_takes_the_share_of_the_drop_that_resistances_in_series_take():
    kv, loss, rated = 6.0, 1.5, 10.0
    chain = chain_of(1, trim=SimpleNamespace(rated=rated, known=True))
    # drops add: (Q/kv)2 for the valve, loss (Q/rated)2 for the line
    together = 1.0 / np.sqrt(1.0 / kv**2 + loss / rated**2)
    assert apply("line_loss", [kv], {"loss": loss}, chain)[0] == pytest.approx(together, rel=1e-12)
    assert BY_KEY["line_loss"].family == BY_KEY["piping_reducers"].family != ""


def test_column_of_water_obeys_its_equation_of_motion():
    rng, n = np.random.default_rng(0), 12
    steady = rng.uniform(0.005, 0.02, n)
    drop = rng.uniform(0.5e5, 3e5, n)
    step, inertance = rng.uniform(0.5, 3.0, n), np.full(n, 3e7)
    made = water_column(steady, step, drop, inertance)
    assert made[0] == steady[0]
    for k in range(1, n):
        resistance = drop[k] / steady[k] ** 2

        def accelerated(t, q, k=k, resistance=resistance):
            return (drop[k] - resistance * q * np.abs(q)) / inertance[k]

        solved = solve_ivp(accelerated, (0.0, step[k]), [made[k - 1]], rtol=1e-10, atol=1e-14)
        assert made[k] == pytest.approx(solved.y[0, -1], rel=1e-7)


def test_column_of_water_is_at_its_new_flow_behind_a_long_gap():
    steady = np.r_[0.01, np.full(60, np.nan), 0.02, 0.02]
    made = water_column(steady, np.ones(63), np.full(63, 1e5), np.full(63, 1e7))
    np.testing.assert_allclose(made[-2:], 0.02, rtol=1e-6)


def test_column_of_water_bears_gaps_shut_valves_and_reversals():
    steady = np.array([0.01, np.nan, 0.01, 0.0, 0.01, -0.01, -0.02])
    made = water_column(steady, np.ones(7), np.full(7, 1e5), np.full(7, 1e6))
    assert np.isnan(made[1])
    assert made[3] == 0.0
    assert made[5] == -0.01
    assert -0.02 < made[6] < -0.01
    np.testing.assert_array_equal(water_column(steady, np.ones(7), np.full(7, 1e5), np.zeros(7)), steady)


def test_inertia_within_the_response_of_a_meter_is_calibration():
    effect, chain = BY_KEY["flow_inertia"], chain_of()
    # lag = rho (L/A) Q / (2 dp), here 1000 * l * 0.01 / 4e5
    for lag in (2.0, 4.0):
        own = {"length_over_area": lag * 4e4}
        assert effect.beyond_tolerance(own, chain, Tolerance(), False) is (lag > 3.0)
    # lags of 5 and 20 s would be lines of 2e5 and 8e5 1/m; at 0.01 m3/s a kilometre at 2 m/s is 2e5 1/m
    (quantity,) = effect.quantities(chain)
    assert quantity.high == pytest.approx(1000.0 * 2.0 / 0.01, rel=0.02)
    np.testing.assert_allclose(quantity.starts, 0.5 * quantity.high, rtol=1e-9)


@pytest.mark.parametrize("alpha", [0.05, 0.3])
def test_bubbles_expand_on_their_way(alpha):
    p1 = 5e5
    p2 = np.array([4.9e5, 4e5, 2e5, 1e5, 5e5])
    chain = chain_of(p1=np.full(5, p1), p2=p2)

    def velocity_over_volume(p):
        # per volume of mixture at the inlet: bubbles at constant temperature, the liquid as it is
        work, _ = quad(lambda q: 1.0 - alpha + alpha * p1 / q, p, p1, epsabs=0.0, epsrel=1e-11)
        return np.sqrt(2.0 * work) / (1.0 - alpha + alpha * p1 / p)

    best = minimize_scalar(lambda p: -velocity_over_volume(p), bounds=(1e4, 4.99e5), method="bounded").x
    expected = [velocity_over_volume(max(p, best)) / np.sqrt(2.0 * (1 - alpha) * (p1 - p)) for p in p2[:4]]
    made = apply("two_phase", np.ones(5), {"gas_share": alpha}, chain)
    np.testing.assert_allclose(made[:4], expected, rtol=1e-4)
    assert made[4] == 1.0
    chain.recording.mass_flow = True
    by_mass = apply("two_phase", np.ones(5), {"gas_share": alpha}, chain)
    np.testing.assert_allclose(by_mass[:4], (1.0 - alpha) * made[:4], rtol=1e-12)


# ---- measurement


def test_drift_of_zero_and_of_span():
    clock = np.array([0.0, 900.0, 1800.0, 3600.0, 7200.0])
    begun = chain_of(clock=clock, onsets={"flow_meter_drift": 900.0, "flow_meter_drift_span": 900.0})
    made = apply("flow_meter_drift", np.full(5, 0.01), {"drift": 0.004}, begun)
    np.testing.assert_allclose(made, [0.01, 0.01, 0.011, 0.013, 0.017], rtol=1e-12)
    made = apply("flow_meter_drift_span", np.full(5, 0.01), {"rate": -0.2}, begun)
    np.testing.assert_allclose(made, [0.01, 0.01, 0.0095, 0.0085, 0.0065], rtol=1e-12)
    assert BY_KEY["flow_meter_drift_span"].family == BY_KEY["sedimentation"].family != ""


def test_damping_answers_a_step_as_a_first_order_lag():
    chain = chain_of(31)
    made = apply("sensor_lag", np.r_[0.0, np.ones(30)], {"lag": 8.0}, chain)
    np.testing.assert_allclose(made, 1.0 - np.exp(-np.arange(31.0) / 8.0), rtol=1e-12)
    effect = BY_KEY["sensor_lag"]
    assert [effect.beyond_tolerance({"lag": s}, chain, Tolerance(), False) for s in (2.0, 5.0)] == [
        False,
        True,
    ]


@pytest.mark.parametrize("fails_open", [False, True])
@pytest.mark.parametrize("gain", [-0.1, 0.25])
def test_span_of_the_position_turns_about_the_rest_of_the_spring(fails_open, gain):
    chain, stem = chain_of(air_closes=fails_open), np.array([0.0, 0.25, 0.5, 1.0, np.nan])
    sensor, looped = BY_KEY["position_sensor_gain"], BY_KEY["position_sensor_gain_loop"]
    shown = sensor.apply(stem, {"gain": gain}, chain)
    rest = 3 if fails_open else 0
    assert shown[rest] == stem[rest]
    np.testing.assert_allclose(np.diff(shown[:4]), (1.0 + gain) * np.diff(stem[:4]), rtol=1e-12)
    np.testing.assert_allclose(sensor.invert(shown, {"gain": gain}, chain), stem, rtol=1e-12)
    np.testing.assert_allclose(looped.apply(shown, {"gain": gain}, chain), stem, rtol=1e-12)
    beyond = [sensor.beyond_tolerance({"gain": g}, chain, Tolerance(), False) for g in (0.005, -0.02)]
    assert beyond == [False, True]


# ---- all of them

SIZED = {
    "erosion": ("wear_kv", 1.0),
    "sedimentation": ("rate", -1.0),
    "external_leakage": ("leak_kv", 1.0),
    "external_leakage_outlet": ("leak_kv", -1.0),
    "cavitation": ("loss", -1.0),
    "flashing": ("swelling", 1.0),
    "viscous_flow": ("viscosity", -1.0),
    "viscosity_change": ("viscosity", -1.0),
    "gas_expansion": ("xt", 1.0),
    "density_change": ("ratio", -1.0),
    "density_change_thermal": ("expansion", 1.0),
    "line_loss": ("loss", -1.0),
    "flow_meter_drift": ("drift", 1.0),
    "flow_meter_drift_span": ("rate", 1.0),
    "position_sensor_gain_loop": ("gain", -1.0),
    "clogging_closing": ("limit", 1.0),
}


@pytest.mark.parametrize("key", SIZED)
@given(data=st.data())
@settings(max_examples=20, deadline=None, derandomize=True)
def test_more_of_it_does_more_and_no_size_does_the_absurd(key, data):
    effect, (name, sign) = BY_KEY[key], SIZED[key]
    warm = np.linspace(293.15, 333.15, 5)
    chain = chain_of(p2=np.linspace(5e5, 2e4, 5), vapour=np.full(5, 9e4), temperature=warm)
    sizes, own = None, {}
    for q in effect.quantities(chain):
        inside = st.floats(q.low, q.high)
        if q.name == name:
            sizes = sorted(data.draw(st.tuples(inside, inside)))
        else:
            own[q.name] = data.draw(inside)
    value = np.linspace(0.0, 1.0, 5) if effect.stage in ("stem", "plug") else np.full(5, 0.01)
    value = 10.0 * value if effect.stage == "capacity" else value
    less, more = (effect.apply(value, own | {name: size}, chain) for size in sizes)
    assert np.all(sign * (more - less) >= -1e-12)
    assert np.isfinite(more).all()
    if effect.stage in ("capacity", "flow") and key != "external_leakage_outlet":
        assert np.all(more >= 0.0)


@pytest.mark.parametrize("sharpness", [0.6, 1.2, 2.0, 8.0])
def test_between_the_laws_a_flow_solves_its_own_equation(sharpness):
    laminar = np.array([0.0, 1e-3, 0.5, 1.0, 3.0, 1e3])
    share = _between_the_laws(laminar, sharpness)
    assert share[0] == 1.0
    asked = share[1:] ** -sharpness
    assert asked == pytest.approx(1.0 + (laminar[1:] * share[1:]) ** (-sharpness / 2.0), rel=1e-12)


def test_a_flow_that_hardly_moves_is_laminar_and_overflows_nothing():
    with np.errstate(all="raise"):
        # its square root's square would be beyond them
        assert _between_the_laws(np.array([1e-100]), 4.0) == pytest.approx([1e-100], rel=1e-9)
        assert 0.0 <= _between_the_laws(np.array([1e-60]), 40.0)[0] < 1e-12
