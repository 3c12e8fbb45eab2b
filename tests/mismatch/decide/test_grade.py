# SPDX-License-Identifier: BSD-3-Clause
"""Grades: what makes a finding strong, moderate or weak, with and without a frequency that was checked."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.mismatch.decide.assessing import assessed
from sklvalve.mismatch.decide.borne_out import SEALED
from sklvalve.mismatch.decide.checked_kind import few_signals, unchecked
from sklvalve.mismatch.decide.decision import strong_enough
from sklvalve.mismatch.decide.grade import grade_of
from sklvalve.mismatch.decide.probability import Grounds, left_over, probability_of

CLEAR = Grounds("dead_time", 1e-6)
PLAIN = {"skill": 0.9, "vanishes": [], "at_bound": []}


def _grade(probability=0.95, grounds=CLEAR, unchecked="", **evidence):
    return grade_of(probability, grounds, PLAIN | evidence, unchecked)


def test_by_its_probability():
    levels = [_grade(p)["level"] for p in (0.95, 0.7, NAMED_FROM - 0.01)]
    assert levels == ["strong", "moderate", "weak"]


def test_reasons_are_one_plain_sentence():
    assert _grade()["reason"] == (
        "A difference this large is rare among healthy valves, and the correction explains 90 % of it on "
        "forecast rows."
    )
    friction = _grade(0.7, Grounds("friction", 1e-4))["reason"]
    assert friction.startswith("In blind tests ")
    assert "diagnoses that named this effect first were right" in friction
    seen = _grade(0.7, Grounds("friction", 1e-4, history=True))["reason"]
    right, many = SEALED.held_by(True)["friction"]
    assert f"{right} of {many} diagnoses" in seen
    assert seen != friction
    coarse = _grade(0.7, Grounds("dead_time", 1e-4, coarse=True))
    assert coarse["reason"] == "The recorded values are compressed or coarsely quantised."
    few = _grade(0.7, Grounds("dead_time", 1e-4, few_signals=True))
    assert few["reason"] == "The opening or a pressure is not recorded."
    left = _grade(0.7, Grounds("dead_time", 1e-6, left=16.0), skill=0.3)
    assert left["reason"] == "The correction explains only 30 % of the difference on forecast rows."


def test_an_interval_that_holds_zero_names_nothing():
    grounds = Grounds("flow_meter_bias", 1e-6, may_vanish=True)
    grade = _grade(0.95, grounds, vanishes=["bias"])
    assert grade["level"] == "weak"
    assert grade["reason"] == "The interval of its bias includes the value of no effect."


def test_a_size_without_an_interval_names_nothing():
    grade = _grade(0.95, no_interval=["leak_kv"])
    assert grade["level"] == "weak"
    assert grade["reason"] == "No interval of its leak Kv is known."


def test_of_a_size_without_an_interval_no_frequency_is_told():
    entry = _entry("flow_meter_bias")
    entry["evidence"]["no_interval"] = ["bias"]
    (weak,), verdict, reasons = _assessed([entry])
    assert verdict == "cannot_tell"
    assert weak["probability"] is None
    assert reasons == ["Flow meter bias is too uncertain to be named: no interval of its bias is known."]
    # a name beside it stays, with its frequency
    (named,), verdict, _ = _assessed([_entry(), entry])
    assert verdict == "named"
    assert named["probability"] is not None


def test_what_acts_in_the_first_rows_alone_is_no_name():
    grade = _grade(0.99, at_first=True)
    assert grade["level"] == "weak"
    assert "what happened before the recording" in grade["reason"]


def test_without_a_frequency_only_what_explains_most_is_strong():
    assert _grade(unchecked="gas", skill=0.9)["level"] == "strong"
    assert _grade(unchecked="gas", skill=0.5)["level"] == "moderate"
    assert _grade(unchecked="gas", skill=None)["level"] == "moderate"
    assert _grade(unchecked="gas", skill=-0.1)["level"] == "weak"
    # forecasts cannot know of what begins behind their last origin
    assert _grade(unchecked="gas", skill=None, late=True)["level"] == "strong"
    assert _grade(unchecked="gas")["reason"].endswith(
        "; how often such a diagnosis is right was not checked for gas."
    )


# ---- kinds of recordings


def _bench(
    known=True,
    electric=False,
    supply=2.4e5,
    pieces=(),
    rows=3000,
    seconds=1.0,
    fluid=(),
    lacks=(),
    history=None,
):
    class Signals(dict):
        pieces = ()
        sample_time = 1.0

        def __len__(self):
            return rows

    roles = ("command", "flow", "opening", "p1", "p2", "temperature")
    recording = Signals({role: None for role in roles if role not in lacks})
    recording.pieces, recording.sample_time = pieces, seconds
    recording.time = seconds * np.arange(rows)
    sheet = {"kv_rated": 40.0, "characteristic": "linear" if known else None}
    valve = SimpleNamespace(fluid=dict.fromkeys(fluid, 1.0), supply_pressure=supply, **sheet)
    # without a pressure drop the trim is learnt, whatever the sheet gives
    trim = SimpleNamespace(known=known and not lacks)
    chain = SimpleNamespace(trim=trim, electric=electric, valve=valve)
    return SimpleNamespace(recording=recording, plain=chain, valve=valve, history=history)


@pytest.mark.parametrize(
    ("differs", "words"),
    [
        ({}, ""),
        ({"lacks": ("opening",)}, ""),
        ({"lacks": ("p2",)}, ""),
        ({"lacks": ("p1",)}, "without the inlet pressure"),
        ({"lacks": ("opening", "p2")}, "so few signals"),
        ({"lacks": ("flow",)}, "without flow"),
        ({"known": False}, "data sheet"),
        ({"electric": True}, "driven by air"),
        ({"supply": None}, "driven by air"),
        ({"pieces": ("a", "b")}, "several recordings"),
        ({"fluid": ("molar_mass",)}, "gas"),
        ({"rows": 600}, "600 rows"),
        ({"seconds": 10.0}, "10 s apart"),
        ({"history": "known"}, ""),
    ],
)
def test_kinds_that_were_checked(differs, words):
    reason = unchecked(_bench(**differs))
    assert words in reason if words else reason == ""
    assert few_signals(_bench(**differs).recording) == bool(set(differs.get("lacks", ())) - {"flow"})


# ---- entries


def _entry(name="dead_time", vanishes=(), onset=None):
    return {
        "members": [{"name": name, "probability": 0.9}, {"name": "slew_limit", "probability": 0.1}],
        "probability": 1.0,
        "size": {"flow": 0.05},
        "onset": onset,
        "evidence": {"gain": 100.0, "runner_up": 20.0, "vanishes": list(vanishes), "at_bound": []},
    }


AHEAD = {"flow": 0.8, "opening": None}


def _assessed(entries, ahead=AHEAD, bench=None):
    """Entries that may be named, the verdict that they leave, and why others are no names."""
    made = assessed(bench or _bench(), entries, 1e-5, ahead, [])
    verdict, left, doubts = strong_enough("named", made)
    return left, verdict, doubts


def test_what_begins_behind_an_origin_is_not_judged_by_what_forecasts_leave():
    ahead = {"flow": 0.1, "opening": None}
    (first,), _, _ = _assessed([_entry(onset=600.0)], ahead)
    (later,), _, _ = _assessed([_entry(onset=1500.0)], ahead)
    assert first["probability"] < later["probability"]
    assert later["probability"] == pytest.approx(probability_of(Grounds("dead_time", 1e-5)), abs=1e-4)


def test_entries_of_a_checked_kind():
    (first, second), verdict, reasons = _assessed([_entry(), _entry()])
    assert (verdict, reasons) == ("named", [])
    grounds = Grounds("dead_time", 1e-5, left=left_over(100.0, 0.8))
    assert first["probability"] == pytest.approx(probability_of(grounds), abs=1e-4)
    assert second["probability"] < first["probability"]
    assert sum(m["probability"] for m in first["members"]) == pytest.approx(first["probability"], abs=2e-4)
    assert first["members"][1]["probability"] / first["probability"] == pytest.approx(0.1, abs=2e-3)
    assert first["evidence"]["skill"] == 0.8
    assert first["grade"]["level"] == "strong"


def test_what_begins_late_has_no_skill():
    (entry,), _, _ = _assessed([_entry(onset=2990.0)], {"flow": 0.0})
    assert entry["evidence"]["late"]
    assert entry["evidence"]["skill"] is None


def test_entries_of_another_kind_have_a_grade_alone():
    (entry,), verdict, _ = _assessed([_entry()], bench=_bench(known=False))
    assert entry["probability"] is None
    assert [m["probability"] for m in entry["members"]] == [None, None]
    assert (entry["grade"]["level"], verdict) == ("strong", "named")


def test_an_effect_that_no_blind_test_has_named_has_no_probability():
    own = _entry()
    own["members"][0]["name"] = "worn_groove"
    (entry,), _, _ = _assessed([own])
    assert entry["probability"] is None
    assert [member["probability"] for member in entry["members"]] == [None] * len(entry["members"])
    assert "was not checked for an effect that no blind test has named" in entry["grade"]["reason"]


def test_the_verdict_is_taken_back_where_all_is_weak():
    weak = _entry("flow_meter_bias", ["bias"])
    _, verdict, reasons = _assessed([weak])
    assert verdict == "cannot_tell"
    assert reasons == [
        "Flow meter bias is too uncertain to be named: the interval of its bias includes the value of no "
        "effect."
    ]
    entries, verdict, reasons = _assessed([weak, _entry()])
    assert verdict == "named"
    assert [entry["members"][0]["name"] for entry in entries] == ["dead_time"]
    assert reasons[0].startswith("Flow meter bias is too uncertain")
    (entry,), _, _ = _assessed([_entry() | {"spells": [[0.0, 30.0]]}])
    assert entry["grade"]["level"] == "weak"
    assert strong_enough("no_mismatch", assessed(_bench(), [], 0.5, {}, [])) == ("no_mismatch", [], [])
