# SPDX-License-Identifier: BSD-3-Clause
"""The top of the page: verdict, effect class, place and size in one short sentence, and three answers."""

import copy

import pytest

from sklvalve.mismatch.effects.capacity_error import CapacityError
from sklvalve.mismatch.effects.erosion import Erosion
from sklvalve.mismatch.effects.seat_leakage import SeatLeakage
from sklvalve.report import summary_sentence
from sklvalve.report.headline import glance, headline
from tests.report import examples


def _glance(made):
    return dict(glance(made))


def test_finding_in_one_sentence():
    made = examples.named()
    made["effects"][0] = examples.LEAK | {"size": {"flow": 0.032, "opening": 1e-5}}
    assert headline(made) == (
        "The simulation leaves out seat leakage or an open bypass in the valve, below 12 % opening, from "
        "812 s on: it moves the flow by 3 % of span where it acts (leak kv 0.8 m3/h)."
    )
    assert _glance(made) == {
        "How sure": "97 % sure that it is one of these two: in blind tests on simulated valves this share "
        "of such identifications was correct. A difference as large comes by chance in fewer than 1 of 1000 "
        "recordings of a healthy valve (p < 0.001).",
        "What to do next": "Close the valve for 60 s.",
        "What it brings": "With it the flow error on 1440 unseen rows falls from 1.9 to 0.22 m3/h. For "
        "comparison: a black box learnt from the same rows makes 0.5, noise alone 0.2.",
    }


def test_of_several_regions_the_largest_is_told_to_two_digits():
    made = examples.named()
    small = {"signal": "opening", "low": 0.3, "high": 0.4, "direction": None, "share": 0.02}
    large = {"signal": "opening", "low": 0.0, "high": 0.798, "direction": None, "share": 0.48}
    large["and"] = {"signal": "pressure_ratio", "low": 0.6733, "high": 0.7621}
    made["location"] = copy.deepcopy(made["location"]) | {
        "regions": [small, large],
        "onset_ci95": [790.0, 830.0],
    }
    words = "mostly below 80 % opening where the pressure ratio is between 0.67 and 0.76, from 812 s on"
    assert words in headline(made)


def test_two_things_are_counted():
    sentence = headline(examples.named_twice())
    assert sentence.startswith("The simulation leaves out 1. backlash in the actuator (play 3.1 % of travel")
    assert "; 2. seat leakage or an open bypass in the valve (" in sentence
    sure = _glance(examples.named_twice())["How sure"]
    assert sure.startswith("More than 99 % sure of backlash; 97 % sure of seat leakage or an open bypass.")


def test_nothing_missing():
    made = examples.no_mismatch()
    assert headline(made).startswith("Nothing is missing")
    assert _glance(made)["What to do next"] == "Nothing needs to be done."
    assert "43 % of recordings of a healthy valve (p = 0.43)" in _glance(made)["How sure"]
    assert "What it brings" not in _glance(made)
    made["mismatch"] |= {"p_value": 1e-6}
    assert headline(made).startswith("Nothing that matters is missing")


def test_without_a_data_sheet_nothing_is_declared_sound():
    made = examples.no_mismatch()
    needs = "a data sheet with the trim's characteristic"
    made["not_testable"] = [{"name": "gas_expansion", "needs": "a gas"}]
    assert _glance(made)["What to do next"] == "Nothing needs to be done."
    made["not_testable"].append({"name": "seat_leakage", "needs": needs})
    told = (
        "Give the data sheet's capacity and characteristic: without them a leak, a worn trim or a wrong "
        "capacity cannot be told."
    )
    assert _glance(made)["What to do next"] == told
    made["next_test"] = "Move the valve."
    assert _glance(made)["What to do next"] == f"{told} To learn more: Move the valve."
    # these are the words of the catalogue, so that a change there is seen here
    assert SeatLeakage.requires == CapacityError.requires == Erosion.requires == needs
    # of two that were asked for no more, nor less, may be said at the top
    for words in (headline(made), summary_sentence(made)):
        assert words.startswith("Nothing is missing that can be told without a data sheet: ")
        assert "data-sheet tolerances" not in words


def test_a_place_that_the_name_says_is_not_said_again():
    made = examples.named()
    leak = {"members": [{"name": "actuator_leak", "probability": 0.97}], "blocks": ["actuator"]}
    made["effects"][0] = examples.LEAK | leak
    assert headline(made).startswith(
        "The simulation leaves out an air leak of the actuator below 12 % opening,"
    )
    made["effects"].append(examples.PLAY)
    for sentence in (headline(made), summary_sentence(made)):
        assert "1. an air leak of the actuator (" in sentence
        assert "2. backlash in the actuator (" in sentence


def test_what_no_effect_explains():
    made = examples.none_of_these() | {"unknown": {"signal": "flow", "inputs": ["opening"], "size": 0.04}}
    made["location"] = made["location"] | {"onset": None, "intervals": []}
    assert headline(made) == (
        "Something is missing that no known effect explains: it acts in the valve, and moves the flow by "
        "4 % of span."
    )
    assert "follows from opening, so it is no noise." in _glance(made)["How sure"]
    made["unknown"] |= {"closest": [{"members": examples.LEAK["members"]}], "closest_leaves": 0.05}
    assert "Closest comes seat leakage or an open bypass, but that leaves 5 %" in _glance(made)["How sure"]
    besides = made | {"effects": [examples.PLAY]}
    assert headline(besides).startswith("Besides backlash, something is missing")


def test_undecided():
    sentence = headline(examples.cannot_tell())
    assert "cannot tell what: it acts in the valve" in sentence
    assert sentence.endswith("likeliest is seat leakage or erosion of the trim near the seat.")
    undetected = examples.cannot_tell()
    undetected["mismatch"] |= {"detected": False, "p_value": None}
    undetected |= {"effects": [], "next_test": "The data must be mended."}
    assert headline(undetected) == "This recording cannot tell whether anything is missing."
    for reasons in ([], ["The data must be mended."]):
        assert _glance(undetected | {"reasons": reasons}) == {"What to do next": "The data must be mended."}
    told = _glance(undetected | {"reasons": ["The value hardly moves."]})
    assert told["How sure"] == "The value hardly moves."


@pytest.mark.parametrize("make", examples.ALL)
def test_it_is_short_and_one_sentence(make):
    sentence = headline(make())
    assert len(sentence) < 320
    assert sentence.endswith(".")
    assert "p = " not in sentence
    assert "p < " not in sentence


def test_without_a_frequency_the_grade_and_its_reason_stand_in_its_place():
    made = examples.graded()
    told = _glance(made)["How sure"]
    assert told.startswith("Moderate evidence. How often such names hold was not checked for gas. A diff")
    assert "%" not in told.split("A difference")[0]
    assert "(moderate evidence)" in summary_sentence(made)
    made["verdict"] = "cannot_tell"
    assert headline(made).endswith("; likeliest is seat leakage or an open bypass.")
    assert "likeliest is seat leakage, then an open bypass" in summary_sentence(made)


def test_a_weak_finding_beside_others_is_not_named():
    made = examples.named_twice()
    weak = {"level": "weak", "reason": "The interval of its leak kv holds the value at which it vanishes."}
    made["effects"][1] = made["effects"][1] | {"grade": weak}
    for sentence in (headline(made), summary_sentence(made)):
        assert "backlash" in sentence
        assert "seat leakage" not in sentence
    assert "seat leakage" not in _glance(made)["How sure"]
