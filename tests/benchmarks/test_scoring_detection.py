# SPDX-License-Identifier: BSD-3-Clause
"""Alarms on healthy records, uniformity of p-values, power against size."""

import numpy as np
import pytest

from benchmarks.concealed.scoring.detection import (
    alarms,
    detected,
    p_values,
    power,
    power_by_times,
    rejected,
    uniformity,
)
from benchmarks.concealed.scoring.rates import Rate


def test_alarms_are_counted_on_healthy_records_alone(a_line, a_failure):
    lines = [a_line(), a_line(), a_line("", "cannot_tell"), a_line("", "named", "a")]
    lines += [a_failure(), a_line("a", "named", "a"), a_line("", "named", "a", verdict="none_of_these")]
    assert alarms(lines) == Rate(2, 4)  # one that broke is neither
    assert alarms([a_failure()]) == alarms([]) == Rate(0, 0)


def test_rejections_by_the_p_value_told(a_line, a_failure):
    lines = [a_line(p=0.01), a_line(p=0.011), a_line("", "cannot_tell"), a_failure(), a_line("a", p=0.0)]
    assert rejected(lines) == Rate(1, 2)
    assert list(p_values(lines)) == [0.01, 0.011]


def test_uniform_p_values_pass_and_others_do_not(a_line):
    uniform = [a_line(p=(i + 0.5) / 200) for i in range(200)]
    told = uniformity(uniform)
    assert (told.of, told.distance) == (200, pytest.approx(0.0025))
    assert told.p_value > 0.99
    cautious = uniformity([a_line(p=1.0) for _ in range(50)])
    assert cautious.distance == 1.0
    assert cautious.p_value < 1e-6
    assert cautious.excess_p_value > 0.99  # too large raises no alarm
    eager = uniformity([a_line(p=((i + 0.5) / 200) ** 2) for i in range(200)])
    # the excess of p^(1/2) over p is a quarter, at p = 1/4
    assert eager.excess == pytest.approx(0.25, abs=0.01)
    assert eager.excess_p_value < 1e-6


def test_without_p_values_nothing_is_told(a_line):
    assert str(uniformity([a_line(), a_line("a", p=0.5)])) == "-"


def test_power_by_planned_size(a_line, a_failure):
    lines = [a_line("a", "named", "a", size_step=1.0), a_line("a", size_step=1.0)]
    lines += [a_line("a", "cannot_tell", size_step=3.0), a_failure("a", size_step=3.0)]
    lines += [a_line("a+b", "named", "a", "b", size_step=3.0), a_line("a", "named", "a")]
    rows = power(lines)
    assert [(row.label, row.detected, row.right) for row in rows] == [
        ("1", Rate(1, 2), Rate(1, 2)),
        ("3", Rate(1, 2), Rate(0, 2)),
    ]
    assert power([]) == []


def test_power_by_size_as_drawn(a_line):
    lines = [a_line("a", "named", "a", times=t) for t in (0.9, 1.0, 1.2, 1.25, 9.0)] + [a_line("a")]
    rows = power_by_times(lines, edges=(0.75, 1.25, 1.75, np.inf))
    assert [(row.label, row.size, row.detected.of) for row in rows] == [
        ("0.75-1.25", 1.0, 3),
        ("1.25-1.75", 1.25, 1),
        ("from 1.75", 9.0, 1),
    ]


def test_what_broke_was_not_detected(a_line, a_failure):
    assert detected([a_line("a", "cannot_tell"), a_failure("a"), a_line("a"), a_line()]) == Rate(1, 3)


def test_detection_of_one_planned_size_asks_single_effects(a_line):
    lines = [a_line("a", "named", "a", size_step=2.0), a_line("a", size_step=2.0)]
    lines += [a_line("a+b", "named", "a", size_step=2.0), a_line("a", "named", "a", size_step=1.0)]
    assert detected(lines, 2.0) == Rate(1, 2)
    assert detected(lines) == Rate(3, 4)
