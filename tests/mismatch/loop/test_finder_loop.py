# SPDX-License-Identifier: BSD-3-Clause
"""Loops on the way through the finder: which go it, what is told of them, and what pictures have."""

import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.loop_alarms import recording_of
from benchmarks.loop_plant import draw_loop
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.loop import stick_slip
from sklvalve.recording import Recording, Valve
from sklvalve.report import to_markdown, to_text
from sklvalve.report.html import render
from tests.mismatch.conftest import record

TIME = 10.0 * np.arange(400)


def loop(role="flow", stick=0.02, rows=400):
    rng = np.random.default_rng(0)
    swings = 0.02 * np.sin(TIME / 300.0) + 0.015 * np.sin(TIME / 127.0)
    command = 0.5 + swings + 0.0005 * rng.standard_normal(len(TIME))
    stem = stick_slip(command, stick=stick, slip=0.0) if stick else command
    if role == "process_value":
        # the same stem behind a lag: a temperature
        seen = np.empty(len(TIME))
        seen[0] = stem[0]
        for k in range(1, len(TIME)):
            seen[k] = seen[k - 1] + 0.3 * (stem[k] - seen[k - 1])
        stem = seen
    value = 40.0 * stem + 0.01 * rng.standard_normal(len(TIME))
    unit = "m3/h" if role == "flow" else "degC"
    told = {
        "command": {"column": "op", "unit": "%"},
        role: {"column": "pv", "unit": unit},
        "setpoint": {"column": "sp", "unit": unit},
    }
    frame = {"time": TIME, "op": 100.0 * command, "pv": value, "sp": np.full(len(TIME), 20.0)}
    frame = {name: values[:rows] for name, values in frame.items()}
    return Recording.from_frame(frame, Valve.from_dict({"recording": told}))


def test_sticking_loop_is_named_and_reported():
    finder = MissingPhysicsFinder().fit(loop())
    diagnosis = finder.diagnosis_
    assert diagnosis.verdict == "named"
    assert {"stiction", "backlash"} & set(diagnosis.effects[0])
    assert not hasattr(finder, "corrected_simulation_")
    assert json.loads(json.dumps(diagnosis.to_dict(), allow_nan=False)) == diagnosis.to_dict()
    traces = diagnosis.traces
    assert set(traces["recorded"]) == {"command", "flow", "setpoint"}
    left = [np.nanstd(traces["recorded"]["flow"] - traces[kind]["flow"]) for kind in ("nominal", "corrected")]
    assert left[1] < 0.5 * left[0]
    assert traces["flagged"].any()
    assert "Including it lowers the" in to_text(diagnosis.to_dict())
    assert "flow RMSE [m3/h] |" in to_markdown(diagnosis.to_dict())


def test_loop_of_another_value_is_told_of_in_its_unit():
    content = MissingPhysicsFinder().fit(loop("process_value")).diagnosis_.to_dict()
    assert set(content["fit"]) == {"process_value"}
    assert "process value RMSE [degC]" in to_text(content)


@pytest.mark.parametrize(("role", "stick"), [("flow", 0.02), ("process_value", 0.02), ("flow", 0.0)])
def test_page_of_a_loop(role, stick):
    pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
    pytest.importorskip("matplotlib", reason='needs pip install "sklvalve[report]"')
    diagnosis = MissingPhysicsFinder().fit(loop(role, stick)).diagnosis_
    page = render(diagnosis)
    assert 'id="recording' in page or "recorded signals over time" in page
    assert f"Recorded minus simulated {role.replace('_', ' ')} over time" in page


def test_loop_that_follows_has_no_correction_to_show():
    followed = recording_of(draw_loop(4, "flow", "setpoint"))
    diagnosis = MissingPhysicsFinder().fit(followed).diagnosis_
    assert diagnosis.verdict == "no_mismatch"
    error = diagnosis.content["fit"]["flow"]["rmse"]
    assert error["corrected"] == error["nominal"]
    traces = diagnosis.traces
    np.testing.assert_array_equal(traces["corrected"]["flow"], traces["nominal"]["flow"])
    assert not traces["flagged"].any()
    assert "is excluded" in to_text(diagnosis.to_dict())


def test_rows_behind_those_used_change_nothing():
    whole, short = (MissingPhysicsFinder().fit(r, until=300) for r in (loop(), loop(rows=300)))
    assert whole.diagnosis_.effects == short.diagnosis_.effects
    assert whole.diagnosis_.content["fit"] == short.diagnosis_.content["fit"]
    assert whole.diagnosis_.traces["until"] == 300
    assert np.isnan(whole.diagnosis_.traces["nominal"]["flow"][300:]).all()


@pytest.mark.slow
def test_simulations_of_an_earlier_fit_are_gone():
    finder = MissingPhysicsFinder(effects=["seat_leakage"]).fit(record(random_state=0))
    assert hasattr(finder, "corrected_simulation_")
    finder.fit(loop())
    assert not hasattr(finder, "corrected_simulation_")
    assert not hasattr(finder, "nominal_simulation_")


def test_plant_without_position_goes_the_ordinary_way():
    recording = record(random_state=0)
    kept = {role: values for role, values in recording.signals.items() if role != "opening"}
    kept["setpoint"] = np.full(len(recording), 0.01)
    finder = MissingPhysicsFinder(effects=["seat_leakage"]).fit(replace(recording, signals=kept))
    assert hasattr(finder, "corrected_simulation_")
