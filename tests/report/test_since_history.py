# SPDX-License-Identifier: BSD-3-Clause
"""What a report says since the history: sizes, calibration, allowances, limits; nothing without one."""

import json
import re

import pytest

from sklvalve.mismatch import Diagnosis
from sklvalve.report import summary_sentence, to_markdown, to_text
from sklvalve.report.headline import headline
from sklvalve.report.html import render
from sklvalve.report.since_history import allowances, cannot_say, facts, section
from sklvalve.report.words import verdict_words
from tests.report import examples

EVIL = "<script>alert(1)</script><img src=x onerror=alert(2)>"


def _flat(words):
    return re.sub(r"\s+", " ", words)


@pytest.mark.parametrize("make", examples.ALL)
def test_without_a_history_nothing_is_said_of_one(make):
    made = make()
    assert section(made) is None
    for words in (to_text(made), to_markdown(made), summary_sentence(made), verdict_words(made)):
        assert "history" not in words


@pytest.mark.parametrize("make", examples.ALL)
def test_with_a_history_every_verdict_says_since_then(make):
    made = examples.since_history(make())
    if made.get("subject") == "loop":
        return
    for words in (headline(made), summary_sentence(made), Diagnosis(made)._repr_html_()):
        assert "since the history" in words
        assert "is missing" not in words
        assert "data-sheet tolerances" not in words


def test_a_sound_valve_has_changed_by_no_more_than_is_allowed():
    made = examples.since_history(examples.no_mismatch())
    told = "Nothing has changed since the history by more than is allowed: "
    assert headline(made).startswith(told)
    assert summary_sentence(made).startswith(told)
    assert verdict_words(made) == "nothing has changed since the history"
    assert dict(facts(made))["Changed"] == "Nothing by more than is allowed"
    # also where a difference is more than noise, and less than what is allowed
    made["mismatch"] = made["mismatch"] | {"p_value": 1e-6}
    assert headline(made).startswith(told)


def test_a_change_has_its_size_in_its_unit_and_in_flow():
    made = examples.since_history(examples.named())
    assert headline(made).startswith(
        "New since the history. Likely fault: the seat leaks or a bypass is open"
    )
    told = dict(facts(made))
    assert told["Changed"] == (
        "Seat leakage or an open bypass: leak Kv 0.8 m3/h [0.7 to 0.9]; flow 2.4 m3/h [2.1 to 2.7] at the "
        "same opening, rms where it acts"
    )
    assert told["History"] == (
        "2 recordings, 3600 rows, 12.0 h recorded, from 2024-01-03T00:00:00 to 2024-02-11T06:00:00"
    )
    assert told["Residual of flow, rms"] == (
        "0.2 m3/h in the history; in this recording 0.9 with the calibration expected, 0.21 with that of now"
    )


def test_what_is_no_more_than_a_candidate_may_have_changed():
    told = facts(examples.since_history(examples.cannot_tell()))
    assert [what for what, _ in told][1] == "May have changed"
    nameless = dict(facts(examples.since_history(examples.none_of_these())))
    assert nameless["Changed"] == "Something that no known effect explains"


def test_allowances_are_stated_with_how_to_set_them():
    made = examples.since_history(examples.no_mismatch())
    assert allowances(made["since_history"]) == [("Capacity, relative", "0.2 %")]
    told = "May change without a fault. Standard deviations. Capacity, relative: 0.2 %."
    assert told in _flat(to_text(made))
    assert told in to_markdown(made)


def test_what_a_history_cannot_say():
    made = examples.since_history(examples.no_mismatch()) | {"units": {"flow": "m3/h", "p1": "kPa"}}
    first, outside, blind = cannot_say(made)
    assert first.startswith("No opening was recorded:")
    assert outside == (
        "In 25 % of the rows the command is where the history has hardly been: from 10 to 90 % in the "
        "history, from 10 to 90 % here."
    )
    assert blind == "It says no more than the data sheet of: sharpness of the onset of choking."
    assert all(words in _flat(to_text(made)) for words in (first, outside, blind))


def test_what_is_there_from_the_start_came_between_history_and_recording():
    made = examples.since_history(examples.named_twice())
    assert "the start: it came between the history and this recording" in _flat(to_text(made))


def test_the_page_has_the_section_with_its_tables():
    pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
    page = render(Diagnosis(examples.since_history(examples.named()), {}))
    assert "<h2>Since the history</h2>" in page
    assert "What the history cannot say" in page
    assert "ValveHistory(allowance=Allowance(...)) sets them, and so does diagnose --allow" in page
    assert '<th scope="row">history before.csv</th>' in page
    assert "&#39;rows&#39;: 3600" not in page
    assert "Since the history" not in render(Diagnosis(examples.named(), {}))


def test_no_text_of_it_becomes_html():
    pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
    text = json.dumps(examples.since_history(examples.named()))
    for own in ("before.csv", "2024-01-03T00:00:00", "capacity, relative", "position_zero", '"command"'):
        changed = text.replace(own, json.dumps(EVIL) if own.startswith('"') else EVIL)
        page = render(Diagnosis(json.loads(changed), {}))
        assert "<script>alert" not in page, own
        assert "<img" not in page, own
