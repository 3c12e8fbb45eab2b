# SPDX-License-Identifier: BSD-3-Clause
"""The result as dict, table and page: a copy, plain, and escaped."""

import copy
import dataclasses
import pickle
from datetime import datetime, timedelta

import numpy as np
import pytest

from sklvalve.mismatch import Diagnosis, MissingPhysicsFinder


@pytest.fixture
def diagnosis():
    entry = {
        "members": [
            {"name": "<b>leak</b>", "probability": 0.61},
            {"name": "bypass_open", "probability": 0.39},
        ],
        "parameters": {"leak_kv": {"value": 0.81234, "unit": "<script>", "ci95": None}},
    }
    return Diagnosis({"verdict": "named", "effects": [entry, entry]})


def test_page_escapes_what_it_shows(diagnosis):
    page = diagnosis._repr_html_()
    assert "<b>" not in page
    assert "<script>" not in page
    assert "&lt;b&gt;leak&lt;/b&gt;" in page
    assert "leak_kv 0.812 &lt;script&gt;" in page
    assert page.count("<tr>") == 5


def test_page_begins_with_the_finding_how_sure_and_what_to_do():
    leak = [{"name": "seat_leakage", "probability": 0.61}, {"name": "bypass_open", "probability": 0.36}]
    content = {
        "verdict": "named",
        "mismatch": {"detected": True, "p_value": 4e-4},
        "effects": [{"kind": "fault", "members": leak, "probability": 0.97, "parameters": {}}],
        "next_test": "Close the <valve>.",
    }
    page = Diagnosis(content)._repr_html_()
    assert page.startswith(
        "<div><p><strong>Likely fault: seat leakage or bypass open.</strong></p>"
        "<p>How sure: Right in 97 % of blind tests; a difference as large comes by chance with p &lt; "
        "0.001.</p>"
        "<p>What to do next: Close the &lt;valve&gt;.</p><table>"
    )
    assert repr(Diagnosis(content)) == "<Diagnosis: named; seat_leakage or bypass_open; p < 0.001>"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"verdict": "none_of_these"}, "Something is missing that no known effect explains."),
        ({"verdict": "cannot_tell"}, "Something is missing; the recording does not identify what."),
        ({"verdict": "no_mismatch"}, "Nothing relevant is missing."),
        (
            {"verdict": "cannot_tell", "mismatch": {"detected": False}, "reasons": ["Mend <it>."]},
            "whether anything is missing.</strong></p><p>How sure: Mend &lt;it&gt;.",
        ),
    ],
)
def test_page_without_effects_has_words_and_no_table(content, words):
    page = Diagnosis(content | {"effects": []})._repr_html_()
    assert words in page
    assert "<table" not in page
    assert repr(Diagnosis(content | {"effects": []})) == f"<Diagnosis: {content['verdict']}>"


def test_what_could_not_be_tested_is_no_all_clear():
    content = {"verdict": "no_mismatch", "effects": [], "mismatch": {"p_value": 0.43}}
    content["not_testable"] = [{"name": "seat_leakage", "needs": "a data sheet"}] * 2
    page = Diagnosis(content)._repr_html_()
    assert "How sure: No sign of a fault." in page
    assert "is missing; 2 effects could not be tested, see not_testable." in page
    gas = {"name": "gas_expansion", "needs": "a gas", "applies": False}
    content["not_testable"] = [content["not_testable"][0], gas]
    assert "is missing; 1 effect could not be tested" in Diagnosis(content)._repr_html_()
    assert "not_testable" not in Diagnosis(content | {"not_testable": [gas]})._repr_html_()


def test_several_findings_are_told_with_their_own_probabilities():
    names = ("backlash", "choked_flow")
    play = {"width": {"value": 0.031, "unit": "1", "ci95": None}}
    entries = [
        {"kind": k, "members": [{"name": n, "probability": p}], "probability": p, "parameters": play}
        for k, n, p in zip(("fault", "property"), names, (0.999, 0.8), strict=True)
    ]
    page = Diagnosis({"verdict": "named", "effects": entries})._repr_html_()
    assert "Likely fault: backlash. The simulation lacks choked flow." in page
    told = "Right in more than 99 % of blind tests of backlash; right in 80 % of blind tests of choked flow."
    assert told in page
    assert "<td>width 0.031</td>" in page


def test_what_may_be_a_fault_or_a_property_is_called_neither():
    entries = [
        {"kind": kind, "members": [{"name": name, "probability": 0.9}], "probability": 0.9, "parameters": {}}
        for kind, name in (("either", "seat_leakage"), ("property", "choked_flow"), (None, "clogging"))
    ]
    page = Diagnosis({"verdict": "named", "effects": entries})._repr_html_()
    assert (
        "A fault, or a property that the simulation lacks: seat leakage. The simulation lacks choked flow. "
        "Not in the simulation: clogging."
    ) in page


def test_dict_is_a_copy(diagnosis):
    diagnosis.to_dict()["effects"].clear()
    assert diagnosis.effects == (("<b>leak</b>", "bypass_open"),) * 2
    assert diagnosis.verdict == "named"


def test_frame_has_a_row_for_each_explanation(diagnosis):
    pytest.importorskip("pandas", reason="a data frame needs pandas")
    frame = diagnosis.to_frame()
    assert list(frame.columns) == ["finding", "effect", "probability", "parameters"]
    assert list(frame["finding"]) == [1, 1, 2, 2]
    assert list(frame["parameters"]) == ["leak_kv 0.812 <script>", ""] * 2


def test_diagnosis_cannot_be_reassigned(diagnosis):
    with pytest.raises(AttributeError):
        diagnosis.content = {}


def test_what_was_found_cannot_be_changed():
    given = {"verdict": "named", "effects": [{"members": [{"name": "clogging"}]}]}
    diagnosis = Diagnosis(given)
    diagnosis.content["verdict"] = "no_mismatch"
    diagnosis.content["effects"][0]["members"].clear()
    given["verdict"] = "cannot_tell"
    assert diagnosis.verdict == "named"
    assert diagnosis.effects == (("clogging",),)


def test_copies_and_pickles_as_it_is(diagnosis):
    for back in (copy.deepcopy(diagnosis), pickle.loads(pickle.dumps(diagnosis))):
        assert back.content == diagnosis.content


def test_clock_time_of_the_first_sample_is_kept_where_there_is_one(healthy, found_healthy):
    assert "begins" not in found_healthy.diagnosis_.content["provenance"]
    first = datetime.fromisoformat("2024-03-01T13:28:00+01:00")
    stamps = [(first + timedelta(seconds=each)).isoformat() for each in healthy.time]
    dated = dataclasses.replace(healthy, stamps=np.array(stamps, dtype=object))
    content = MissingPhysicsFinder(effects="flow_meter_bias").fit(dated).diagnosis_.content
    assert content["provenance"]["begins"] == "2024-03-01T13:28:00+01:00"
