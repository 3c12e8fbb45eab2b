# SPDX-License-Identifier: BSD-3-Clause
"""A verdict that names nothing says why, and one that names something does not."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.adequacy import LeftOver
from sklvalve.mismatch.contents import Judgement
from sklvalve.mismatch.reasons import not_upheld, reasons_of, too_much_left


def _finding(*members):
    rivals = [_rival(name, probability) for name, probability in members]
    return SimpleNamespace(rivals=rivals, member=SimpleNamespace(onset=None))


def _rival(name, probability):
    member = SimpleNamespace(effect=SimpleNamespace(name=name))
    return SimpleNamespace(member=member, probability=probability, distance=0.0, model=None)


def _judged(verdict, **more):
    findings = more.pop("findings", [])
    return Judgement(verdict, 1e-4, findings, more.pop("unknown", None), None, None, **more)


@pytest.mark.parametrize("verdict", ["cannot_tell", "none_of_these"])
def test_a_nameless_verdict_always_has_a_reason(verdict):
    assert reasons_of(_judged(verdict), None)
    assert reasons_of(_judged(verdict, why=("A check.",)), None) == ["A check."]
    assert reasons_of(_judged(verdict), "Mend it.") == ["Mend it."]


@pytest.mark.parametrize("verdict", ["named", "no_mismatch"])
def test_a_verdict_that_stands_needs_none(verdict):
    assert reasons_of(_judged(verdict), None) == []


def test_a_candidate_is_told_how_far_it_is_from_a_name():
    (words,) = reasons_of(_judged("cannot_tell", findings=[_finding(("seat_leakage", 0.6))]), None)
    assert words.startswith("Seat leakage has 60 %")
    assert "85 %" in words


def test_checks_say_what_they_stopped_and_by_how_much():
    assert (
        "dead time or slew limit" in not_upheld([_finding(("dead_time", 0.5), ("slew_limit", 0.5))]).lower()
    )
    words = too_much_left(LeftOver("flow", 0.03, 0.005, 0.01, 4.0), [_finding(("backlash", 0.9))])
    assert "Backlash" in words
    assert "3 %" in words
    assert "3 times" in words
    assert too_much_left(LeftOver("flow", 0.03, 0.005, 0.01, 4.0), []).startswith("The simulation leaves")


def test_moments_a_rest_and_a_change_are_reasons():
    pulses = SimpleNamespace(many=12, against=1)
    assert "12 moments" in reasons_of(_judged("none_of_these", pulses=pulses), None)[0]
    unknown = SimpleNamespace(channel="flow", size=0.04)
    assert "4 %" in reasons_of(_judged("none_of_these", unknown=unknown), None)[0]
    assert "changed at one time" in reasons_of(_judged("cannot_tell", change=object()), None)[0]
