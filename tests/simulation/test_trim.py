# SPDX-License-Identifier: BSD-3-Clause
"""Capacity over opening: the sheet within its tolerance, or a monotone curve learnt from data."""

import numpy as np
import pytest

from sklvalve.recording import Valve
from sklvalve.simulation import Tolerance
from sklvalve.simulation.trim import GRID, LearntTrim, SheetTrim


def _valve(**more):
    sheet = {"kv_rated": 40.0, "characteristic": "equal_percentage", "rangeability": 40.0, "shutoff": 0.02}
    return Valve.from_dict({"valve": sheet | more})


def _starts(trim):
    return {p.name: p.start for p in trim.all_parameters()}


def test_sheet_at_its_starts_is_the_equal_percentage_curve():
    trim = SheetTrim(_valve(), Tolerance())
    table = trim.table(_starts(trim))
    inside = GRID > 0.02
    np.testing.assert_allclose(table[inside], 40.0 * 40.0 ** (GRID[inside] - 1.0), rtol=1e-9)
    assert table[0] == 0.0


@pytest.mark.parametrize("end", ["low", "high"])
def test_sheet_bends_no_further_than_its_tolerance_at_the_knots(end):
    tolerance = Tolerance()
    trim = SheetTrim(_valve(), tolerance)
    knots = np.array([0.02, 0.15, 0.29, 0.43, 0.57, 0.71, 0.86, 1.0])
    bent = _starts(trim) | {p.name: getattr(p, end) for p in trim.parameters}
    ratio = np.interp(knots, GRID, trim.table(bent)) / np.interp(knots, GRID, trim.table(_starts(trim)))
    phi = 40.0 ** (knots - 1.0)
    np.testing.assert_array_less(np.abs(np.log(ratio)), tolerance.trim * phi**-0.2 + 2e-3)
    # and it does use it, but fully open: what deviates there is the rated capacity
    assert abs(np.log(ratio[-2])) == pytest.approx(tolerance.trim * phi[-2] ** -0.2, rel=0.02)
    assert ratio[-1] == pytest.approx(1.0, rel=1e-12)


def test_capacity_of_a_sheet_stays_within_its_tolerance():
    trim = SheetTrim(_valve(), Tolerance(capacity=0.05))
    assert (trim.capacity.low, trim.capacity.high) == pytest.approx((38.0, 42.0))
    assert trim.known


def test_without_a_rated_capacity_any_is_possible():
    trim = SheetTrim(Valve.from_dict({"valve": {"characteristic": "linear"}}), Tolerance())
    assert trim.capacity.high > 1e5
    assert trim.rated is None


def test_learnt_trim_is_monotone_whatever_its_rises():
    rng = np.random.default_rng(0)
    trim = LearntTrim(rng.uniform(0.1, 0.9, 500), 30.0)
    for _ in range(20):
        rises = {p.name: rng.uniform(p.low, p.high) for p in trim.parameters}
        assert np.all(np.diff(trim.table(rises)) >= 0.0)
    assert not trim.known


def test_learnt_trim_is_linear_in_its_rises():
    rng = np.random.default_rng(1)
    trim = LearntTrim(rng.uniform(0.0, 1.0, 500), 30.0)
    one, two = ({p.name: rng.uniform(0.0, 5.0) for p in trim.parameters} for _ in range(2))
    both = {name: 2.0 * one[name] + 3.0 * two[name] for name in one}
    np.testing.assert_allclose(trim.table(both), 2.0 * trim.table(one) + 3.0 * trim.table(two), rtol=1e-12)


def test_first_values_come_near_the_capacities_seen():
    rng = np.random.default_rng(2)
    opening = rng.uniform(0.05, 1.0, 800)
    kv = 30.0 * opening**1.5
    opening[::50], kv[::31] = np.nan, np.nan
    trim = LearntTrim(opening, 30.0)
    rises = trim.first_values(opening, kv)
    assert set(rises) == {p.name for p in trim.parameters}
    assert min(rises.values()) >= 0.0
    seen = np.isfinite(opening) & np.isfinite(kv)
    learnt = np.interp(opening[seen], GRID, trim.table(rises))
    np.testing.assert_allclose(learnt, kv[seen], atol=0.3)


def test_knots_can_be_given():
    trim = LearntTrim(None, 10.0, knots=(0.0, 0.5, 1.0))
    table = trim.table({"rise_0": 1.0, "rise_1": 2.0, "rise_2": 4.0})
    np.testing.assert_allclose(np.interp([0.0, 0.25, 0.5, 1.0], GRID, table), [1.0, 2.0, 3.0, 7.0])
