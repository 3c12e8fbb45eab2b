# SPDX-License-Identifier: BSD-3-Clause
"""One word for what came of a record."""

import pytest

from benchmarks.concealed.scoring.naming import class_holds, class_right
from benchmarks.concealed.scoring.outcome import WORDS, found_names, judge, wrongly_named

OUTSIDE = {"verdict": "none_of_these"}


@pytest.mark.parametrize(
    ("true", "truth", "verdict", "classes", "word"),
    [
        ("", {}, "no_mismatch", [], "right"),
        ("", {}, "cannot_tell", [], "alarm"),
        ("", {}, "named", ["erosion"], "alarm"),
        ("erosion", {}, "named", ["seat_leakage/erosion"], "right"),
        ("erosion", {}, "named", ["seat_leakage"], "wrong name"),
        ("erosion", {}, "named", ["erosion", "stiction"], "wrong name"),
        ("erosion", {}, "cannot_tell", ["erosion"], "cannot tell"),
        ("erosion", {}, "cannot_tell", ["stiction"], "wrong name"),
        ("erosion", {}, "cannot_tell", [], "cannot tell"),
        ("erosion", {}, "none_of_these", [], "none of these"),
        ("erosion", {}, "no_mismatch", [], "missed"),
        ("", OUTSIDE, "none_of_these", [], "right"),
        ("", OUTSIDE, "cannot_tell", [], "cannot tell"),
        ("", OUTSIDE, "named", ["erosion"], "wrong name"),
        ("", OUTSIDE, "none_of_these", ["erosion"], "wrong name"),
        ("", OUTSIDE, "no_mismatch", [], "missed"),
        ("", {"kind": "outside"}, "none_of_these", [], "right"),
        ("erosion+stiction", {}, "named", ["erosion", "stiction/friction"], "both found"),
        ("erosion+stiction", {}, "named", ["erosion"], "one found"),
        ("erosion+stiction", {}, "named", ["erosion/stiction"], "one found"),
        ("erosion+stiction", {}, "named", ["erosion", "clogging"], "wrong name"),
        ("erosion+stiction", {}, "cannot_tell", ["erosion", "stiction"], "neither"),
        ("erosion+stiction", {}, "no_mismatch", [], "neither"),
    ],
)
def test_one_word(a_line, true, truth, verdict, classes, word):
    line = a_line(true, verdict, *classes, **truth)
    assert judge(line) == word
    assert any(word in words for words in WORDS.values())


def test_a_diagnosis_that_broke(a_line, a_failure):
    assert judge(a_failure("erosion")) == "failed"
    assert judge(a_line("erosion", "named", "erosion") | {"failed": "ValueError"}) == "failed"
    assert judge({"truth": {"effects": ["erosion"]}}) == "failed"  # nothing was written but the truth
    assert not wrongly_named(a_failure("erosion"))


def test_every_name_is_wrong_where_nothing_with_a_name_is_concealed(a_line):
    assert wrongly_named(a_line("", "named", "erosion"))
    assert wrongly_named(a_line("", "cannot_tell", "erosion", verdict="none_of_these"))
    assert not wrongly_named(a_line("", "cannot_tell"))


def test_what_a_history_held_and_has_gone_since_is_named_rightly(a_line):
    history = {"holds": "another", "effects": ["clogging"]}
    line = a_line("erosion", "named", "erosion", "clogging", history=history)
    assert wrongly_named(line)  # without the history nothing says that a clogging has gone
    line |= {"method": "sklvalve_history"}
    assert not wrongly_named(line)
    assert judge(line) == "right"
    assert wrongly_named(a_line("erosion", "named", "stiction", history=history) | {"method": line["method"]})
    outside = a_line("", "named", "clogging", history=history, **OUTSIDE) | {"method": line["method"]}
    assert judge(outside) == "missed"
    same = {"holds": "same", "effects": ["clogging"]}
    assert wrongly_named(a_line("", "named", "clogging", history=same) | {"method": line["method"]})


@pytest.mark.parametrize(
    ("true", "verdict", "classes", "held", "word"),
    [
        ("clogging", "no_mismatch", [], ["clogging"], "right"),
        ("clogging", "no_mismatch", [], ["erosion/clogging"], "right"),
        ("clogging", "no_mismatch", [], ["erosion"], "wrong name"),
        ("clogging", "no_mismatch", [], [], "missed"),
        ("clogging", "named", ["erosion"], ["clogging"], "wrong name"),
        ("clogging", "cannot_tell", [], ["clogging"], "cannot tell"),
        ("clogging+erosion", "no_mismatch", [], ["erosion", "clogging"], "both found"),
        ("clogging+erosion", "no_mismatch", [], ["erosion/clogging"], "one found"),
    ],
)
def test_what_the_history_had_already_is_no_change_and_found_where_that_is_told(
    a_line, true, verdict, classes, held, word
):
    line = a_line(true, verdict, *classes, history={"holds": "same", "effects": true.split("+")})
    line["found"]["held"] = [{"names": names.split("/"), "change": "none"} for names in held]
    assert judge(line) == word
    assert class_right([line]) == class_holds([line])
    for change in ("gone", None):
        # what is there is not told by what is said to be gone, or not known of
        gone = line | {
            "found": line["found"] | {"held": [h | {"change": change} for h in line["found"]["held"]]}
        }
        assert judge(gone) == {"right": "missed", "both found": "neither"}.get(word, judge(gone))


def test_what_a_sound_history_is_told_to_have_had_is_a_wrong_name(a_line):
    line = a_line("", "no_mismatch", history={"holds": None, "effects": []})
    assert judge(line) == "right"
    line["found"]["held"] = [{"names": ["clogging"], "change": "none"}]
    assert wrongly_named(line)


def test_each_name_needs_a_class_of_its_own(a_line):
    one, both = a_line("a+b", "named", "a/b"), a_line("a+b", "named", "b/a", "a/c")
    assert len(found_names(one)) == 1
    assert found_names(both) == {"a", "b"}  # the first class is taken for b, since only it holds b
    assert found_names(a_line("a+b+c", "named", "a/b", "a/b", "c")) == {"a", "b", "c"}
    assert found_names(a_line("a", "cannot_tell", "a")) == set()
