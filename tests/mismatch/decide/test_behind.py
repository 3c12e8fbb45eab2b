# SPDX-License-Identifier: BSD-3-Clause
"""What lies behind a slow motor: play is found there, and none is told of a sound one."""

import numpy as np
import pytest

from benchmarks.motor_plant import motor_record
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.recording import Recording, Valve

EFFECTS = {e.key: e for e in CATALOGUE}
FEW = ("slew_limit", "dead_time", "backlash", "positioner_characteriser")


def _record(play, seed=0, rows=900, **how):
    frame, sheet, truth = motor_record(seed, play=play, rows=rows, **how)
    return Recording.from_frame(frame, Valve.from_dict(sheet)), truth


def _names(found):
    return [{m["name"] for m in e["members"]} for e in found["effects"]]


@pytest.fixture(scope="module")
def with_play():
    recording, truth = _record(0.06)
    return MissingPhysicsFinder(effects=FEW).fit(recording).diagnosis_.to_dict(), truth


@pytest.mark.slow
def test_play_behind_a_slow_motor_is_found_first(with_play):
    found, truth = with_play
    assert found["verdict"] == "named"
    motor, fault = found["effects"]
    assert "backlash" in {m["name"] for m in fault["members"]}
    assert fault["parameters"]["width"]["value"] == pytest.approx(truth["play"], abs=0.012)
    assert motor["kind"] == "property"
    assert 1.0 / motor["parameters"]["speed"]["value"] == pytest.approx(truth["stroke"], rel=0.15)


@pytest.mark.slow
def test_a_sound_slow_motor_has_no_play():
    found = MissingPhysicsFinder(effects=FEW).fit(_record(0.0)[0]).diagnosis_.to_dict()
    assert all("backlash" not in names for names in _names(found))
    assert {e["kind"] for e in found["effects"]} == {"property"}


def test_what_is_declared_is_no_mismatch():
    found = MissingPhysicsFinder(effects=FEW).fit(_record(0.0, declared=True)[0]).diagnosis_.to_dict()
    assert found["verdict"] == "no_mismatch"


@pytest.mark.slow
def test_a_stroke_three_times_as_long_as_declared_is_found():
    frame, sheet, truth = motor_record(0, rows=900)
    sheet["actuator"] = {"kind": "electric", "stroke_time": truth["stroke"] / 3.0}
    recording = Recording.from_frame(frame, Valve.from_dict(sheet))
    found = MissingPhysicsFinder(effects=FEW).fit(recording).diagnosis_.to_dict()
    assert any("slew_limit" in names for names in _names(found))


def test_a_property_held_is_part_of_the_simulation_and_of_its_calibration():
    bench = prepared_problem(_record(0.0)[0])
    bench, nominal = calibrated(bench)
    slow = bench.fit((Term(EFFECTS["slew_limit"]),), start=nominal)
    holding = bench.holding(slow.terms, slow)
    holding, again = calibrated(holding)
    assert again.terms == ()
    assert "slew_limit.speed" in again.values
    assert [m.effect.key for m in bench.held] == []
    left = [np.nanstd(b.residuals(m)["flow"]) for b, m in ((bench, nominal), (holding, again))]
    assert left[1] < 0.5 * left[0]
