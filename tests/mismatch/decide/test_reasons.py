# SPDX-License-Identifier: BSD-3-Clause
"""A verdict that names nothing says why, and one that names something does not."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.decide.reasons import (
    exceeds_noise,
    leaves_pattern,
    not_upheld,
    reasons_of,
    too_much_left,
)
from sklvalve.mismatch.residual.goodness_of_fit import LeftOver
from sklvalve.mismatch.residual.pulses import Pulses
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.residual.smooth_pattern import Pattern

# 50 m3/h of span, recorded in m3/h
BENCH = SimpleNamespace(
    spans={"flow": 50.0 / 3600.0},
    recording=SimpleNamespace(per_si=lambda role: 3600.0, unit=lambda role: "m3/h"),
)


def _finding(*members):
    rivals = [_rival(name, probability) for name, probability in members]
    return SimpleNamespace(rivals=rivals, term=SimpleNamespace(onset=None))


def _rival(name, probability):
    member = SimpleNamespace(effect=SimpleNamespace(name=name))
    return SimpleNamespace(term=member, probability=probability, distance=0.0, model=None)


def _judged(verdict, **more):
    findings = more.pop("findings", [])
    return Judgement(None, verdict, 1e-4, findings, more.pop("unknown", None), None, None, **more)


@pytest.mark.parametrize("verdict", ["cannot_tell", "none_of_these"])
def test_a_nameless_verdict_always_has_a_reason(verdict):
    assert reasons_of(_judged(verdict), None, BENCH)
    assert reasons_of(_judged(verdict, why=("A check.",)), None, BENCH) == ["A check."]
    assert reasons_of(_judged(verdict), "Mend it.", BENCH) == ["Mend it."]


@pytest.mark.parametrize("verdict", ["named", "no_mismatch"])
def test_a_verdict_that_stands_needs_none(verdict):
    assert reasons_of(_judged(verdict), None, BENCH) == []


def test_checks_say_what_they_stopped_and_by_how_much():
    assert (
        "dead time or slew limit" in not_upheld([_finding(("dead_time", 0.5), ("slew_limit", 0.5))]).lower()
    )
    words = too_much_left(LeftOver("flow", 0.03, 0.005, 0.01, 4.0), [_finding(("backlash", 0.9))], BENCH)
    assert words.startswith("With backlash the simulation is off by 1.5 m3/h")
    assert "3 times the 0.5 m3/h" in words
    many = [_finding(*((f"effect_{k}", 0.1) for k in range(9)))]
    assert "effect 0 or effect 1 or effect 2 or one of 6 others" in not_upheld(many).lower()
    assert too_much_left(LeftOver("flow", 0.03, 0.005, 0.01, 4.0), [], BENCH).startswith(
        "The simulation is off"
    )


def test_what_findings_leave_over_is_said_in_the_signals_own_unit():
    left = LeftSince("flow", 0.03, 0.008, 0.01, many=60, rows=16, effect_size=5.0)
    words = exceeds_noise(left, [_finding(("backlash", 0.9))], BENCH)
    assert words.startswith(
        "With backlash the simulation's flow is still off by 1.5 m3/h within about 16 rows"
    )
    assert "noise and the errors of such a simulation come to 0.5 m3/h" in words


@pytest.mark.parametrize("signals", [("opening",), ("opening", "flow")], ids=["another", "the same"])
def test_what_differs_beside_a_name_is_said_with_its_size(signals):
    left = LeftSince("flow", 0.03, 0.008, 0.01, many=60, rows=16, effect_size=5.0)
    bench = SimpleNamespace(**vars(BENCH), touched_by=lambda terms: {c for _ in terms for c in signals})
    stem = SimpleNamespace(term=SimpleNamespace(effect="dead_time"))
    judged = _judged("named", findings=[stem], also=left)
    said = reasons_of(judged, None, bench)
    assert len(said) == ("flow" not in signals)
    for words in said:
        assert words.startswith("The flow differs from the history too, by 1.5 m3/h within about 16 rows")
        assert "its noise comes to 0.5 m3/h" in words
    # a name that is taken back takes it along
    assert not any("too" in words for words in reasons_of(_judged("cannot_tell", also=left), None, bench))


@pytest.mark.parametrize(
    ("inputs", "over"),
    [
        ((), "time"),
        (("opening", "dp"), "opening and pressure drop"),
        (("pressure_ratio", "temperature 150 s"), "pressure ratio and temperature lagged by 150 s"),
    ],
    ids=["time", "signals", "memory"],
)
def test_a_pattern_is_said_with_its_size_and_what_it_follows(inputs, over):
    pattern = Pattern("flow", inputs, 0.03, 4.0)
    words = leaves_pattern(pattern, [_finding(("backlash", 0.9))], BENCH)
    assert words.startswith(
        f"With backlash the simulation's flow is still off by 1.5 m3/h, smoothly over {over},"
    )
    bench = SimpleNamespace(**vars(BENCH), touched_by=lambda terms: {"opening"})
    stem = SimpleNamespace(term=SimpleNamespace(effect="dead_time"))
    (words,) = reasons_of(_judged("named", findings=[stem], also=pattern), None, bench)
    assert f"by 1.5 m3/h as a smooth pattern over {over}:" in words


def test_what_an_imitation_leaves_is_told_apart_from_what_was_there_before_it():
    unknown, pattern = SimpleNamespace(channel="flow", size=0.04), Pattern("flow", (), 0.01, 4.0)
    found, *_ = reasons_of(_judged("none_of_these", unknown=unknown), None, BENCH)
    left, *_ = reasons_of(_judged("none_of_these", unknown=unknown, pattern=pattern), None, BENCH)
    assert found == "No effect that was tried accounts for a predictable deviation of the flow by 2 m3/h."
    assert left == "The flow deviates predictably by 2 m3/h."


def test_moments_a_rest_and_a_change_are_reasons():
    pulses = Pulses(np.zeros(3, dtype=bool), 12, 1, True, 0.02, 1e-4)
    assert "12 moments" in reasons_of(_judged("none_of_these", pulses=pulses), None, BENCH)[0]
    unknown = SimpleNamespace(channel="flow", size=0.04)
    assert "flow by 2 m3/h" in reasons_of(_judged("none_of_these", unknown=unknown), None, BENCH)[0]
    assert (
        "The flow changed at one time, and no effect that was tried can be named for it."
        in reasons_of(_judged("cannot_tell", change=SimpleNamespace(channel="flow")), None, BENCH)[0]
    )
