# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's actuator against a run of the original generator, and each fault by what it changes."""

import re

import numpy as np
import pytest

from sklvalve.damadics import FAULTS, SCENARIOS, Actuator, ActuatorSimulator, Profile, preset, scenario_of
from sklvalve.damadics.excitation import Recorded, step_test

QUIET = ActuatorSimulator(noise=False)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.fixture(scope="module")
def nominal():
    return QUIET.simulate(1500.0)


def test_a_run_of_the_original_generator_is_met_within_its_noise(data_folder):
    known = np.genfromtxt(
        data_folder / "damadics" / "dablib_dgen_f13_incipient_run.csv", delimiter=",", names=True
    )
    run = QUIET.simulate(float(len(known)), faults=[scenario_of("f13_incipient").profile])
    np.testing.assert_allclose(run["f13"], known["f13"], atol=1e-6)
    before = run["t"] < 900.0
    for rows, of_x, of_f in ((before, 0.0018, 0.0022), (~before, 0.0025, 0.0020)):
        assert rms((run["X"] - known["Xn"])[rows]) <= of_x
        assert rms((run["F"] - known["Fn"])[rows]) <= of_f
    # what is left is the noise of its sensors
    assert rms((run["X"] - known["Xn"])[before]) == pytest.approx(1.414e-3, rel=0.05)


def test_the_step_of_example_one(data_folder):
    known = np.genfromtxt(data_folder / "damadics" / "check_step_exampleI.csv", delimiter=",", names=True)
    run = QUIET.simulate(float(known["t_s"][-1]) + 0.2, step_test, step=0.2)
    assert rms(run["x"] / 0.0381 - known["X"]) <= 5e-4
    assert rms(run["F_tph"] - known["F_tph"]) <= 0.25


def test_every_fault_moves_stem_and_flow_as_far_as_it_should(data_folder, nominal):
    table = (data_folder / "damadics" / "check_fault_deviation_table.txt").read_text()
    rows = re.findall(r"(f\d+) ([+-]?[\d.]+) rms dX=([\d.]+).*?dF'=([\d.]+)", table)
    assert len({name for name, *_ in rows}) == len(FAULTS)
    later = nominal["t"] >= 905.0
    for name, strength, *known in rows:
        run = QUIET.simulate(1500.0, faults=[Profile(name, float(strength), 900.0)])
        for signal, value in zip(("X", "F"), map(float, known), strict=True):
            found = rms((run[signal] - nominal[signal])[later])
            assert found == pytest.approx(value, rel=0.05, abs=1e-3), (name, strength, signal)


def test_f14_changes_what_is_shown_of_the_chamber_alone(nominal):
    run = QUIET.simulate(1500.0, faults=[scenario_of("f14_big").profile])
    for signal in ("CV", "P1", "P2", "T1", "X", "F"):
        np.testing.assert_array_equal(run[signal], nominal[signal])
    later = run["t"] > 900.0
    np.testing.assert_allclose(run["Ps_shown"][later], 1.75 * nominal["Ps_shown"][later])
    other = ActuatorSimulator(noise=False, sign="help").simulate(
        1500.0, faults=[scenario_of("f14_big").profile]
    )
    np.testing.assert_allclose(other["Ps_shown"][later], 0.25 * nominal["Ps_shown"][later])


def test_there_are_forty_four_scenarios():
    assert len(SCENARIOS) == 44
    assert SCENARIOS["f2_incipient"].horizon == 85500.0
    assert SCENARIOS["f19_small"].profile.strength == -0.25
    with pytest.raises(ValueError, match="scenario must be one of f1_small"):
        scenario_of("f20_small")


def test_noise_is_that_of_the_transducers(nominal):
    run = ActuatorSimulator().simulate(1500.0, random_state=0)
    again = ActuatorSimulator().simulate(1500.0, random_state=0)
    np.testing.assert_array_equal(run["X"], again["X"])
    assert rms(run["P1"] - nominal["P1"]) == pytest.approx(1.414e-3, rel=0.1)
    np.testing.assert_array_equal(run["CV"], nominal["CV"])


def test_pieces_of_time_do_not_show(monkeypatch, nominal):
    monkeypatch.setattr("sklvalve.damadics.simulator._CHUNK", 7.0)
    run = QUIET.simulate(1500.0)
    for signal in ("x", "F_tph", "Ps"):
        np.testing.assert_allclose(run[signal], nominal[signal], rtol=1e-9)


def test_recorded_drivers_and_presets():
    t = np.arange(0.0, 60.0)
    drivers = {"CV": np.full(60, 0.6), "P1": 9e5, "P2": np.linspace(4e5, 5e5, 60), "T1": 90.0}
    run = ActuatorSimulator(preset(1), noise=False).simulate(60.0, Recorded(t, drivers))
    assert run["X"][-1] == pytest.approx(0.6, abs=0.02)
    assert preset(3) == Actuator()
    with pytest.raises(ValueError, match="actuator must be 1, 2 or 3"):
        preset(4)
    with pytest.raises(ValueError, match="P1 must be finite"):
        Recorded(t, drivers | {"P1": np.full(60, np.nan)})


def test_bad_input_gets_one_plain_sentence():
    with pytest.raises(ValueError, match="there is no P2"):
        QUIET.simulate(10.0, lambda t: {"CV": 0.5, "P1": 3e6, "T1": 20.0})
    with pytest.raises(ValueError, match="multiple of"):
        QUIET.simulate(10.0, step=0.001)
    with pytest.raises(ValueError, match="at least one step"):
        QUIET.simulate(0.0)
    with pytest.raises(ValueError, match=r"strength of f1 must lie in \[0, 1\]"):
        Profile("f1", -0.5)
    with pytest.raises(ValueError, match="fault must be one of f1 to f19"):
        Profile("f20", 0.5)
    with pytest.raises(ValueError, match="end after it begins"):
        Profile("f4", 0.5, begins=10.0, ends=5.0)
    with pytest.raises(ValueError, match="sign must be"):
        ActuatorSimulator(sign="other")
