# SPDX-License-Identifier: BSD-3-Clause
"""Frames of the simulated actuator: what they hold, that a seed repeats them, that a recording takes them."""

import sys

import numpy as np
import pytest

from sklvalve.damadics import (
    ActuatorSimulator,
    LevelLoop,
    Profile,
    course,
    make_damadics,
    preset,
    valve_sheet,
)
from sklvalve.datasets import make_damadics as of_datasets
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import Recording, Valve, screen_recording
from sklvalve.simulation import ValveSimulation

pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')

SIGNALS = ["time", "CV", "P1", "P2", "T1", "X", "F", "F_in_range", "fault"]
MEASURED = ["P1", "P2", "T1", "X", "F"]


@pytest.fixture(scope="module")
def sound():
    return make_damadics(extended=True, noise=False)


def test_a_frame_holds_the_six_signals_in_engineering_units(sound):
    assert list(make_damadics(duration=10.0).columns) == SIGNALS
    run = ActuatorSimulator(noise=False).simulate(1500.0)
    for column, factor in (("CV", 100.0), ("P1", 4e3), ("P2", 4e3), ("T1", 200.0), ("X", 100.0), ("F", 40.0)):
        np.testing.assert_allclose(sound[column], factor * run[column], rtol=1e-12)
    np.testing.assert_array_equal(sound["time"], np.arange(1500.0))
    assert (sound["fault"] == 0.0).all()
    assert of_datasets is make_damadics


def test_a_seed_repeats_a_frame_and_another_changes_its_noise_alone():
    first, again, other = (make_damadics("f12_small", duration=950.0, random_state=s) for s in (1, 1, 2))
    assert first.equals(again)
    for column in MEASURED:
        assert not np.array_equal(first[column], other[column])
    for column in ("time", "CV", "fault"):
        np.testing.assert_array_equal(first[column], other[column])
    # a transducer's noise is 0.0014 of its span
    assert np.std(first["P1"] - other["P1"]) == pytest.approx(np.sqrt(2.0) * 1.414e-3 * 4e3, rel=0.1)


def test_scenarios_last_as_long_as_the_benchmark_has_them():
    frame = make_damadics("f13_incipient", noise=False)
    assert len(frame) == 2400
    np.testing.assert_allclose(frame["fault"].iloc[[899, 900, 1350, 1800, 2399]], [0.0, 0.0, 0.5, 1.0, 1.0])
    assert len(make_damadics("f1_small", noise=False)) == 1500
    # a course of one's own: 600 s after it has developed
    assert len(make_damadics(course("f4", -0.5, "short", begins=100.0), noise=False)) == 100 + 450 + 600
    assert (make_damadics(Profile("f19", -0.25), duration=20.0)["fault"] == -0.25).all()


def test_true_values_stay_what_sensor_faults_hide(sound):
    for scenario, shown, true in (("f19_big", "F", "true_F"), ("f14_big", "Ps", "true_Ps")):
        frame = make_damadics(scenario, extended=True, noise=False)
        later = frame["time"] >= 900.0
        assert np.abs(frame[shown] - sound[shown])[later].max() > 1.0
        np.testing.assert_array_equal(frame[true], sound[true])
    free = sound["F"] < 40.0
    np.testing.assert_allclose(sound["F"][free], sound["true_F"][free], rtol=1e-12)
    assert sound["true_F"].max() > 100.0


@pytest.mark.parametrize("actuator", [1, 2, 3])
def test_a_recording_takes_a_frame_with_the_sheet(actuator):
    frame = make_damadics(actuator=actuator, extended=True, random_state=0)
    recording = Recording.from_frame(frame, Valve.from_dict(valve_sheet(preset(actuator))))
    np.testing.assert_allclose(recording["opening"], 1.0 - frame["X"] / 100.0, atol=1e-12)
    np.testing.assert_allclose(recording["p1"], 1e3 * frame["P1"], rtol=1e-12)
    np.testing.assert_allclose(recording["flow"], frame["F_in_range"] / 3.6, rtol=1e-12)
    # nothing is mistaken: what is found is the flow beyond its meter, of actuators 1 and 2 as they start open
    found = {(finding["finding"], finding["role"]) for finding in screen_recording(recording)}
    assert found == {("gap", "flow")}
    assert (frame["F_in_range"].isna().mean() > 0.3) == (actuator == 3)
    assert frame["F_in_range"].iloc[60:].isna().any() == (actuator == 3)
    # the stem follows its command, and the flow moves over its range
    settled = frame.iloc[100:]
    assert np.sqrt(np.mean((settled["X"] - settled["CV"]) ** 2)) < 5.0
    assert np.ptp(settled["true_F"]) > 0.4 * preset(actuator).flow_range


def test_a_flow_beyond_the_meter_is_a_gap(sound):
    frame = make_damadics(random_state=0)
    beyond = sound["true_F"] > 40.0
    assert 0.3 < beyond.mean() < 0.45
    gaps = frame["F_in_range"].isna()
    assert gaps[beyond].all()
    # of what lies within only what the noise may have brought there is lost
    assert not gaps[sound["true_F"] < 40.0 * (1.0 - 8.0 * 1.414e-3)].any()
    np.testing.assert_array_equal(frame["F_in_range"][~gaps], frame["F"][~gaps])


def test_the_nominal_stem_is_that_of_the_sound_actuator(sound):
    np.testing.assert_array_equal(make_damadics("f1_big", nominal=True)["X_nominal"], sound["X"])
    # pressures that are measured move a sound stem too
    moved = make_damadics("f17_big", nominal=True, noise=False)
    np.testing.assert_array_equal(moved["X_nominal"], moved["X"])
    assert np.abs(moved["X"] - sound["X"]).max() > 1.0
    valve = Valve.from_dict(valve_sheet(nominal=True))
    assert Recording.from_frame(moved, valve)["simulated_opening"][0] == 1.0


def test_the_sheet_is_that_of_the_simulated_valve(sound):
    """A simulation by IEC 60534-2-1 of what the sheet says meets the flow of the benchmark."""
    frame = sound.assign(F_in_range=sound["true_F"], X=sound["true_X"]).iloc[100:]
    recording = Recording.from_frame(frame, Valve.from_dict(valve_sheet()))
    flow = 3.6 * ValveSimulation().fit(recording).simulate(recording)["flow"]
    error = flow - frame["true_F"].to_numpy()
    assert np.sqrt(np.mean(error**2)) < 0.005 * frame["true_F"].max()


def test_a_sound_actuator_is_found_sound():
    valve = Valve.from_dict(valve_sheet(nominal=True))
    recording = Recording.from_frame(make_damadics(nominal=True, random_state=0), valve)
    found = MissingPhysicsFinder(random_state=0).fit(recording).diagnosis_
    assert found.to_dict()["verdict"] == "no_mismatch"


def test_a_recording_may_begin_when_the_actuator_has_settled(sound):
    frame = make_damadics("f16_big", duration=1000.0, settled=300.0, nominal=True, noise=False)
    assert len(frame) == 1000
    np.testing.assert_array_equal(frame["time"], np.arange(1000.0))
    # its clock is the recording's own: of the fault, and of what drives
    np.testing.assert_array_equal(frame["fault"], np.where(frame["time"] < 900.0, 0.0, 0.75))
    for signal in ("CV", "P1", "P2", "T1"):
        np.testing.assert_allclose(frame[signal], sound[signal][:1000], rtol=1e-9)
    before = frame["time"] < 900.0
    np.testing.assert_array_equal(frame["X"][before], frame["X_nominal"][before])
    assert np.abs(frame["X"] - frame["X_nominal"])[900:].max() > 1.0
    # the stem does not come from rest: it is where it is a period of the command later
    assert sound["X"].iloc[0] == 0.0
    assert frame["X"].iloc[0] == pytest.approx(frame["X"].iloc[100], abs=1.0)


def test_a_frame_of_the_loop_has_its_level():
    frame = make_damadics(loop=LevelLoop(), duration=300.0, random_state=0)
    assert list(frame.columns) == [*SIGNALS, "PV"]
    assert frame["PV"].iloc[-1] == pytest.approx(50.0, abs=2.0)


def test_what_there_is_not_gets_one_plain_sentence(monkeypatch):
    with pytest.raises(ValueError, match="scenario must be one of f1_small"):
        make_damadics("f20_small")
    with pytest.raises(ValueError, match="actuator must be 1, 2 or 3"):
        make_damadics(actuator=4)
    with pytest.raises(ValueError, match="duration must be at least"):
        make_damadics(duration=0.0)
    with pytest.raises(ValueError, match="nominal is the stem of an open loop"):
        make_damadics(loop=LevelLoop(), nominal=True)
    with pytest.raises(ValueError, match="no incipient f7; give a speed"):
        course("f7", profile="incipient")
    with pytest.raises(ValueError, match="profile must be one of abrupt"):
        course("f7", profile="slow")
    with pytest.raises(ValueError, match="fault must be one of f1 to f19"):
        course("f0")
    for wrong in (5, [1], "f99_big"):
        with pytest.raises(ValueError, match="scenario must be one of f1_small"):
            make_damadics(wrong)
    with pytest.raises(ValueError, match="loop must be a LevelLoop or None, got True"):
        make_damadics(loop=True)
    for wrong in (0.5, -1.0, np.nan):
        with pytest.raises(ValueError, match="settled must be"):
            make_damadics(settled=wrong)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"sklvalve\[io\]"):
        make_damadics()
