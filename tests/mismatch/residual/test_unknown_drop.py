# SPDX-License-Identifier: BSD-3-Clause
"""Without pressures the drop over the valve is unknown, and what it could make of the flow is not named."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.data.preparation import candidates, prepared_problem
from sklvalve.simulation.trim import LearntTrim, SheetTrim

FEW = ["capacity_error", "line_loss", "wrong_characteristic", "piping_reducers", "backlash"]


def _without(made, *roles):
    sheet = made.valve | {"recording": {k: v for k, v in made.valve["recording"].items() if k not in roles}}
    return Recording.from_frame(made.frame, Valve.from_dict(sheet))


@pytest.fixture(scope="module")
def healthy():
    return make_valve_recording(None, loop="wide", n_samples=1200, n_later=0, random_state=5)


def _needs(diagnosis):
    return {each["name"]: each["needs"] for each in diagnosis.content["not_testable"]}


@pytest.mark.slow
@pytest.mark.parametrize("more", [(), ("temperature",)])
def test_a_healthy_valve_without_pressures_has_no_mismatch(healthy, more):
    found = MissingPhysicsFinder(effects=FEW).fit(_without(healthy, "p1", "p2", *more)).diagnosis_
    assert found.verdict == "no_mismatch"
    assert _needs(found) == dict.fromkeys(FEW[:-1], "p1 and p2")


@pytest.mark.slow
def test_play_is_named_without_pressures():
    made = make_valve_recording("backlash", 0.08, loop="wide", n_samples=1200, n_later=0, random_state=5)
    found = MissingPhysicsFinder(effects=FEW).fit(_without(made, "p1", "p2")).diagnosis_
    assert found.effects == (("backlash",),)


@pytest.mark.parametrize(
    ("lacking", "key", "may_begin"),
    [
        ((), "backlash", True),
        (("p1", "p2"), "backlash", False),
        (("p1", "p2"), "backlash_linkage", True),
        (("p1", "p2", "opening"), "positioner_feedback_play", False),
    ],
)
def test_play_that_begins_is_no_other_than_a_drop_that_changes(healthy, lacking, key, may_begin):
    # so where the flow alone speaks of it, it is there from the first row on or not at all
    bench = prepared_problem(_without(healthy, *lacking))
    found, _ = candidates(bench, ["backlash", "positioner_feedback_fault"], [])
    assert {e.key: e.may_begin for e in found}[key] is may_begin


def test_the_sheet_is_held_against_the_flow_only_where_the_drop_is_known(healthy):
    assert isinstance(prepared_problem(_without(healthy)).trim, SheetTrim)
    assert isinstance(prepared_problem(_without(healthy, "p2")).trim, LearntTrim)


def test_a_simulated_flow_knows_of_the_drop(healthy):
    recording = _without(healthy, "p1", "p2")
    told = replace(recording, signals=recording.signals | {"simulated_flow": recording["flow"].copy()})
    found, _ = candidates(prepared_problem(told), FEW, [])
    assert "capacity_error" in {e.name for e in found}


def test_where_a_position_is_missing_the_drop_may_pass_for_what_shifts_the_stem(healthy):
    names = ["transducer_fault", "stuck_valve"]
    seen, _ = candidates(prepared_problem(_without(healthy, "p1", "p2")), names, [])
    unseen, lacking = candidates(prepared_problem(_without(healthy, "p1", "p2", "opening")), names, [])
    assert {e.name for e in seen} == set(names)
    assert {e.name for e in unseen} == {"stuck_valve"}
    assert lacking == [{"name": "transducer_fault", "needs": "p1 and p2"}]


@pytest.mark.slow
def test_a_slow_wander_of_the_flow_is_the_drop_s(healthy):
    recording = _without(healthy, "p1", "p2")
    swing = 1.0 + 0.1 * np.sin(2.0 * np.pi * recording.time / 700.0)
    moved = replace(recording, signals=recording.signals | {"flow": recording["flow"] * swing})
    assert MissingPhysicsFinder(effects=FEW).fit(moved).diagnosis_.verdict == "no_mismatch"
