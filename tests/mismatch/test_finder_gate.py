# SPDX-License-Identifier: BSD-3-Clause
"""Defects of the data on the way to a diagnosis: blocked, blanked, or a stem that has seized after all."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.data.gate import effects_switched_off
from sklvalve.mismatch.data.masking import masked
from sklvalve.recording import InputError, require_diagnosable, screen_recording
from sklvalve.recording.measured import with_seized_stems, without_findings
from sklvalve.report import to_text
from sklvalve.report.html import render
from sklvalve.simulation import ValveSimulation

from .conftest import ROWS, record

SEIZED = 480
FEW = ["stuck_valve", "seat_leakage", "clogging", "backlash"]


def with_signals(recording, **signals):
    return replace(recording, signals=recording.signals | signals)


@pytest.fixture(scope="module")
def sound():
    return record(random_state=0)


@pytest.fixture(scope="module")
def simulation(sound):
    return ValveSimulation().fit(sound)


def stopped(sound, simulation, row, *, stem=True):
    """The opening column holds one value from a row on; with `stem` the flow is that of a stem that does."""
    opening = sound["opening"].copy()
    opening[row:] = opening[row]
    made = with_signals(sound, opening=opening)
    if not stem:
        return made
    return with_signals(made, flow=sound["flow"] + simulation.predict(made) - simulation.predict(sound))


@pytest.mark.slow
def test_seized_stem_is_named_with_its_time(sound, simulation):
    diagnosis = MissingPhysicsFinder().fit(stopped(sound, simulation, SEIZED)).diagnosis_
    assert diagnosis.verdict == "named"
    # a blockage that stops the stem where it stands looks the same, as long as nobody asks for more
    assert "stuck_valve" in diagnosis.effects[0][:2]
    # the command rests around the row it seized at, so any moment of that rest fits: the interval says so; it
    # reaches back to where the command stood near there before, a small miss beside the strokes missed later
    low, high = diagnosis.content["location"]["onset_ci95"]
    assert low <= SEIZED <= high
    assert low <= diagnosis.content["location"]["onset"] <= high
    assert high - low < 0.3 * ROWS
    assert np.ptp(sound["command"][SEIZED - 50 : SEIZED + 50]) < 1e-9
    assert [(d["finding"], d["role"]) for d in diagnosis.content["data"]] == [("frozen", "opening")]
    assert all(set(d) == {"finding", "role", "detail"} for d in diagnosis.content["data"])


@pytest.mark.slow
def test_stem_seized_from_the_first_row_is_diagnosable_and_named(sound, simulation):
    recording = stopped(sound, simulation, 0)
    require_diagnosable(recording)
    diagnosis = MissingPhysicsFinder(effects=FEW).fit(recording).diagnosis_
    assert diagnosis.verdict == "named"
    assert diagnosis.effects[0][0] == "stuck_valve"
    assert "backlash" in {entry["name"] for entry in diagnosis.content["not_testable"]}


def test_sensor_that_stands_still_is_no_seized_stem(sound, simulation):
    recording = stopped(sound, simulation, SEIZED, stem=False)
    data = with_seized_stems(screen_recording(recording), recording)
    assert "stuck_valve" in effects_switched_off(data)
    assert np.isnan(without_findings(recording, data)["opening"][SEIZED + 1 :]).all()
    with pytest.raises(InputError, match="holds one value"):
        require_diagnosable(stopped(sound, simulation, 0, stem=False))


def test_constant_opening_under_a_command_at_rest_is_refused(sound, simulation):
    recording = stopped(sound, simulation, 0)
    rest = 0.5 + 0.005 * np.sin(np.arange(ROWS) / 50.0)
    with pytest.raises(InputError, match="holds one value"):
        require_diagnosable(with_signals(recording, command=rest))


def test_swapped_pressures_block_the_diagnosis(sound):
    mixed = np.arange(ROWS) % 2 == 0
    p1, p2 = sound["p1"], sound["p2"]
    recording = with_signals(sound, p1=np.where(mixed, p2, p1), p2=np.where(mixed, p1, p2))
    finder = MissingPhysicsFinder().fit(recording)
    content = finder.diagnosis_.content
    assert content["verdict"] == "cannot_tell"
    assert content["mismatch"] == {"detected": False, "p_value": None, "alpha": 0.01}
    assert content["effects"] == []
    assert "unknown" not in content
    assert content["next_test"].startswith("Correct the columns in valve.toml first")
    assert json.loads(json.dumps(content, allow_nan=False)) == content
    text = " ".join(to_text(content).split())
    sentence = "This recording cannot show whether anything is missing."
    assert text.startswith(f"Finding {sentence} Do next Correct the columns in valve.toml first")
    pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
    pytest.importorskip("matplotlib", reason='needs pip install "sklvalve[report]"')
    assert "Correct the columns in valve.toml first" in render(finder.diagnosis_)


@pytest.mark.slow
def test_pressure_sensor_that_freezes_is_blanked_and_names_nothing(sound):
    p1 = sound["p1"].copy()
    p1[300:600] = p1[300]
    frozen = with_signals(sound, p1=p1)
    diagnosis = MissingPhysicsFinder(effects=FEW).fit(frozen).diagnosis_
    assert diagnosis.verdict == "no_mismatch"
    assert np.isnan(diagnosis.traces["recorded"]["p1"][301:600]).all()
    assert diagnosis.content["fit"]["flow"]["held_out_rows"] <= ROWS - 299
    assert diagnosis.content["fit"]["opening"]["held_out_rows"] == ROWS - int(0.4 * ROWS)


def test_rows_behind_those_used_are_sifted_too_and_change_no_others(sound):
    p1 = sound["p1"].copy()
    p1[900:1000] = p1[900]
    whole = with_signals(sound, p1=p1)
    used = whole.slice(0, 800)
    cleaned, same = masked(whole, used, screen_recording(used))
    assert same is used
    assert np.isnan(cleaned["p1"][901:1000]).all()
    np.testing.assert_array_equal(cleaned["p1"][:800], p1[:800])


def test_clean_recording_goes_through_as_it_is(sound):
    assert all(each is sound for each in masked(sound, sound, screen_recording(sound)))


def test_sensor_that_stands_still_too_long_is_refused_in_a_sentence(sound, simulation):
    with pytest.raises(InputError, match=r"leaves no other.*opening stands still for 900 s"):
        MissingPhysicsFinder().fit(stopped(sound, simulation, 300, stem=False))
