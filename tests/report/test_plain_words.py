# SPDX-License-Identifier: BSD-3-Clause
"""What a user reads is plain: no private or archaic words, statistics under details, recorded units."""

import copy
import re
from functools import cache

import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import Diagnosis, MissingPhysicsFinder
from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE
from sklvalve.recording import Recording, Valve
from sklvalve.report import summary_sentence, to_markdown, to_text
from sklvalve.report import words as of_reports
from sklvalve.report.html import render
from tests.report import examples

# private or archaic, with word boundaries; "rest" is a word of its own only where it is a residual
ARCHAIC = (
    r"\bspells?\b",
    r"\bafresh\b",
    r"\banew\b",
    r"\bforeseen\b",
    r"\bforesees\b",
    r"\bcircumstances\b",
    r"\bsifting\b",
    r"\bsealed\b",
    r"\bnought\b",
    r"\bto and fro\b",
    r"\bsuch names\b",
    r"\bimitates?\b",
    r"\bcourses?\b",
    r"\brest of (the )?(flow|opening|value)\b",
    r"\b(learnt|slow) rest\b",
    r"\brows that rest\b",
    r"\brests show\b",
    r"\bborne out\b",
    r"\btold without\b",
    r"\bcomes back\b",
    r"\bsize that (counts|matters)\b",
    r"\bless simulated\b",
    r"\bleaves out\b",
    r"\bcannot tell\b",
    r"\blikeliest\b",
    r"\bstands? (below|beside|still there)\b",
    r"\bso large a\b",
    r"\bis no noise\b",
    r"\bbuilt so\b",
    r"\bled by\b",
)
STATISTICS = (r"\bD = ", r"\bdistance D\b", r"\bnats?\b", r"\bp = (1|0\.[1-9])")
# every recording is short, and few effects are asked, so that all of it takes seconds
SMALL = {"n_samples": 1000, "n_later": 0}
ASKED = ["seat_leakage", "bypass_open", "backlash", "clogging", "flow_meter_bias"]
MADE = {
    "healthy": {"effect": None, "random_state": 5},
    "leak": {"effect": "seat_leakage", "strength": 0.08, "random_state": 3},
    "no catalogue": {"effect": "hydrate_pulses", "random_state": 13},
    "no sheet": {"effect": "seat_leakage", "random_state": 11, "sheet": False},
    "loop": {"effect": "stiction", "strength": 0.05, "random_state": 4, "drop": ("opening", "p1", "p2")},
}


@cache
def _diagnosis(name):
    return _diagnosed(**MADE[name])


def _diagnosed(drop=(), sheet=True, **settings):
    made = make_valve_recording(**settings, **SMALL, loop="wide")
    valve = copy.deepcopy(made.valve)
    for role in drop:
        valve["recording"].pop(role)
    if not sheet:
        valve["valve"] = {"tag": "unknown"}
    frame = made.frame.rename(columns={valve["recording"]["time"]: "time"})
    recording = Recording.from_frame(frame, Valve.from_dict(valve | {"recording": valve["recording"]}))
    return MissingPhysicsFinder(effects=ASKED).fit(recording).diagnosis_


# what these say is said by the made diagnoses too, which take no time
_SLOW = ("no catalogue", "no sheet")
_PARAMS = [pytest.param(name, marks=[pytest.mark.slow] if name in _SLOW else []) for name in MADE]


@pytest.fixture(scope="module", params=_PARAMS)
def made(request):
    return _diagnosis(request.param)


def _page_words(diagnosis):
    """Words of the page, those under details apart."""
    page = render(diagnosis)
    page = re.sub(r"<(script|style|svg).*?</\1>", " ", page, flags=re.DOTALL)
    details = " ".join(re.findall(r"<details>.*?</details>", page, flags=re.DOTALL))
    top = re.sub(r"<details>.*?</details>", " ", page, flags=re.DOTALL)
    return [" ".join(re.sub(r"<[^>]+>", " ", words).split()) for words in (top, details)]


def test_no_report_of_a_simulated_recording_holds_an_archaic_word(made):
    d = made.to_dict()
    words = [to_text(d), to_markdown(d), summary_sentence(d), made._repr_html_(), *_page_words(made)]
    for each in words:
        text = " ".join(each.split())
        assert [word for word in ARCHAIC if re.search(word, text, flags=re.IGNORECASE)] == [], text


@pytest.mark.parametrize("make", examples.ALL)
def test_no_report_of_a_made_diagnosis_holds_an_archaic_word(make):
    d = make()
    for each in (to_text(d), to_markdown(d), summary_sentence(d), *_page_words(examples.diagnosis(d, n=400))):
        text = " ".join(each.split())
        assert [word for word in ARCHAIC if re.search(word, text, flags=re.IGNORECASE)] == [], text


def test_likelihoods_and_distances_are_under_details_alone(made):
    d = made.to_dict()
    text = " ".join(to_text(d).split())
    top, details = text.split(" Details Test for any mismatch")
    page, folded = _page_words(made)
    for words in (top, page):
        assert [each for each in STATISTICS if re.search(each, words)] == [], words
    assert "Test for any mismatch: p" in folded
    if d["effects"]:
        assert "nats" in details
        assert "nats" in folded


@pytest.mark.slow
def test_the_corpus_is_varied():
    verdicts = {name: _diagnosis(name).verdict for name in MADE}
    assert verdicts["leak"] == "named"
    assert verdicts["no catalogue"] == "none_of_these"
    assert verdicts["healthy"] == "no_mismatch"
    assert _diagnosis("loop").to_dict()["subject"] == "loop"


def test_sizes_have_the_recorded_unit(made):
    d = made.to_dict()
    assert d["units"]["flow"] == "m3/h"
    if d["subject"] == "valve":
        assert d["spans"]["flow"] > 0.0
        assert "of span" not in to_text(d)


@pytest.mark.slow
def test_without_a_sheet_nothing_is_called_by_the_sheet():
    page, _ = _page_words(_diagnosis("no sheet"))
    assert "calibrated on this recording" in page
    assert "as the data sheet has it" not in page
    assert "by the data sheet" not in page


ROWS = {
    "a frequency": (examples.named, "was right in 97 % of cases", "such identifications"),
    "nothing found": (examples.no_mismatch, "No sign of a fault.", "does not fall"),
    "fault": (examples.named, "Likely fault: the seat leaks", "leaves out"),
    "undecided": (examples.cannot_tell, "the recording does not identify what", "what it is is not"),
    "not testable": (examples.named, "Without a temperature recorded: viscous", "(needs temperature)"),
}


@pytest.mark.parametrize("row", ROWS)
def test_rows_of_the_table(row):
    make, better, before = ROWS[row]
    for text in (to_text(make()), to_markdown(make())):
        words = " ".join(text.split())
        assert better in words
        assert before not in words


def test_weak_evidence_is_no_likely_cause():
    d = examples.graded()
    assert of_reports.verdict_words(d) == "likely cause found"
    d["effects"] = [
        d["effects"][0] | {"grade": {"level": "weak", "reason": "The command makes only 1 turn."}}
    ]
    assert of_reports.verdict_words(d) == "possible cause, weak evidence"


@pytest.mark.parametrize("effect", [*CATALOGUE, *EVENTS, *LATE], ids=lambda effect: effect.key)
def test_every_effect_has_a_name_and_a_clause(effect):
    assert effect.words
    assert effect.clause
    # a report knows the name alone, whichever form it is of
    assert of_reports.spoken(effect.name) == effect.words
    assert of_reports.class_clause([{"name": effect.name}]) == effect.clause


def test_a_zero_that_has_shifted_is_a_clause():
    zero = {"members": [{"name": "flow_meter_bias", "probability": 0.94, "kind": "fault"}], "kind": "fault"}
    shifted = examples.named() | {"effects": [examples.LEAK | zero | {"blocks": ["measurement"]}]}
    assert "Likely fault: the flow meter's zero has shifted, in the measurement" in to_text(shifted)


def test_what_hardly_acts_is_defined():
    d = examples.named()
    d["fit"]["flow"]["elsewhere"] = {"rows": 500, "rmse": {"nominal": 1.28, "corrected": 0.372}}
    words = " ".join(to_text(d).split())
    told = (
        "In rows where what was found has less than a quarter of its largest effect, the flow error is 0.372 "
        "m3/h (1.28 without the correction)."
    )
    assert told in words.split(" Details ")[1]
    assert "nothing acts" not in words


def test_details_are_folded_and_escaped():
    d = examples.named() | {"details": ["<img src=x onerror=alert(1)> 40 nats"]}
    d["effects"][0] = examples.LEAK | {"evidence": {"gain": 123.4, "runner_up": 45.0}}
    page = render(Diagnosis(d))
    folded = re.search(r"<details>\s*<summary>Details</summary>.*?</details>", page, flags=re.DOTALL)[0]
    folded = folded.replace("\N{NO-BREAK SPACE}", " ")
    assert "log-likelihood gain 123 nats; distance D to the nearest other explanation 45." in folded
    assert "&lt;img src=x" in folded
    assert "<img" not in page


def test_a_number_stays_on_a_line_with_its_unit():
    d = examples.named()
    for width in range(40, 97):
        lines = to_text(d, width=width).splitlines()
        assert not any(re.match(r"\s*(%|m3/h)(\s|$)", line) for line in lines)
