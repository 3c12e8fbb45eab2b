# SPDX-License-Identifier: BSD-3-Clause
"""The judgement of next tests, and one plant that is moved behind its recording; nothing is diagnosed."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.concealed.next_test import outcome as of
from benchmarks.concealed.next_test import trial
from benchmarks.concealed.next_test.stand import Drawn, Stand, drawn
from benchmarks.concealed.next_test.tables import tables

ROWS = 900
PAIRS = [
    {"names": ["erosion", "seat_leakage"], "now": 3.0, "told_apart": True},
    {"names": ["bypass_open", "seat_leakage"], "now": 3.0, "told_apart": False},
    {"names": ["flow_meter_bias", "seat_leakage"], "now": 20.0, "told_apart": True},
    {"names": ["bypass_open", "erosion"], "now": 1.0, "told_apart": True},
]


def test_a_class_is_open_where_it_holds_the_truth_and_others():
    classes = [["friction"], ["erosion", "seat_leakage"]]
    assert of.open_class(classes, "seat_leakage") == ["erosion", "seat_leakage"]
    assert of.open_class(classes, "friction") == []
    assert of.open_class(classes, "backlash") == []


def test_promised_is_what_parts_from_the_truth_and_was_not_apart():
    assert of.promised(PAIRS, "seat_leakage") == ["erosion"]


@pytest.mark.parametrize(
    ("names", "reached", "after", "expected", "left"),
    [
        (["b"], {"b": 20.0}, [["a"]], of.SPLIT, []),
        (["b"], {"b": 20.0, "c": 1.0}, [["a", "c"]], of.SPLIT, []),
        (["b"], {"b": 20.0}, [["a", "b"]], of.LEFT, ["b"]),
        (["b"], {"b": 20.0}, [["b"]], of.LOST, []),
        (["b"], {"b": 20.0}, [], of.LOST, []),
        (["b"], {"b": 20.0}, [["a"], ["d"]], of.WRONG, []),
        (["b"], {"b": 3.0}, [["a", "b"]], of.TOO_MUCH, []),
        (["b", "c"], {"b": 3.0, "c": 20.0}, [["a", "b"]], of.SPLIT, []),
        (["b"], {}, [["a"]], of.NOT_JUDGED, []),
        ([], {}, [["a"]], of.NO_PROMISE, []),
    ],
)
def test_outcome(names, reached, after, expected, left):
    assert of.outcome("a", names, reached, "named", after) == (expected, left)


def test_candidates_of_no_verdict_name_nothing():
    assert of.outcome("a", ["b"], {"b": 20.0}, "cannot_tell", [["a"]]) == (of.LOST, [])


def test_no_program_is_said_truly_where_none_parts_any():
    assert of.says_truly({"b": 3.0, "c": 13.0}) is True
    assert of.says_truly({"b": 3.0, "c": 15.0}) is False
    assert of.says_truly({}) is None


def test_cases_are_drawn_again_alike_and_every_kind_comes_up():
    kinds = ["erosion", "seat_leakage", "slew_limit"]
    cases = [drawn(5, k, kinds) for k in range(6)]
    assert cases == [drawn(5, k, kinds) for k in range(6)]
    assert sorted(c.effect for c in cases[:3]) == sorted(c.effect for c in cases[3:]) == sorted(kinds)
    assert {c.excitation for c in cases if c.effect == "slew_limit"} == {"wide"}


@pytest.fixture(scope="module")
def stand():
    return Stand(Drawn("bypass_open", "closed", "start", 2.0, (), 11), rows=ROWS)


@pytest.fixture(scope="module")
def tested(stand):
    command = np.where(np.arange(600) // 100 % 2 == 0, 0.2, 0.6)
    plan = SimpleNamespace(name="square", command=command, moved={"p2": np.full(600, 60e3)})
    return *stand.tested(plan), command


def test_test_goes_on_behind_the_same_recording(stand, tested):
    both, _, command = tested
    assert len(both) == ROWS + len(command)
    for role in stand.recording:
        np.testing.assert_array_equal(both[role][:ROWS], stand.recording[role])
    np.testing.assert_allclose(both["command"][ROWS:], command, rtol=0.0, atol=1e-9)
    # the valve follows by hand, at the end of each hold
    np.testing.assert_allclose(both["opening"][ROWS + 95 :: 100], command[95::100], atol=0.02)


def test_a_moved_tank_moves_the_outlet_pressure_and_is_put_back(stand, tested):
    as_is, scene = stand.tested(SimpleNamespace(name="square", command=tested[2], moved={}))
    moved = tested[0]["p2"][ROWS + 50 :: 100] - as_is["p2"][ROWS + 50 :: 100]
    # less flows, so that the line behind takes less: the valve sees somewhat less than the tank does
    assert np.all((moved > 30e3) & (moved < 62e3))
    assert scene.loop.shape == tested[1].loop.shape


def test_left_as_it_is_the_controller_goes_on(stand):
    both, _ = stand.tested(SimpleNamespace(name="as now", command=np.full(600, 0.5), moved={}))
    assert np.std(both["command"][ROWS:]) > 0.0
    assert not np.allclose(both["command"][ROWS:], 0.5, atol=0.01)


def test_the_plants_own_distances_are_of_the_members_asked_for(stand, tested):
    found = stand.apart(tested[1], ["seat_leakage", "stem_load"])
    # the plant has no stem load
    assert list(found) == ["seat_leakage"]
    assert found["seat_leakage"] >= 0.0


def test_a_record_makes_a_line_and_lines_make_tables(stand, monkeypatch):
    answers = iter([[["seat_leakage", "bypass_open"]], [["bypass_open"]]])
    pair = SimpleNamespace(names=("seat_leakage", "bypass_open"), now=2.0, expected=30.0, separates=True)
    plan = SimpleNamespace(name="square", command=np.full(600, 0.3), moved={}, sensor=None, pairs=[pair])

    class Finder:
        next_test_ = plan

        def __init__(self, **settings):
            pass

        def fit(self, recording):
            self.diagnosis_ = SimpleNamespace(
                effects=next(answers), verdict="named", content={"next_test": "Move it"}
            )
            return self

    monkeypatch.setattr(trial, "MissingPhysicsFinder", Finder)
    monkeypatch.setattr(trial, "Stand", lambda what: stand)
    line = json.loads(json.dumps(trial.line_of(3, 0, ["bypass_open"]), default=float))
    assert line["promised"] == ["seat_leakage"]
    apart = line["reached"]["seat_leakage"] >= of.APART
    assert line["outcome"] == (of.SPLIT if apart else of.TOO_MUCH)
    text = tables([line, {"outcome": None}])
    assert text.startswith("2 records drawn, 1 left ambiguous")
    assert f"| tests that split the class rightly | 1 | {'100' if apart else '0'} %" in text
