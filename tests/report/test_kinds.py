# SPDX-License-Identifier: BSD-3-Clause
"""Fault or property in words: how the headline begins, and what is to be done."""

import copy

from sklvalve.report import summary_sentence
from sklvalve.report.headline import glance, headline
from sklvalve.report.kinds import begins, by_beginning, likely, to_be_declared
from tests.report import examples

SLOW = {
    "kind": "property",
    "members": [{"name": "slew_limit", "probability": 0.94, "kind": "property"}],
    "probability": 0.94,
    "blocks": ["actuator"],
    "size": {"flow": 0.3},
    "parameters": {"speed": {"value": 0.0161, "unit": "1/s", "ci95": [0.015, 0.017]}},
    "sentence": "The stem opens at 1.6% of travel a second at most.",
    "separated_by": "",
}
PLAY = examples.PLAY | {"kind": "fault"}


def _made(*effects, **parts):
    made = examples.named()
    made["effects"] = copy.deepcopy(list(effects))
    return made | parts


def test_a_fault_is_called_likely():
    sentence = headline(_made(PLAY))
    assert sentence.startswith("Likely fault: the stem has play (backlash), in the actuator")
    assert summary_sentence(_made(PLAY)).startswith("Likely fault: the stem has play (backlash) (")
    assert "property" not in sentence


def test_a_property_is_what_the_simulation_lacks_and_asks_for_no_maintenance():
    made = _made(SLOW, next_test="")
    words = "The simulation lacks a limited stroking speed"
    assert headline(made).startswith(words)
    assert "(a property of a sound valve)" in headline(made)
    assert summary_sentence(made).startswith(words)
    do = dict(glance(made))["What to do next"]
    assert "stroke_time = 62 in the [actuator] section of valve.toml" in do
    assert "No maintenance is needed." in do
    assert "look for it at the valve" not in do


def test_with_both_the_faults_come_first():
    made = _made(SLOW, PLAY)
    sentence = headline(made)
    assert sentence.startswith(
        "Likely fault: 1. the stem has play (backlash), in the actuator (play 3.1 % of"
    )
    assert ". The simulation also lacks 2. a limited stroking speed, in the actuator (a property" in sentence
    sentence = summary_sentence(made)
    assert sentence.index("Likely fault: 1. the stem has play") < sentence.index(
        "The simulation also lacks 2. a limited"
    )
    do = dict(glance(made))["What to do next"]
    assert "No maintenance" not in do


def test_either_says_so():
    made = _made(SLOW | {"kind": "either", "members": [{"name": "slew_limit", "probability": 0.94}]})
    begin = "A fault, or a property that the simulation lacks: a limited stroking speed, in the actuator"
    assert headline(made).startswith(begin)
    assert "(a property" not in headline(made)
    assert "If it is not, look for the fault at the valve." in to_be_declared(made["effects"])


def test_faults_then_what_may_be_either_then_properties():
    effects = [
        SLOW,
        SLOW | {"kind": "either", "members": [{"name": "seat_leakage", "probability": 0.9}]},
        PLAY,
    ]
    sentence = summary_sentence(_made(*effects))
    begins = [
        "Likely fault: 1. the stem has play",
        ". A fault, or a property that the simulation lacks: 2. seat leakage",
        ". The simulation also lacks 3. a limited",
    ]
    places = [sentence.index(begin) for begin in begins]
    assert places == sorted(places)


def test_a_class_of_both_kinds_is_what_most_of_it_is():
    members = [
        {"name": "backlash", "probability": 0.92, "kind": "fault"},
        {"name": "tight_shutoff", "probability": 0.02, "kind": "property"},
    ]
    assert likely({"kind": "either", "members": members}) == "fault"
    members[1]["probability"] = 0.5
    assert likely({"kind": "either", "members": members}) == "either"


def test_an_older_diagnosis_says_neither_fault_nor_property():
    old = {key: value for key, value in examples.PLAY.items() if key != "kind"}
    assert begins(old) == "Not in the simulation:"
    assert by_beginning([old]) == [("Not in the simulation:", [(1, old)])]
    assert to_be_declared([old]) == ""
    assert headline(_made(old)).startswith("Not in the simulation: backlash, in the actuator")
