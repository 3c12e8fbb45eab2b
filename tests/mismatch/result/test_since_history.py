# SPDX-License-Identifier: BSD-3-Clause
"""What diagnosis.json says since the history, of a sound valve and of a clogged one."""

import json

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.history import Allowance, ValveHistory
from sklvalve.mismatch import Diagnosis, MissingPhysicsFinder
from sklvalve.mismatch.result.since_history import _ALLOWED
from sklvalve.recording import Recording, Valve
from sklvalve.report import to_text
from tests.history.plant import made as sound
from tests.history.plant import without


@pytest.fixture(scope="module")
def clogged():
    bunch = make_valve_recording(
        "clogging", 0.3, onset=1200.0, loop="wide", n_samples=2400, n_later=0, random_state=3
    )
    whole = Recording.from_frame(bunch.frame, Valve.from_dict(bunch.valve))
    history = ValveHistory(allowance=Allowance(capacity=0.004)).fit(whole.slice(0, 1200))
    few = ("clogging", "piping_reducers", "line_loss", "seat_leakage")
    return MissingPhysicsFinder(effects=few, history=history, n_jobs=1).fit(whole.slice(1200, 2400))


@pytest.fixture(scope="module")
def healthy():
    """Without an opening."""
    before, after = (without(each, "opening") for each in sound())
    return MissingPhysicsFinder(history=ValveHistory().fit(before), effects=["clogging"], n_jobs=1).fit(after)


def test_every_allowance_has_words_and_is_the_one_used(clogged):
    assert set(_ALLOWED) == set(Allowance.__dataclass_fields__)
    told = clogged.diagnosis_.content["since_history"]["allowances"]
    assert {each["name"]: each["value"] for each in told}["capacity"] == 0.004
    assert all(each["words"] and each["unit"] == "1" for each in told)


def test_the_history_is_told_by_rows_days_and_time(clogged):
    since = clogged.diagnosis_.content["since_history"]
    assert (since["rows"], since["recordings"]) == (1200, 1)
    assert since["days"] == pytest.approx(1200.0 / 86_400.0, abs=1e-3)
    assert since["last"] - since["first"] == pytest.approx(1199.0)


def test_a_change_has_its_size_in_its_own_unit_and_in_flow_with_intervals(clogged):
    content = clogged.diagnosis_.content
    (change,) = content["since_history"]["changes"]
    (effect,) = content["effects"]
    own = effect["parameters"][change["parameter"]]
    assert change["name"] == "clogging"
    assert (change["value"], change["unit"], change["ci95"]) == (own["value"], own["unit"], own["ci95"])
    assert change["ci95"][0] < 0.7 < change["ci95"][1]
    flow = change["flow"]
    assert (flow["unit"], flow["at_the_same"]) == ("m3/h", "opening")
    assert flow["ci95"][0] <= flow["value"] <= flow["ci95"][1]
    # the same size as the share of span in the entry of the effect
    assert flow["value"] == pytest.approx(effect["size"]["flow"] * content["spans"]["flow"], rel=0.01)


def test_parameters_then_and_now_are_in_recorded_units(clogged):
    rows = {each["name"]: each for each in clogged.diagnosis_.content["since_history"]["calibration"]}
    assert rows["capacity"]["unit"] == rows["flow_zero"]["unit"] == "m3/h"
    assert rows["dp_zero"]["unit"] == "kPa"
    assert rows["meter_lag"]["unit"] == "s"
    for row in rows.values():
        assert row["ci95"][0] <= row["then"] <= row["ci95"][1]
    now = clogged.corrected_simulation_.values_
    assert rows["capacity"]["now"] == now["capacity"]
    assert rows["flow_zero"]["now"] == pytest.approx(3600.0 * now["flow_zero"])


def test_residuals_tell_a_change_that_the_corrected_simulation_does_not_leave(clogged):
    flow = clogged.diagnosis_.content["since_history"]["residuals"]["flow"]
    assert flow["by_then"] > 5.0 * flow["history"]
    assert flow["by_now"] < 2.0 * flow["history"]


def test_a_sound_valve_has_changed_by_nothing(healthy):
    content = healthy.diagnosis_.content
    assert content["verdict"] == "no_mismatch"
    since = content["since_history"]
    assert since["changes"] == []
    assert set(since["residuals"]) == {"flow"}
    assert to_text(content).startswith("Finding       Nothing has changed since the history by more than is")


def test_what_it_cannot_say(healthy):
    limits = healthy.diagnosis_.content["since_history"]["cannot_say"]
    assert "dp_zero" in limits["not_informed"]
    assert "capacity" not in limits["not_informed"]
    for each in limits["outside"]:
        assert each["share"] >= 0.01
        assert {"low", "high", "unit"} == set(each["history"]) == set(each["here"])


def test_traces_hold_then_and_are_kept_with_it(healthy, tmp_path):
    healthy.diagnosis_.save(tmp_path / "sound.diagnosis")
    again = Diagnosis.load(tmp_path / "sound.diagnosis")
    assert again.content == json.loads(json.dumps(healthy.diagnosis_.content, allow_nan=False))
    assert set(again.traces["then"]) >= {"flow"}
    np.testing.assert_array_equal(
        again.traces["then_scatter"]["flow"], healthy.diagnosis_.traces["then_scatter"]["flow"]
    )


def test_without_a_history_there_is_no_such_part():
    _, after = sound()
    found = MissingPhysicsFinder(effects=["clogging"], n_jobs=1).fit(after.slice(0, 600)).diagnosis_
    assert "since_history" not in found.content
    assert not {"then", "then_scatter"} & set(found.traces)
    assert "history" not in to_text(found.content)
