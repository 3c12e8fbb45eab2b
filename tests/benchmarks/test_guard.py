# SPDX-License-Identifier: BSD-3-Clause
"""A small benchmark in the tests: healthy records with nasty noise, and one of every third effect.

Rates are asserted, not single outcomes; `python -m benchmarks.concealed.guard judge` judges one of every
effect, and the whole benchmark is in docs/validation.md. Bounds lie below what was measured when they were
set, by what chance may do to so few records.
"""

import os
from collections import Counter

import pytest

from benchmarks.concealed.guard import HEALTHY, lines_of, records
from benchmarks.concealed.judging import line_of
from benchmarks.concealed.scoring.detection import alarms
from benchmarks.concealed.scoring.lines import of_kind
from benchmarks.concealed.scoring.naming import wrong_name
from benchmarks.concealed.scoring.outcome import judge


@pytest.fixture(scope="module")
def lines(tmp_path_factory):
    """A line of scores for every record."""
    places = records(tmp_path_factory.mktemp("guard"), every=3)
    return lines_of(places, min(os.cpu_count() or 1, 4))


def test_a_clogged_valve_is_named_by_a_record_with_another_sheet(tmp_path):
    # the one sealed record of the short part; it was named right before it was chosen
    (place,) = records(tmp_path, ("clogging",), healthy=False)
    assert judge(line_of(place, "sklvalve")) == "right"


@pytest.mark.slow
def test_every_diagnosis_comes_to_an_end(lines):
    assert [line["failed"] for line in lines if "failed" in line] == []
    assert len(of_kind(lines, "healthy")) == HEALTHY


@pytest.mark.slow
def test_healthy_valves_raise_hardly_an_alarm(lines):
    assert alarms(of_kind(lines, "healthy")).count <= 1


@pytest.mark.slow
def test_most_effects_are_named_and_few_by_another_name(lines):
    single = of_kind(lines, "single")
    words = Counter(judge(line) for line in single)
    assert words["right"] >= 0.5 * len(single), words
    assert wrong_name(lines).count <= 0.15 * len(lines), words
