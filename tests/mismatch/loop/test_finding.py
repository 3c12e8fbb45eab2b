# SPDX-License-Identifier: BSD-3-Clause
"""A loop's finding as diagnosis.json has it."""

import json

import numpy as np
import pytest

from sklvalve.mismatch import Diagnosis
from sklvalve.mismatch.loop import diagnose_loop, is_loop, loop_content, stick_slip
from sklvalve.mismatch.loop.finding import _not_testable
from sklvalve.recording import Recording, Valve

TIME = 10.0 * np.arange(300)


def _recording(unit="m3/h", stick=0.02):
    rng = np.random.default_rng(3)
    command = (
        0.5
        + 0.02 * np.sin(TIME / 300.0)
        + 0.015 * np.sin(TIME / 127.0)
        + 0.0005 * rng.standard_normal(len(TIME))
    )
    flow = 40.0 * stick_slip(command, stick, 0.0) + 0.04 * rng.standard_normal(len(TIME))
    roles = {
        "command": {"column": "op", "unit": "%"},
        "flow": {"column": "pv", "unit": unit},
        "setpoint": {"column": "sp", "unit": unit},
    }
    frame = {"time": TIME, "op": 100.0 * command, "pv": flow, "sp": np.full(len(TIME), 20.0)}
    return Recording.from_frame(frame, Valve.from_dict({"recording": roles}))


def test_a_named_loop_is_a_diagnosis_in_the_recordings_own_unit():
    recording = _recording()
    found = diagnose_loop(recording)
    diagnosis = Diagnosis(loop_content(found, recording))
    assert diagnosis.verdict == "named"
    assert diagnosis.effects[0][0] in ("stiction", "backlash")
    content = json.loads(json.dumps(diagnosis.to_dict(), allow_nan=False))
    assert content["fit"]["flow"]["unit"] == "m3/h"
    assert content["fit"]["flow"]["rmse"]["corrected"] == pytest.approx(
        3600.0 * found.fit["rmse"]["corrected"], rel=1e-9
    )
    assert content["proof"] == "forward"
    needs = {entry["name"]: entry["needs"] for entry in content["not_testable"]}
    assert needs["clogging"] == "opening and p1 and p2"
    assert set(dict(_not_testable({"command", "process_value"})).values()) == {
        "opening and flow and p1 and p2"
    }


def test_a_loop_is_what_has_no_other_signal_of_the_valve():
    recording = _recording()
    assert is_loop(recording)
    values = {"time": TIME, **recording.signals, "opening": recording["command"]}
    assert not is_loop(Recording.from_frame(values))
    assert not is_loop(Recording.from_frame({k: v for k, v in values.items() if k in ("time", "flow")}))
