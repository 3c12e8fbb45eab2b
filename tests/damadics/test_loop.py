# SPDX-License-Identifier: BSD-3-Clause
"""Example IV, the valve in its loop: where the level rests, that it does, and what faults do to it."""

import numpy as np
import pytest
from scipy.optimize import brentq

from sklvalve.damadics import Actuator, ActuatorSimulator, LevelLoop, Profile
from sklvalve.damadics.flow import mass_flow

QUIET = ActuatorSimulator(noise=False)


def at_rest(setpoint, bypass=0.0):
    """Level [m], flow [t/h] and share of closing where nothing moves, from the balances alone.

    What leaves the tank comes through the valve; the positioner's feedback is asin((x - S/2) / S) / 60 deg;
    the controller leaves the share of closing over its gain.
    """
    par, f = Actuator().packed(), np.zeros(20)
    f[18] = bypass
    span, stroke = 2.0, Actuator().stroke

    def balance(closed):
        command = 0.5 + np.degrees(np.arcsin(closed - 0.5)) / 60.0
        level = span * (setpoint + command / 100.0)
        leaves = 3600.0 * 0.0013 * np.sqrt(2.0 * 9.81 * level)
        p1, p2 = 3.5e6 - 1000.0 * leaves, 2.2e6 + 1e4 * (5.0 + level) + 100.0 * leaves
        return level, leaves, mass_flow(closed, p1, p2, 20.0, f, par) - leaves

    closed = brentq(lambda x: balance(x)[2], 0.05, 0.97)
    return *balance(closed)[:2], closed, closed * stroke


@pytest.fixture(scope="module")
def nominal():
    return QUIET.simulate(900.0, LevelLoop())


def test_the_level_rests_where_the_balances_say(nominal):
    level, flow, closed, _ = at_rest(0.5)
    later = nominal["t"] >= 300.0
    assert nominal["level"][later].mean() == pytest.approx(level, abs=1e-3)
    assert nominal["F_tph"][later].mean() == pytest.approx(flow, rel=2e-3)
    assert nominal["X"][later].mean() == pytest.approx(closed, abs=2e-3)
    # the offset of a proportional controller: half a command over a gain of 100, of 2 m
    assert 0.005 < level - 1.0 < 0.02


@pytest.mark.parametrize(("start", "settled"), [(0.2, 300.0), (0.9, 300.0), (1.8, 3600.0)])
def test_the_loop_is_stable_from_wherever_it_starts(start, settled, nominal):
    """A tank too full drains through its hole alone, some 0.3 mm a second."""
    run = QUIET.simulate(settled + 300.0, LevelLoop(level=start))
    later = run["t"] >= settled
    assert run["level"][0] == start
    assert np.ptp(run["level"][later]) < 2e-3
    assert run["level"][later].mean() == pytest.approx(nominal["level"][600:].mean(), abs=1e-3)


@pytest.mark.parametrize("setpoint", [0.3, 0.7])
def test_the_level_follows_the_set_point(setpoint):
    run = QUIET.simulate(2400.0, LevelLoop(setpoint=setpoint))
    assert run["level"][2100:].mean() == pytest.approx(at_rest(setpoint)[0], abs=2e-3)


def test_an_open_bypass_is_made_up_for_by_the_valve(nominal):
    run = QUIET.simulate(900.0, LevelLoop(), [Profile("f18", 0.25, 300.0)])
    before, later = run["t"] < 300.0, run["t"] >= 600.0
    np.testing.assert_array_equal(run["X"][before], nominal["X"][before])
    level, flow, closed, _ = at_rest(0.5, bypass=0.25)
    assert run["X"][later].mean() == pytest.approx(closed, abs=2e-3)
    assert run["X"][later].mean() > nominal["X"][later].mean() + 0.1
    assert run["level"][later].mean() == pytest.approx(level, abs=1e-3)
    assert run["F_tph"][later].mean() == pytest.approx(flow, rel=2e-3)


def test_a_fault_of_the_flow_meter_does_not_enter_the_loop(nominal):
    run = QUIET.simulate(900.0, LevelLoop(), [Profile("f19", -0.5, 300.0)])
    for signal in ("level", "x", "F_tph", "CV"):
        np.testing.assert_array_equal(run[signal], nominal[signal])
    assert run["F"][800] == pytest.approx(1.5 * nominal["F"][800])


def test_pressures_answer_the_flow(nominal):
    flow = nominal["F_tph"][600:]
    np.testing.assert_allclose(nominal["P1"][600:] * 4e6, 3.5e6 - 1000.0 * flow, rtol=1e-4)
    known = 2.2e6 + 1e4 * (5.0 + nominal["level"][600:]) + 100.0 * flow
    np.testing.assert_allclose(nominal["P2"][600:] * 4e6, known, rtol=1e-4)


def test_noise_of_the_level_is_in_the_loop():
    runs = [ActuatorSimulator().simulate(400.0, LevelLoop(), random_state=seed) for seed in (0, 0, 1)]
    np.testing.assert_array_equal(runs[0]["level"], runs[1]["level"])
    assert not np.array_equal(runs[0]["level"], runs[2]["level"])
    later = runs[0]["t"] >= 200.0
    error = runs[0]["PV"] - runs[0]["level"] / 2.0
    assert np.std(error[later]) == pytest.approx(1.414e-3, rel=0.2)
    assert np.std(runs[0]["CV"][later]) > 1e-3
    assert runs[0]["level"][later].mean() == pytest.approx(at_rest(0.5)[0], abs=3e-3)


def test_pieces_of_time_do_not_show(monkeypatch, nominal):
    monkeypatch.setattr("sklvalve.damadics.simulator._CHUNK", 7.0)
    run = QUIET.simulate(900.0, LevelLoop())
    for signal in ("level", "x", "F_tph", "CV"):
        np.testing.assert_array_equal(run[signal], nominal[signal])


def test_bad_loops_get_one_plain_sentence():
    with pytest.raises(ValueError, match=r"setpoint must lie in \[0, 1\], got 1.5"):
        LevelLoop(setpoint=1.5)
    with pytest.raises(ValueError, match=r"level must lie in \[0, 2\], got 2.5"):
        LevelLoop(level=2.5)
