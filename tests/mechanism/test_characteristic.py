# SPDX-License-Identifier: BSD-3-Clause
"""Trim characteristics and their inverses."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import CHARACTERISTICS, ValidityWarning, opening_for_capacity, relative_capacity

TABLE = [[0.0, 0.0], [0.2, 0.03], [0.5, 0.12], [0.8, 0.55], [1.0, 0.95]]
RANGED = st.sampled_from(CHARACTERISTICS)


@pytest.mark.parametrize(
    ("kind", "rangeability", "opening", "phi"),
    [
        ("equal_percentage", 50.0, 0.5, 50.0**-0.5),
        ("equal_percentage", 50.0, 0.75, 50.0**-0.25),
        ("linear", 50.0, 0.5, 0.51),
        ("linear", None, 0.3, 0.3),
        ("quick_opening", None, 0.25, 0.5),
        ("quick_opening", 2.0, 0.0, 0.5),
        ("parabolic", None, 0.5, 0.25),
        ("parabolic", 4.0, 0.5, 1.5**2 / 4.0),
        ("hyperbolic", 50.0, 0.5, 1.0 / 25.5),
    ],
)
def test_values(kind, rangeability, opening, phi):
    assert_allclose(relative_capacity(opening, kind, rangeability=rangeability), phi, rtol=1e-14)


@given(
    RANGED, st.floats(1.5, 200.0), st.floats(0.0, 0.3), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20)
)
@settings(max_examples=50, deadline=None)
def test_round_trip(kind, rangeability, shutoff, openings):
    given_so = {"rangeability": rangeability, "shutoff": shutoff}
    phi = relative_capacity(openings, kind, **given_so)
    assert_allclose(opening_for_capacity(phi, kind, **given_so), openings, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("leakage", [0.0, 1e-4])
@pytest.mark.parametrize("shutoff", [0.0, 0.02])
@pytest.mark.parametrize("kind", [*CHARACTERISTICS, "table"])
@pytest.mark.parametrize("rangeability", [2.0, 50.0, None])
def test_round_trip_of_100_000(kind, rangeability, shutoff, leakage):
    if rangeability is None and kind in ("equal_percentage", "hyperbolic"):
        rangeability = 1000.0
    given_so = {"rangeability": rangeability, "shutoff": shutoff, "leakage": leakage}
    opening = np.random.default_rng(20).random(100_000)
    phi = relative_capacity(opening, TABLE if kind == "table" else kind, **given_so)
    again = opening_for_capacity(phi, TABLE if kind == "table" else kind, **given_so)
    assert_allclose(again, opening, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_round_trip_through_rising_tables(seed):
    rng = np.random.default_rng(seed)
    n_points = rng.integers(2, 15)
    points = np.linspace(0.0, 1.0, n_points)
    points[1:-1] += rng.uniform(-0.4, 0.4, n_points - 2) / n_points
    phi = np.cumsum(rng.uniform(0.01, 1.0, n_points))
    table = np.column_stack([points, phi / phi[-1]])
    # the curve may level off at its end, where the last digits of a capacity are many openings
    opening = rng.uniform(0.0, 0.999, 10_000)
    again = opening_for_capacity(relative_capacity(opening, table), table)
    assert_allclose(again, opening, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("kind", [*CHARACTERISTICS, TABLE])
def test_leakage_lifts_the_shut_valve_and_leaves_the_open_one(kind):
    given_so = {"rangeability": 30.0, "shutoff": 0.05, "leakage": 5e-3}
    tight = relative_capacity([0.0, 0.4, 1.0], kind, rangeability=30.0, shutoff=0.05)
    leaking = relative_capacity([0.0, 0.4, 1.0], kind, **given_so)
    assert_allclose(leaking[[0, 2]], [5e-3, tight[2]], rtol=1e-14)
    assert tight[1] < leaking[1] < tight[1] + 5e-3
    with pytest.warns(ValidityWarning, match=r"1 of 2 rows .* outside \[0.005, "):
        opening = opening_for_capacity([4e-3, 5e-3], kind, **given_so)
    assert_array_equal(opening, [np.nan, 0.0])


@given(st.sampled_from(["linear", "quick_opening", "parabolic"]), st.floats(0.0, 1.0))
@settings(max_examples=50, deadline=None)
def test_round_trip_from_zero(kind, opening):
    phi = relative_capacity(opening, kind)
    assert_allclose(relative_capacity(opening_for_capacity(phi, kind), kind), phi, rtol=1e-9, atol=1e-300)


@given(st.floats(0.0, 0.3), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
@settings(max_examples=50, deadline=None)
def test_round_trip_through_a_table(shutoff, openings):
    phi = relative_capacity(openings, TABLE, shutoff=shutoff)
    again = opening_for_capacity(phi, TABLE, shutoff=shutoff)
    assert_allclose(relative_capacity(again, TABLE, shutoff=shutoff), phi, rtol=0.0, atol=1e-12)
    assert_allclose(again, openings, rtol=0.0, atol=1e-9)


steps = st.lists(st.floats(0.01, 1.0), min_size=1, max_size=8)


@given(steps, st.data())
@settings(max_examples=50, deadline=None)
def test_any_monotone_table_is_monotone_and_inverts(widths, data):
    rises = data.draw(
        st.lists(st.sampled_from([0.0, 0.01, 0.3, 1.0]), min_size=len(widths), max_size=len(widths))
    )
    if sum(rises) == 0.0:
        rises[-1] = 1.0
    opening = np.concatenate([[0.0], np.cumsum(widths) / sum(widths)])
    opening[-1] = 1.0
    table = np.column_stack([opening, np.concatenate([[0.0], np.cumsum(rises) / sum(rises)])])
    phi = relative_capacity(np.linspace(0.0, 1.0, 201), table)
    assert np.all(np.diff(phi) >= -1e-12)
    assert_allclose(relative_capacity(opening_for_capacity(phi, table, warn=False), table), phi, atol=1e-9)


@pytest.mark.parametrize("kind", CHARACTERISTICS)
def test_shutoff_is_continuous_and_closes(kind):
    below, at, above = relative_capacity(
        [0.05 - 1e-9, 0.05, 0.05 + 1e-9], kind, rangeability=30.0, shutoff=0.05
    )
    assert relative_capacity(0.0, kind, rangeability=30.0, shutoff=0.05) == 0.0
    assert_allclose([below, above], at, rtol=1e-6)
    assert_allclose(relative_capacity(0.02, kind, rangeability=30.0, shutoff=0.05), 0.4 * at, rtol=1e-12)


def test_table_passes_its_points():
    opening, phi = np.transpose(TABLE)
    assert_allclose(relative_capacity(opening, TABLE), phi, rtol=1e-14)
    assert_allclose(opening_for_capacity(phi, TABLE), opening, rtol=1e-14)


def test_flat_table_gives_the_smallest_opening():
    table = [[0.0, 0.0], [0.4, 0.5], [0.6, 0.5], [1.0, 1.0]]
    assert_allclose(opening_for_capacity(0.5, table), 0.4, rtol=1e-12)


@pytest.mark.parametrize("shutoff", [0.1, 0.3])
def test_flat_start_above_a_shutoff_is_reached_at_the_shutoff(shutoff):
    table = [[0.0, 0.1], [0.3, 0.1], [0.6, 0.5], [1.0, 0.5]]
    opening = opening_for_capacity([0.0, 0.05, 0.1, 0.5], table, shutoff=shutoff)
    assert_allclose(opening, [0.0, 0.5 * shutoff, shutoff, 0.6], rtol=1e-12)
    assert_allclose(relative_capacity(opening, table, shutoff=shutoff), [0.0, 0.05, 0.1, 0.5], rtol=1e-12)


@pytest.mark.parametrize("shutoff", [0.0, 0.1])
def test_no_capacity_at_a_flat_start_is_the_shut_valve(shutoff):
    table = [[0.0, 0.0], [0.3, 0.0], [1.0, 1.0]]
    assert opening_for_capacity(0.0, table, shutoff=shutoff) == 0.0


def test_outside_travel_is_the_end_and_said():
    with pytest.warns(ValidityWarning, match="2 of 4 rows"):
        phi = relative_capacity([-0.1, 0.5, 1.1, np.nan], "equal_percentage", rangeability=50.0)
    assert_allclose(phi, [0.02, 50.0**-0.5, 1.0, np.nan], rtol=1e-14)


def test_capacity_that_no_opening_gives():
    with pytest.warns(ValidityWarning, match=r"2 of 4 rows .* outside \[0.02, 1\]"):
        opening = opening_for_capacity([0.01, 0.02, 1.01, np.nan], "equal_percentage", rangeability=50.0)
    assert_array_equal(np.isnan(opening), [True, False, True, True])


def test_warn_false_is_quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        relative_capacity(1.1, "linear", warn=False)
        opening_for_capacity(1.1, "linear", warn=False)


def test_scalars_stay_scalars():
    assert np.ndim(relative_capacity(0.5, TABLE)) == 0
    assert np.ndim(opening_for_capacity(0.5, TABLE)) == 0
    assert np.ndim(opening_for_capacity(0.5, "linear", shutoff=0.1)) == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ({"characteristic": "equal_percent"}, "unknown characteristic 'equal_percent': use one of linear"),
        ({"characteristic": "equal_percentage"}, "needs a rangeability"),
        ({"characteristic": "linear", "rangeability": 1.0}, "rangeability must be above 1; got 1.0"),
        ({"characteristic": "linear", "shutoff": 1.0}, r"shutoff must be an opening in \[0, 1\); got 1.0"),
        ({"characteristic": "linear", "leakage": -0.1}, r"leakage must be a part of .* got -0.1"),
        (
            {"characteristic": [[0.0, 0.0], [1.0, 0.5]], "leakage": 0.6},
            "below the table's last capacity, 0.5",
        ),
        ({"characteristic": [0.0, 1.0]}, "two or more pairs"),
        ({"characteristic": [[0.0, 0.0], [0.9, 1.0]]}, "must rise from 0 to 1"),
        ({"characteristic": [[0.0, 0.0], [0.5, 0.6], [1.0, 0.5]]}, "never fall"),
    ],
)
@pytest.mark.parametrize("function", [relative_capacity, opening_for_capacity])
def test_bad_input(function, call, message):
    with pytest.raises(ValueError, match=message):
        function(0.5, **call)
