# SPDX-License-Identifier: BSD-3-Clause
"""The result as dict, table and page: a copy, plain, and escaped."""

import copy
import pickle

import pytest

from sklvalve.mismatch import Diagnosis


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


def test_verdict_in_the_caption_is_escaped_too():
    assert "&lt;i&gt;none of these" in Diagnosis({"verdict": "<i>none_of_these", "effects": []})._repr_html_()


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
