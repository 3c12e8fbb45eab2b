# SPDX-License-Identifier: BSD-3-Clause
"""The top of the page: verdict, effect class, place and size in one short sentence, and three answers."""

import copy

import pytest

from sklvalve.mismatch import Diagnosis
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
        "Likely fault: the seat leaks or a bypass is open, in the valve, below 12 % opening, from 812 s on. "
        "It moves the flow by 3 % of span where it acts (leak Kv 0.8 m3/h)."
    )
    assert _glance(made) == {
        "How sure": "In blind tests on simulated valves such a diagnosis was right in 97 % of cases: one "
        "of the two causes was the true one. A difference as large comes by chance in fewer than 1 of 1000 "
        "recordings of a healthy valve (p < 0.001).",
        "What to do next": "Close the valve for 60 s.",
        "What correcting it brings": "Including it lowers the flow error on 1440 unseen rows from 1.9 to "
        "0.22 m3/h. For comparison: a black box trained on the same rows has 0.5 m3/h, noise alone gives "
        "0.2 m3/h.",
    }


def test_one_cause_alone_has_the_frequency_of_its_kind():
    made = examples.named()
    made["effects"] = [examples.PLAY | {"probability": 0.94}]
    told = "In blind tests on simulated valves such a diagnosis was right in 94 % of cases."
    assert _glance(made)["How sure"].startswith(told)


def test_sizes_are_in_the_recorded_unit_where_the_span_is_known():
    made = examples.named() | {"units": {"flow": "l/min"}, "spans": {"flow": 600.0, "opening": 1.0}}
    made["effects"][0] = examples.LEAK | {"size": {"flow": 0.032, "opening": 0.02}}
    assert "It moves the flow by 19 l/min and the opening by 2 % of travel where it acts" in headline(made)


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
    begin = "Likely fault: 1. the stem has play (backlash), in the actuator (play 3.1 % of travel"
    assert sentence.startswith(begin)
    assert "; 2. the seat leaks or a bypass is open, in the valve (" in sentence
    sure = _glance(examples.named_twice())["How sure"]
    assert sure.startswith(
        "In blind tests on simulated valves such diagnoses were right in more than 99 % of cases for "
        "backlash and 97 % of cases for seat leakage or an open bypass."
    )


def test_nothing_missing():
    made = examples.no_mismatch()
    assert headline(made).startswith("Nothing is missing")
    assert _glance(made)["What to do next"] == "Nothing needs to be done."
    assert "What correcting it brings" not in _glance(made)
    made["mismatch"] |= {"p_value": 1e-6}
    assert headline(made).startswith("Nothing relevant is missing")


@pytest.mark.parametrize("p_value", [1.0, 0.43, 0.05])
def test_common_by_chance_is_no_sign_of_a_fault_where_nothing_is_missing(p_value):
    made = examples.no_mismatch()
    made["mismatch"] |= {"p_value": p_value}
    assert _glance(made)["How sure"] == "No sign of a fault."
    undecided = made | {"verdict": "cannot_tell", "reasons": ["The value hardly moves."]}
    undecided["mismatch"] = made["mismatch"] | {"detected": False}
    # what is left open reassures nobody
    told = _glance(undecided)["How sure"]
    assert "No sign" not in told
    assert told.endswith("The value hardly moves.")


@pytest.mark.parametrize("verdict", ["named", "none_of_these", "cannot_tell", "no_mismatch"])
def test_where_something_was_detected_there_is_a_sign(verdict):
    made = {"named": examples.named, "cannot_tell": examples.cannot_tell}.get(
        verdict, examples.none_of_these
    )()
    made |= {"verdict": verdict}
    # by a level that the user has raised
    made["mismatch"] |= {"detected": verdict != "no_mismatch", "alpha": 0.2, "p_value": 0.1}
    told = _glance(made)["How sure"]
    assert "No sign of a fault" not in told
    assert "10 % of recordings of a healthy valve (p = 0.1)" in told
    page = Diagnosis(made)._repr_html_()
    assert "no sign of a fault" not in page.lower()


def test_a_rare_difference_keeps_its_chance():
    made = examples.no_mismatch()
    made["mismatch"] |= {"p_value": 0.0323}
    assert "3 % of recordings of a healthy valve (p = 0.0323)" in _glance(made)["How sure"]


def test_nothing_is_said_of_an_error_that_does_not_fall_where_nothing_was_found():
    made = examples.cannot_tell() | {"effects": []}
    made["fit"] = copy.deepcopy(examples.no_mismatch()["fit"])
    made["fit"]["flow"]["rmse"]["corrected"] = 1.9
    assert "What correcting it brings" not in _glance(made)
    assert "lower" not in summary_sentence(made)


def test_without_a_data_sheet_nothing_is_declared_sound():
    made = examples.no_mismatch()
    needs = "a data sheet that gives the trim's characteristic"
    made["not_testable"] = [{"name": "gas_expansion", "needs": "a gas"}]
    assert _glance(made)["What to do next"] == "Nothing needs to be done."
    made["not_testable"].append({"name": "seat_leakage", "needs": needs})
    told = (
        "Give the data sheet's capacity and characteristic. Without the data sheet, wear or a leak cannot be "
        "told from the trim's shape."
    )
    assert _glance(made)["What to do next"] == told
    made["next_test"] = "Move the valve."
    assert _glance(made)["What to do next"] == f"{told} To learn more: Move the valve."
    # these are the words of the catalogue, so that a change there is seen here
    assert SeatLeakage.requires == CapacityError.requires == Erosion.requires == needs
    # of two that were asked for no more, nor less, may be said at the top
    for words in (headline(made), summary_sentence(made)):
        assert words.startswith("Nothing is missing, as far as a recording without a data sheet can show: ")
        assert "data-sheet tolerances" not in words


def test_a_place_that_the_name_says_is_not_said_again():
    made = examples.named()
    leak = {"members": [{"name": "actuator_leak", "probability": 0.97}], "blocks": ["actuator"]}
    made["effects"][0] = examples.LEAK | leak
    assert headline(made).startswith("Likely fault: the actuator leaks air, below 12 % opening,")
    made["effects"].append(examples.PLAY)
    for sentence in (headline(made), summary_sentence(made)):
        assert "1. the actuator leaks air (" in sentence
        assert "2. the stem has play (backlash), in the actuator (" in sentence


def test_what_no_effect_explains():
    made = examples.none_of_these() | {"unknown": {"signal": "flow", "inputs": ["opening"], "size": 0.04}}
    made["location"] = made["location"] | {"onset": None, "intervals": []}
    assert headline(made) == (
        "Something is missing that no known effect explains. It acts in the valve and moves the flow by "
        "4 % of span."
    )
    assert "follows from opening, so it is not noise." in _glance(made)["How sure"]
    made["unknown"] |= {"closest": [{"members": examples.LEAK["members"]}], "closest_leaves": 0.05}
    told = "Seat leakage or an open bypass fits best, but 5 % of span beyond noise would remain."
    assert told in _glance(made)["How sure"]
    besides = made | {"effects": [examples.PLAY]}
    assert headline(besides).startswith("Besides backlash, something is missing")


def test_undecided():
    sentence = headline(examples.cannot_tell())
    begin = "Something is missing; the recording does not identify what. It acts in the valve"
    assert sentence.startswith(begin)
    assert sentence.endswith("Most likely: seat leakage or erosion of the trim near the seat.")
    undetected = examples.cannot_tell()
    undetected["mismatch"] |= {"detected": False, "p_value": None}
    undetected |= {"effects": [], "next_test": "The data must be mended."}
    assert headline(undetected) == "This recording cannot show whether anything is missing."
    for reasons in ([], ["The data must be mended."]):
        assert _glance(undetected | {"reasons": reasons}) == {"What to do next": "The data must be mended."}
    told = _glance(undetected | {"reasons": ["The value hardly moves."]})
    assert told["How sure"] == "The value hardly moves."


@pytest.mark.parametrize("make", examples.ALL)
def test_it_is_short(make):
    sentence = headline(make())
    assert len(sentence) < 320
    assert sentence.endswith(".")
    assert "p = " not in sentence
    assert "p < " not in sentence


def test_without_a_frequency_the_grade_and_its_reason_stand_in_its_place():
    made = examples.graded()
    told = _glance(made)["How sure"]
    reason = "How often such a diagnosis is right was not checked for gas."
    assert told.startswith(f"Moderate evidence. {reason} A diff")
    assert "blind tests" not in told
    assert "%" not in told.split("A difference")[0]
    assert "(moderate evidence)" in summary_sentence(made)
    made["verdict"] = "cannot_tell"
    assert headline(made).endswith("Most likely: seat leakage or an open bypass.")
    assert "most likely seat leakage, then an open bypass" in summary_sentence(made)


def test_a_weak_finding_beside_others_is_not_named():
    made = examples.named_twice()
    weak = {"level": "weak", "reason": "The interval of its leak Kv includes the value of no effect."}
    made["effects"][1] = made["effects"][1] | {"grade": weak}
    for sentence in (headline(made), summary_sentence(made)):
        assert "backlash" in sentence
        assert "seat leakage" not in sentence
    assert "seat leakage" not in _glance(made)["How sure"]
