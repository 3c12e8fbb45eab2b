# SPDX-License-Identifier: BSD-3-Clause
"""Fault or property: what an effect is, and a class of them."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.decide.kinds import kind_of_class, kinds_of_explanations, with_kinds
from sklvalve.mismatch.effects import CATALOGUE, EVENTS
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.recording import Valve

EFFECTS = {e.key: e for e in CATALOGUE}
UNKNOWN = SimpleNamespace(valve=Valve(), recording={"command": None})
PNEUMATIC = SimpleNamespace(valve=Valve(kind="pneumatic"), recording={"command": None})


def _finding(*keys, onset=None, chain=UNKNOWN):
    model = SimpleNamespace(chain=chain)
    share = 1.0 / len(keys)
    rivals = [
        SimpleNamespace(term=Term(EFFECTS[key], onset), model=model, probability=share, distance=0.0)
        for key in keys
    ]
    return SimpleNamespace(rivals=rivals, term=rivals[0].term)


def test_every_form_says_what_it_is():
    for effect in (*CATALOGUE, *EVENTS):
        assert effect.kind in ("fault", "property", "either"), effect.key
        assert effect.kind_late in ("fault", "either"), effect.key


@pytest.mark.parametrize(
    ("key", "kind"),
    [
        ("slew_limit_motor", "property"),
        ("dead_time", "property"),
        ("choked_flow", "property"),
        ("backlash", "fault"),
        ("stiction", "fault"),
        ("seat_leakage", "fault"),
        ("positioner_deadband", "either"),
        ("capacity_error", "either"),
    ],
)
def test_what_is_there_from_the_start(key, kind):
    assert EFFECTS[key].kind_of(UNKNOWN, False) == kind


def test_what_begins_within_the_record_is_no_property():
    assert EFFECTS["slew_limit_motor"].kind_of(UNKNOWN, True) == "fault"
    assert EFFECTS["flow_meter_drift"].kind_of(UNKNOWN, False) == "fault"
    assert EFFECTS["density_change"].kind_of(UNKNOWN, True) == "either"


def test_slow_air_is_either():
    assert EFFECTS["slew_limit"].kind_of(UNKNOWN, False) == "property"
    assert EFFECTS["slew_limit"].kind_of(PNEUMATIC, False) == "either"
    assert EFFECTS["slew_limit"].kind_of(PNEUMATIC, True) == "fault"


def test_a_class_of_both_is_either():
    assert kind_of_class(_finding("slew_limit", "dead_time")) == "property"
    assert kind_of_class(_finding("backlash", "stiction")) == "fault"
    assert kind_of_class(_finding("backlash", "dead_time")) == "either"
    assert kinds_of_explanations(_finding("backlash", "dead_time")) == {
        "backlash": "fault",
        "dead_time": "property",
    }


def test_an_entry_says_it_of_each_member():
    entry = with_kinds({"members": [{"name": "backlash", "probability": 0.9}]}, _finding("backlash"))
    assert entry["kind"] == "fault"
    assert entry["members"] == [{"name": "backlash", "probability": 0.9, "kind": "fault"}]
