# SPDX-License-Identifier: BSD-3-Clause
"""Blocks, rows, onsets and intervals."""

import numpy as np
import pytest

from benchmarks.concealed.scoring import place
from benchmarks.concealed.scoring.rates import Rate


def test_blocks(a_line, a_failure):
    def line(true, *told):
        return a_line("a", "named", "a", blocks=true, location={"blocks": list(told)})

    lines = [line(["valve"], "valve"), line(["valve"], "measurement", "valve"), line(["line"], "valve")]
    lines += [line(["valve", "line"], "valve"), a_failure("a", blocks=["valve"])]
    lines += [a_line("a", blocks=["valve"]), a_line("a", "named", "a", location={"blocks": ["valve"]})]
    assert place.blocks_hold(lines) == Rate(2, 4)  # missed, broken and unknown ones are not asked
    assert place.blocks_exact(lines) == Rate(1, 4)
    assert place.blocks_told(lines).value == pytest.approx((1 + 2 + 1 + 1) / 4)
    assert str(place.blocks_told([])) == str(place.blocks_hold([])) == "-"


def test_rows_within_spans():
    assert place.mask([[1, 3], [4, 9]], 6).tolist() == [False, True, True, False, True, True]
    assert not place.mask([], 3).any()


def test_overlap_of_rows():
    """Rows 0-9 told, 5-14 true: 5 in common, 15 in all."""
    f1, iou = place.overlap(place.mask([[0, 10]], 20), place.mask([[5, 15]], 20))
    assert (f1, iou) == pytest.approx((2 * 5 / 20, 5 / 15))
    assert place.overlap(place.mask([[0, 10]], 20), place.mask([], 20)) is None
    assert place.overlap(place.mask([], 20), place.mask([[5, 15]], 20)) == (0.0, 0.0)


def test_regions(a_line):
    def line(verdict="named", **rows):
        return a_line("a", verdict) | {"rows": rows}

    half = line(told=[[0, 10]], boxes=None, true=[[5, 15]], of=20)
    whole = line(told=[[0, 5], [5, 10]], boxes=[[0, 20]], true=[[0, 10]], of=20)
    unasked = [line("no_mismatch", told=[], true=[[0, 5]], of=9), line(told=None, true=[[0, 5]], of=9)]
    unasked += [line(told=[[0, 5]], true=[], of=9), a_line("a", "named", "a")]
    region = place.region([half, whole, *unasked])
    assert region.f1.value == pytest.approx((0.5 + 1.0) / 2)
    assert region.iou.value == pytest.approx((1 / 3 + 1.0) / 2)
    assert region.everywhere.value == pytest.approx(2 * 10 / 30)
    boxes = place.region([half, whole], "boxes")
    assert (boxes.f1.of, boxes.f1.value) == (1, pytest.approx(2 * 10 / 30))
    assert str(place.region([]).f1) == "-"


def abrupt(a_line, true, told, **more):
    truth = {"abrupt": True, "onset": true, "rows": 1000} | more
    return a_line("a", "named", "a", location={"onset": told}, **truth)


def test_onsets(a_line):
    lines = [abrupt(a_line, 500.0, 510.0, size_step=3.0), abrupt(a_line, 500.0, 489.0, size_step=3.0)]
    lines += [abrupt(a_line, 500.0, None, size_step=1.0), abrupt(a_line, 0.0, 3.0)]
    lines += [abrupt(a_line, 500.0, 500.0, abrupt=False), a_line("a", abrupt=True, onset=5.0, rows=9)]
    assert place.onset_near(lines) == Rate(1, 3)
    assert place.onset_near(lines, 3.0) == Rate(1, 2)
    assert place.onset_near(lines, 2.0) == Rate(0, 0)
    assert place.onset_told(lines) == Rate(2, 3)
    assert place.onset_median(lines).value == pytest.approx(0.011)
    assert place.onset_median(lines[1:3]).value == pytest.approx((0.011 + 1.0) / 2)
    assert place.onset_invented(lines) == Rate(1, 1)
    assert str(place.onset_median([])) == "-"


def test_the_length_of_a_record(a_line):
    assert place.duration(a_line("a", duration=50.0, rows=7)) == 50.0
    assert place.duration(a_line("a", rows=7, sample_time=10.0)) == 70.0
    assert place.duration(a_line("a") | {"rows": {"of": 9}}) == 9.0
    assert place.duration(a_line("a", rows=7, intervals=[[0.0, 3.0], [5.0, 60.0]])) == 60.0
    assert place.duration(a_line("a")) is None
    assert place.onset_error(abrupt(a_line, 5.0, 6.0, rows=None)) is None


def test_intervals_of_onsets(a_line):
    def line(ends, onset=5.0):
        return a_line("a", "named", "a", onset=onset, location={"onset": 5.0, "onset_ci95": ends})

    lines = [line([4.0, 5.0]), line([5.1, 6.0]), line(None), line([0.0, 1.0], 0.0), line([0.0, 1.0], None)]
    assert place.onset_coverage(lines) == Rate(1, 2)


def test_time_told_against_time_true(a_line):
    def line(told, true):
        return a_line("a", "named", "a", intervals=true, location={"intervals": told})

    assert place.interval_overlap([line([[0.0, 10.0]], [[5.0, 20.0]])]).value == pytest.approx(5 / 20)
    twice = line([[0.0, 4.0], [6.0, 8.0]], [[2.0, 7.0]])
    assert place.interval_overlap([twice]).value == pytest.approx((2 + 1) / 8)
    assert place.interval_overlap([line([], [[0.0, 1.0]])]).value == 0.0
    assert place.interval_overlap([line(None, [[0.0, 1.0]]), line([[0.0, 1.0]], [])]).of == 0
    assert np.isnan(place.interval_overlap([line([[1.0, 1.0]], [[1.0, 1.0]])]).value)
