# SPDX-License-Identifier: BSD-3-Clause
"""Several effects at once, and effects that no catalogue holds."""

import pytest

from benchmarks.concealed.scoring import sets
from benchmarks.concealed.scoring.rates import Rate


@pytest.fixture
def pairs(a_line, a_failure):
    """Both, one, one with a wrong one beside it, candidates only, broken."""
    return [
        a_line("a+b", "named", "a/c", "b"),
        a_line("a+b", "named", "a/b"),
        a_line("a+b", "named", "a", "c"),
        a_line("a+b", "cannot_tell", "a", "b"),
        a_failure("a+b"),
    ]


def test_pairs(pairs):
    assert sets.exact_set(pairs) == Rate(1, 5)
    assert sets.at_least_one(pairs) == Rate(3, 5)


def test_precision_recall_and_f1(pairs, a_line):
    """Told 2, 1, 2, 0, 0 things, of which 2, 1, 1 are true; 10 are there."""
    assert sets.precision(pairs) == Rate(4, 5)
    assert sets.recall(pairs) == Rate(4, 10)
    assert sets.f1(pairs).value == pytest.approx(2 * 4 / (5 + 10))
    with_single = [*pairs, a_line("a", "named", "a"), a_line("a")]
    assert sets.precision(with_single) == Rate(5, 6)
    assert sets.precision(with_single, "pair") == Rate(4, 5)
    assert sets.recall(with_single, "single") == Rate(1, 2)


def test_precision_and_recall_without_records(a_line):
    assert str(sets.precision([])) == str(sets.recall([])) == str(sets.f1([])) == "-"
    assert sets.precision([a_line("a")]) == Rate(0, 0)
    assert sets.f1([a_line("a")]).value == 0.0


def test_of_no_catalogue(a_line, a_failure):
    outside = {"verdict": "none_of_these"}
    lines = [
        a_line("", "none_of_these", **outside),
        a_line("", "none_of_these", "a", **outside),
        a_line("", "cannot_tell", **outside),
        a_line("", "named", "a/b", **outside),
        a_line("", "no_mismatch", **outside),
        a_failure(**outside),
        a_line("", "none_of_these"),  # healthy: an alarm, and not asked here
    ]
    assert sets.flagged(lines) == Rate(1, 6)
    assert sets.left_undecided(lines) == Rate(1, 6)
    assert sets.misnamed(lines) == Rate(2, 6)
    assert sets.falsely_flagged(lines) == Rate(0, 0)


def test_of_the_catalogue_and_flagged(a_line, a_failure):
    lines = [a_line("a", "none_of_these"), a_line("a+b", "named", "a"), a_failure("a"), a_line("a")]
    assert sets.falsely_flagged(lines) == Rate(1, 3)
    assert sets.flagged(lines) == Rate(0, 0)
