# SPDX-License-Identifier: BSD-3-Clause
"""The rules that judge real recordings, on made-up diagnoses; the page holds its results."""

import pytest

from benchmarks.real import tables
from benchmarks.real.judging import errors_of, is_property, judged, referee
from benchmarks.real.windows import counts, windows_of

STICKS = {"faults": ["stiction", "backlash"]}
SOUND = {"sound": True}
MOTOR = {"sound": True, "properties": ["slew_limit", "dead_time"]}


def _named(*classes, probability=0.94, grade=None, kind=None):
    more = {"probability": probability, "grade": grade, "kind": kind}
    effects = [{"members": [{"name": n} for n in names.split("/")], **more} for names in classes]
    return {"verdict": "named", "effects": effects}


@pytest.mark.parametrize(
    ("diagnosis", "label", "judgement", "sure"),
    [
        (_named("stiction/friction"), STICKS, "right", True),
        (_named("friction"), STICKS, "wrong", True),
        (_named("friction", probability=0.4), STICKS, "wrong", False),
        (
            _named("friction", probability=None, grade={"level": "strong", "reason": "-"}),
            STICKS,
            "wrong",
            True,
        ),
        (
            _named("friction", probability=None, grade={"level": "weak", "reason": "-"}),
            STICKS,
            "wrong",
            False,
        ),
        (_named("slew_limit", "backlash"), STICKS, "right", True),
        (_named("stiction"), SOUND, "wrong", True),
        (_named("slew_limit"), MOTOR, "right", True),
        (_named("slew_limit/stuck_valve"), MOTOR, "right", True),
        (_named("slew_limit", "stiction"), MOTOR, "wrong", True),
        (_named("line_loss"), SOUND, "unjudged", False),
        (_named("stem_load", kind="property"), SOUND, "unjudged", False),
        (_named("line_loss", kind="fault"), SOUND, "wrong", True),
        ({"verdict": "no_mismatch"}, STICKS, "wrong", True),
        ({"verdict": "no_mismatch"}, MOTOR, "wrong", True),
        ({"verdict": "no_mismatch"}, SOUND, "right", True),
        ({"verdict": "cannot_tell"}, STICKS, "abstained", False),
        ({"verdict": "none_of_these"}, SOUND, "abstained", False),
        (_named("stiction"), None, "unjudged", False),
    ],
)
def test_answer_is_judged(diagnosis, label, judgement, sure):
    assert judged(diagnosis, label) == (judgement, sure)


def test_class_with_a_fault_is_no_property():
    assert is_property(_named("slew_limit/dead_time")["effects"][0])
    assert not is_property(_named("slew_limit/stuck_valve")["effects"][0])


@pytest.mark.parametrize(
    ("verdict", "rmse", "flags"),
    [
        ("no_mismatch", {"nominal": 1.0, "black_box": 0.5}, ["no_mismatch"]),
        ("no_mismatch", {"nominal": 1.0, "black_box": 0.51, "corrected": 1.0}, []),
        ("named", {"nominal": 1.0, "black_box": 0.1, "corrected": 1.1}, ["corrected"]),
        ("named", {"nominal": None, "black_box": 0.1}, []),
    ],
)
def test_referee_flags(verdict, rmse, flags):
    assert referee({"verdict": verdict, "fit": {"flow": {"rmse": rmse}}}) == flags


def test_errors_say_their_proof():
    fit = {"opening": None, "flow": {"unit": "m3/h", "rmse": {"nominal": 2.0}}}
    told = errors_of({"fit": fit, "proof": "later_rows"})
    assert told["signal"] == "flow"
    assert told["nominal"] == 2.0
    assert told["proof"] == "later_rows"
    assert told["unit"] == "m3/h"
    assert told["black_box"] is None
    assert told["corrected"] is None
    assert errors_of({}) == {}


def _row(name, judgement, **more):
    row = {"recording": name, "kind": "loop", "rows": 9, "sampling_s": 1.0, "verdict": "-", "seconds": 1.0}
    return row | {"judgement": judgement} | more


def test_failures_come_first_and_are_counted():
    rows = [_row("b", "right"), _row("c", "wrong"), _row("a", "wrong", sure=True), _row("d", "abstained")]
    text = tables.table(rows)
    assert "| loop | 1 | 2 | 1 | 1 | 0 | 0 | 0 |" in text
    places = [text.index(f"| {name} | loop") for name in "acdb"]
    assert places == sorted(places)


def test_right_names_tell_how_many_shared_the_class():
    label = {"sound": True, "properties": ["slew_limit"]}
    names = [{"members": ["slew_limit", "backlash"]}, {"members": ["clogging"]}]
    row = _row("a", "right", label=label, names=names)
    assert tables.right_sizes(row) == [2]
    assert tables.right_sizes(row | {"judgement": "wrong"}) == []
    assert "| right, of 2 names |" in tables.table([row])


def test_recordings_of_one_valve_count_once_and_simulated_ones_apart():
    rows = [_row(f"belimo_{k}", "right", kind="actuator") for k in range(3)]
    rows += [_row("refinery_0", "abstained", note="FIC1"), _row("refinery_1", "wrong", note="FIC1; cut")]
    rows += [_row("made", "wrong", kind="simulated by others"), _row("water", "unjudged")]
    assert tables.valves_of(rows[:5]) == {("actuator", "motor"): "right", ("loop", "FIC1"): "wrong"}
    text = tables.counts(rows)
    assert "interval: 1 of 4, 25 % (1-81);" in text
    assert "counted by valve 1 of 2, 50 % (1-99)." in text
    assert "| simulated by others | 0 | 1 |" in text


def test_last_line_of_a_recording_holds_and_a_broken_one_is_left_out(tmp_path):
    file = tmp_path / "results.jsonl"
    file.write_text('{"recording": "a", "n": 1}\n{"recording": "a", "n": 2}\n{"rec', encoding="utf-8")
    assert tables.read(file) == [{"recording": "a", "n": 2}]


def test_page_holds_its_results():
    page = tables.PAGE.read_text(encoding="utf-8")
    if not tables.RESULTS.exists():
        pytest.skip("benchmarks/real/results holds no results.jsonl yet")
    assert page == tables.with_block(page, tables.read(tables.RESULTS)), (
        "run python -m benchmarks.real --page"
    )


def test_names_are_counted_once_a_window():
    assert windows_of(1000) == [(0, 620), (0, 310), (310, 620), (155, 465), (620, 1000)]
    each = [[["slew_limit"], ["backlash", "slew_limit"]], [["slew_limit", "dead_time"]], []]
    assert list(counts(each).items()) == [("slew_limit", 2), ("backlash", 1), ("dead_time", 1)]
