# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of a history are known again by their rows, however they were cut, written or named."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.history.sources import shared, sources_of
from sklvalve.recording import join_recordings
from tests.history.plant import changed, dated, named


def source(recording):
    (one,) = sources_of(recording)
    return one


def test_each_of_a_joined_recording_has_its_own(before, after):
    one, two = replace(named(before, "a"), sha256="a" * 64), named(after, "b")
    first, second = sources_of(join_recordings([one, two]))
    assert (first.name, first.sha256, first.rows) == ("a.csv", "a" * 64, 1200)
    assert (second.name, second.first, second.last) == ("b.csv", 1200.0, 2399.0)
    assert first.marks.tolist() == source(one).marks.tolist()
    assert second.marks.tolist() == source(two).marks.tolist()


def test_about_one_row_in_32_is_a_mark(before):
    assert 15 < len(source(before).marks) < 80


@pytest.mark.parametrize("part", [slice(0, 1200), slice(600, 1200), slice(300, 700)])
def test_the_same_rows_are_known_again(before, part):
    assert source(before).is_same(source(before.slice(part.start, part.stop)))


def test_a_conversion_of_units_leaves_no_trace(before):
    rounded = changed(before, p1=(before["p1"] / 6894.757) * 6894.757)
    assert source(before).is_same(source(rounded))


def test_other_rows_are_others(before, after):
    assert not source(before).is_same(source(after))
    assert not source(before).is_same(source(dated(before, "2026-01-01")))
    assert shared([source(before)], [source(after)]) is None
    one, two = (replace(part, sha256="a" * 64) for part in (before.slice(0, 600), before.slice(600, 1200)))
    assert not source(one).is_same(source(two))


def test_a_file_is_the_same_as_itself_though_it_has_no_marks(before):
    one = replace(before.slice(0, 2), sha256="a" * 64)
    assert source(one).is_same(source(one))


def test_gaps_are_equal_to_gaps(before):
    gap = changed(before, flow=np.where(np.arange(1200) < 1100, np.nan, before["flow"]))
    assert source(gap).is_same(source(gap.slice(0, 1000)))
    assert not source(gap).is_same(source(before.slice(0, 1000)))


def test_times_are_compared_where_both_are_dates_of_one_kind(before, after):
    early, late = source(dated(before, "2026-01-01")), source(dated(after, "2026-02-01"))
    assert late.follows(early)
    assert not early.follows(late)
    assert not early.comparable(source(after))
    aware = source(dated(after, "2026-02-01", "+00:00"))
    assert not aware.comparable(early)
    assert aware.comparable(source(dated(before, "2026-01-01", "+05:00")))
