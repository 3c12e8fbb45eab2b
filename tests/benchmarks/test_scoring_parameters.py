# SPDX-License-Identifier: BSD-3-Clause
"""Main parameters against the concealed sizes."""

import pytest

from benchmarks.concealed.plant import EFFECTS
from benchmarks.concealed.scoring.parameters import (
    accuracy,
    accuracy_by_effect,
    accuracy_by_size,
    intervals,
)
from benchmarks.concealed.scoring.rates import Rate


@pytest.fixture
def found(a_line):
    """Maker of a line whose first class has a parameter."""

    def make(classes, value, ends, true=2.0, unit="1", name="a", **truth):
        given = {"size": {"value": value, "unit": "1", "ci95": ends}}
        told = {name: {"parameter": "size", "value": true, "unit": unit}}
        return a_line(name, "named", classes, told=[{"parameters": given}], parameters=told, **truth)

    return make


def test_an_interval_is_looked_at_where_it_is_of_the_same_quantity(found):
    assert list(intervals(found("a/b", 2.2, [1.9, 2.5]))) == [("a", True, pytest.approx(0.1))]
    assert list(intervals(found("a", 2.2, [2.1, 2.5]))) == [("a", False, pytest.approx(0.1))]
    assert list(intervals(found("a", 2.2, None))) == [("a", None, pytest.approx(0.1))]
    assert list(intervals(found("a", 2.2, [None, None]))) == [("a", None, pytest.approx(0.1))]
    assert list(intervals(found("b/a", 2.2, [1.9, 2.5]))) == []  # the parameters are of the first name
    assert list(intervals(found("a", 2.2, [1.9, 2.5], unit="s"))) == []
    assert list(intervals(found("a", 2.2, [1.9, 2.5], true=0.0))) == []
    assert list(intervals(found("a", None, None))) == []


def test_a_line_without_parameters_has_none(a_line, a_failure):
    told = {"a": {"parameter": "size", "value": 2.0, "unit": "1"}}
    lines = [a_line("a", "named", "a", parameters=told), a_failure("a", parameters=told), a_line("a")]
    lines.append(a_line("a", "named", "a", parameters=None))
    assert [list(intervals(line)) for line in lines] == [[], [], [], []]
    assert accuracy(lines).of == 0
    assert str(accuracy(lines).median) == str(accuracy([]).coverage) == "-"


def test_play_on_either_side_of_the_position_sensor(a_line):
    told = {"backlash": {"parameter": "width", "value": 0.03, "unit": "1"}}

    def line(concealed, *more):
        given = {"width": {"value": 0.033, "unit": "1", "ci95": [0.028, 0.038]}} | {m: {} for m in more}
        entry = [{"parameters": given}]
        truth = {"concealed": [concealed], "parameters": told}
        return a_line("backlash", "named", "backlash/friction", told=entry, **truth)

    assert list(intervals(line("backlash", "overshoot"))) == [("backlash", True, pytest.approx(0.1))]
    assert list(intervals(line("backlash"))) == []
    for linked in ("linkage_backlash", "link_backlash"):
        assert [inside for _, inside, _ in intervals(line(linked))] == [True]
        assert list(intervals(line(linked, "overshoot"))) == []
    assert EFFECTS["link_backlash"].told == EFFECTS["plug_backlash"].told == "backlash"


def test_accuracy_by_size_and_effect(found):
    lines = [found("a", 2.0 + 0.2 * i, [1.9, 2.3], size_step=3.0) for i in range(4)]
    lines.append(found("b", 1.0, None, name="b", size_step=1.0, concealed=["own name"]))
    assert accuracy(lines).of == 5
    large = accuracy(lines, 3.0)
    assert large.median.value == pytest.approx(0.15)  # of 0, 10, 20, 30 %
    assert large.ninth.value == pytest.approx(0.27)
    assert large.coverage == Rate(4, 4)  # each holds the true size, 2
    assert [(step, a.of) for step, a in accuracy_by_size(lines)] == [(1.0, 1), (3.0, 4)]
    effects = accuracy_by_effect(lines)
    assert [(name, a.coverage) for name, a in effects] == [("a", Rate(4, 4)), ("own name", Rate(0, 0))]
