# SPDX-License-Identifier: BSD-3-Clause
"""Where a valve has been, and where it has not."""

import numpy as np
import pytest

from sklvalve.history.operating_range import COUNTED, OperatingRange, Visited, limits_in_recorded_units
from sklvalve.recording import Recording, Valve


def recording(opening, flow=None, **more):
    n = len(opening)
    flow = np.asarray(opening) * 1e-2 if flow is None else flow
    return Recording.from_frame({"time": np.arange(float(n)), "opening": opening, "flow": flow} | more)


LOW, HIGH = np.linspace(0.1, 0.3, 200), np.linspace(0.6, 0.8, 200)


def test_what_was_visited_is_inside_and_what_was_not_is_outside():
    been = OperatingRange.of(recording(LOW))
    assert been.outside(recording(LOW)) == {"opening": 0.0, "flow": 0.0}
    assert been.outside(recording(HIGH)) == {"opening": 1.0, "flow": 1.0}
    half = been.outside(recording(np.concatenate([LOW, HIGH])))
    assert half["opening"] == pytest.approx(0.5)


def test_a_hole_between_two_ranges_is_outside():
    been = OperatingRange.of([recording(LOW), recording(HIGH)])
    between = np.linspace(0.4, 0.5, 100)
    assert been.outside(recording(between))["opening"] == 1.0
    assert been.outside(recording(LOW))["opening"] == been.outside(recording(HIGH))["opening"] == 0.0


def test_the_drop_is_counted_where_both_pressures_are_known():
    more = {"p1": np.full(200, 5e5), "p2": np.linspace(2e5, 4e5, 200)}
    been = OperatingRange.of(recording(LOW, **more))
    low, high = been.limits()["drop"]
    assert 0.9e5 < low < 1.1e5
    assert 2.9e5 < high < 3.1e5
    assert "drop" not in OperatingRange.of(recording(LOW)).visited
    assert set(been.visited) <= set(COUNTED)


def test_merged_in_any_order_and_grouping():
    parts = [OperatingRange.of(recording(p, flow=f * p)) for p, f in ((LOW, 1e-3), (HIGH, 1.0), (LOW, 30.0))]
    one = parts[0].merged(parts[1]).merged(parts[2])
    other = parts[2].merged(parts[1].merged(parts[0]))
    for name in one.visited:
        np.testing.assert_array_equal(one.visited[name].bins, other.visited[name].bins)
        np.testing.assert_array_equal(one.visited[name].rows, other.visited[name].rows)
        assert one.visited[name].rows.sum() == 600


def test_gaps_and_spikes_visit_nothing():
    opening = LOW.copy()
    opening[:20], opening[20] = np.nan, 0.9
    been = OperatingRange.of(recording(opening))
    assert been.visited["opening"].rows.sum() == 180
    assert been.outside(recording(np.full(50, 0.9)))["opening"] == 1.0
    gap = recording(np.append(np.full(50, np.nan), 0.2), flow=np.ones(51)).slice(0, 50)
    assert set(been.outside(gap)) == {"flow"}


def test_bins_of_negative_numbers_are_joined_as_those_of_others():
    fine = Visited.of(np.array([-3.0, -1.0, 0.0, 1.0, 3.0]), 1.0)
    coarse = fine.coarser(2.0)
    np.testing.assert_array_equal(coarse.bins, [-2, -1, 0, 1])
    np.testing.assert_array_equal(coarse.rows, [1, 1, 2, 1])
    assert fine.coarser(0.5) is fine


def test_a_signal_that_is_nothing_has_a_range():
    been = OperatingRange.of(recording(LOW, flow=np.zeros(200)))
    assert been.limits()["flow"] == (0.0, 1.0)
    assert OperatingRange().outside(recording(LOW)) == {}


def test_limits_are_in_recorded_units_and_turned_round_by_a_sense_of_closing():
    roles = {"opening": {"column": "X", "unit": "%"}, "p1": {"column": "P1", "unit": "bar"}}
    roles["p2"] = {"column": "P2", "unit": "bar"}
    columns = {"time": np.arange(200.0), "X": 100.0 * LOW, "P1": np.full(200, 6.0), "P2": np.full(200, 4.0)}
    made = Recording.from_frame(columns, Valve.from_dict({"recording": roles}))
    limits = limits_in_recorded_units(OperatingRange.of(made), made)
    assert limits["opening"]["unit"] == "%"
    assert limits["opening"]["low"] == pytest.approx(10.0, abs=2.0)
    assert limits["opening"]["high"] == pytest.approx(30.0, abs=2.0)
    assert limits["drop"]["unit"] == "bar"
    assert limits["drop"]["low"] <= 2.0 <= limits["drop"]["high"]
