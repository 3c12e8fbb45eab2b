# SPDX-License-Identifier: BSD-3-Clause
"""Whether what is missing is called by its name, and silence where a record leaves it open."""

import pytest

from benchmarks.concealed.scoring import honesty, naming
from benchmarks.concealed.scoring.lines import distinguishable_only
from benchmarks.concealed.scoring.rates import Rate


@pytest.fixture
def lines(a_line, a_failure):
    """Ten records: six with one effect, a pair, one of no catalogue, two healthy."""
    outside = {"verdict": "none_of_these", "concealed": ["bow"]}
    return [
        a_line("a", "named", "a/b", distinguishable=True),
        a_line("a", "named", "b/c/d/a", distinguishable=True),
        a_line("a", "named", "b", distinguishable=True),
        a_line("a", "cannot_tell", distinguishable=False),
        a_line("b", "named", "b", "c"),
        a_failure("b", distinguishable=True, concealed=["b"]),
        a_line("a+b", "named", "a"),
        a_line("", "cannot_tell", "a", **outside),
        a_line(),
        a_line("", "named", "a/b"),
    ]


def test_the_right_class(lines):
    assert naming.class_right(lines) == Rate(2, 6)
    assert naming.class_right(distinguishable_only(lines)) == Rate(2, 4)
    assert naming.class_holds(lines) == Rate(3, 6)  # with a wrong one beside it
    assert naming.mean_class_size(lines).value == pytest.approx((2 + 4) / 2)
    # two of four of a, none of two of b
    assert naming.macro_right(lines).value == pytest.approx((2 / 4 + 0 / 2) / 2)


def test_the_size_of_the_class_that_holds_it(a_line):
    assert naming.class_size(a_line("a", "named", "b/c/d", "e/a")) == 2
    assert naming.class_size(a_line("a", "named", "b/c/d")) is None


def test_names_by_belief(lines, a_line):
    assert naming.top(lines, 1) == Rate(2, 6)
    assert naming.top(lines, 3) == Rate(2, 6)
    assert naming.top(lines, 4) == Rate(3, 6)
    told = [{"members": [0.5, 0.3]}, {"members": [0.9, 0.8]}]
    line = a_line("a", "cannot_tell", "c/a", "b/a", told=told)
    assert naming.ranking(line) == ["b", "a", "c"]  # each name once, with the most told of it


def test_wrong_names_are_counted_over_all_records(lines):
    # b for a; c beside b; a where no catalogue holds it; a/b in a healthy valve
    assert naming.wrong_name(lines) == Rate(4, 10)
    assert naming.wrong_candidate(lines) == Rate(1, 10)
    assert naming.breaks(lines) == Rate(1, 10)


def test_silence_and_what_the_generator_cannot_tell(lines):
    assert naming.abstention(lines) == Rate(2, 7)
    assert naming.not_distinguishable(lines) == Rate(1, 5)


def test_useful_and_true(lines):
    """Right are two single ones and one healthy; four wrong names cost two each."""
    worth = naming.useful_and_true(lines)
    assert worth.value == pytest.approx((3 - 2 * 4) / 10)
    assert worth.low < worth.value < worth.high


def test_silence_is_useful_where_the_record_leaves_it_open(a_line):
    near = {"distances": {"nothing": 30.0, "others": {"b": 3.0}}}
    assert naming.useful(a_line("a", "cannot_tell", **near))
    assert not naming.useful(a_line("a", "cannot_tell", "b", **near))  # a wrong candidate
    assert not naming.useful(a_line("a", "no_mismatch", **near))  # 30 from nothing
    assert naming.useful(a_line("a", distances={"nothing": 3.0, "others": {}}))
    assert not naming.useful(a_line("a", "cannot_tell", distances={"nothing": 30.0, "others": {"b": 9.0}}))
    assert not naming.useful(a_line("a", "cannot_tell"))


def test_nothing_at_all():
    assert str(naming.class_right([])) == str(naming.macro_right([])) == "-"
    assert str(naming.mean_class_size([])) == str(naming.useful_and_true([])) == "-"


def test_all_broken(a_failure):
    lines = [a_failure("a"), a_failure("b"), a_failure()]
    assert naming.class_right(lines) == naming.top(lines, 3) == Rate(0, 2)
    assert naming.wrong_name(lines) == Rate(0, 3)
    assert naming.abstention(lines) == Rate(0, 0)
    assert str(naming.mean_class_size(lines)) == "-"
    assert naming.useful_and_true(lines).value == 0.0
    assert naming.breaks(lines) == Rate(3, 3)


def test_bad_input_that_is_refused_is_no_breakdown(a_line, a_failure):
    refused = a_failure("a") | {"failed": "InputError: p2 lies above p1 in every row"}
    lines = [a_line(), a_failure("a"), refused]
    assert naming.breaks(lines) == naming.refusals(lines) == Rate(1, 3)


@pytest.mark.parametrize(
    ("verdict", "classes", "to_nothing", "to_other", "ambiguous"),
    [
        ("cannot_tell", [], 30.0, 3.0, True),
        ("named", ["a/b"], 30.0, 3.0, True),
        ("named", ["a"], 30.0, 3.0, False),
        ("named", ["b/c"], 30.0, 3.0, False),  # several names, none of them true
        ("none_of_these", [], 30.0, 3.0, False),
        ("no_mismatch", [], 30.0, 3.0, False),
        ("no_mismatch", [], 5.9, None, True),
        ("no_mismatch", [], None, 3.0, False),
    ],
)
def test_what_leaves_it_open(a_line, verdict, classes, to_nothing, to_other, ambiguous):
    distances = {"nothing": to_nothing, "others": {"b": to_other, "c": None}}
    line = a_line("a", verdict, *classes, distances=distances)
    assert honesty.left_open(line)
    assert honesty.ambiguous(line) is ambiguous
    assert honesty.told_open([line]) == Rate(int(ambiguous), 1)


def test_answers_where_nothing_is_open(a_line, a_failure):
    clear = {"distances": {"nothing": 400.0, "others": {"b": 20.1}}}
    between = {"distances": {"nothing": 400.0, "others": {"b": 20.0}}}
    lines = [a_line("a", "named", "a", **clear), a_line("a", "named", "a/b", **clear)]
    lines += [a_line("a", "named", "b", **clear)]
    lines += [a_line("a", "cannot_tell", **clear), a_failure("a", **clear)]
    lines += [a_line("a", "named", "a", **between), a_line("a", "named", "a"), a_line()]
    assert honesty.answered(lines) == Rate(3, 5)  # whether rightly is asked elsewhere
    assert honesty.one_name(lines) == Rate(1, 5)
    assert honesty.told_open(lines) == Rate(0, 0)
    assert honesty.left_open(a_line("a")) is None
    assert not honesty.left_open(a_line("a", distances={"nothing": 6.0}))
