# SPDX-License-Identifier: BSD-3-Clause
"""The valve in its plant: installed characteristic, its inverse and the authority."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import brentq

from sklvalve.mechanism import (
    CHARACTERISTICS,
    ValidityWarning,
    installed_characteristic,
    liquid_flow,
    opening_for_installed,
    relative_capacity,
    valve_authority,
)

TABLE = [[0.0, 0.0], [0.2, 0.03], [0.5, 0.12], [0.8, 0.55], [1.0, 1.0]]


@pytest.mark.parametrize("opening", [0.1, 0.4, 0.9])
def test_it_is_the_flow_through_valve_and_plant_in_series(opening):
    # 200 kPa over both; the plant takes 140 kPa at the largest flow, so the authority is 0.3
    kv, total = 40.0, 2e5
    largest = liquid_flow(kv, 0.3 * total, 0.0, 998.0)

    def too_much(flow, phi):
        behind_plant = total * (1.0 - 0.7 * (flow / largest) ** 2)
        return flow - liquid_flow(kv * phi, behind_plant, 0.0, 998.0)

    phi = relative_capacity(opening, "equal_percentage", rangeability=30.0)
    flow = brentq(too_much, 0.0, 1.19 * largest, args=(phi,), xtol=1e-15, rtol=1e-14)
    authority = valve_authority(0.3 * total, total)
    installed = installed_characteristic(opening, "equal_percentage", authority=authority, rangeability=30.0)
    assert_allclose(installed, flow / largest, rtol=1e-11)


@pytest.mark.parametrize("kind", [*CHARACTERISTICS, TABLE])
def test_whole_authority_leaves_the_inherent_characteristic(kind):
    opening = np.linspace(0.0, 1.0, 21)
    installed = installed_characteristic(opening, kind, authority=1.0, rangeability=50.0, shutoff=0.1)
    inherent = relative_capacity(opening, kind, rangeability=50.0, shutoff=0.1)
    assert_allclose(installed, inherent, rtol=1e-14)


@pytest.mark.parametrize("kind", [*CHARACTERISTICS, TABLE])
def test_round_trip_of_100_000(kind):
    rng = np.random.default_rng(21)
    opening, authority = rng.random(100_000), rng.uniform(0.01, 1.0, 100_000)
    given_so = {"authority": authority, "rangeability": 50.0, "shutoff": 0.02, "leakage": 1e-4}
    again = opening_for_installed(installed_characteristic(opening, kind, **given_so), kind, **given_so)
    assert_allclose(again, opening, rtol=0.0, atol=1e-9)


@given(st.sampled_from(CHARACTERISTICS), st.floats(1e-3, 1.0), st.floats(1e-3, 1.0))
@settings(max_examples=50, deadline=None)
def test_less_authority_lifts_the_curve(kind, one, other):
    opening = np.linspace(0.0, 1.0, 41)
    small, large = sorted((one, other))
    lifted = installed_characteristic(opening, kind, authority=small, rangeability=50.0)
    plain = installed_characteristic(opening, kind, authority=large, rangeability=50.0)
    assert np.all(np.diff(lifted) > -1e-15)
    assert np.all(lifted >= plain - 1e-15)
    assert_allclose([lifted[-1], plain[-1]], 1.0, rtol=1e-15)
    assert_allclose(
        opening_for_installed(lifted[-1], kind, authority=small, rangeability=50.0), 1.0, rtol=1e-14
    )
    assert_allclose(opening_for_installed(1.0, kind, authority=small, rangeability=50.0), 1.0, rtol=1e-14)


def test_authority_that_is_none():
    assert_array_equal(
        valve_authority([0.0, -1.0, 2.0, 1.0, np.nan], 1.0), [np.nan, np.nan, np.nan, 1.0, np.nan]
    )
    for function in (installed_characteristic, opening_for_installed):
        with pytest.warns(ValidityWarning, match=r"2 of 4 rows have an authority outside \(0, 1\]"):
            values = function(0.5, "linear", authority=[0.0, 1.5, 0.5, np.nan])
        assert_array_equal(np.isnan(values), [True, True, False, True])


def test_flow_that_no_opening_gives():
    with pytest.warns(ValidityWarning, match="1 of 3 rows ask for more than a valve without drop"):
        opening = opening_for_installed([0.5, 1.2, np.nan], "linear", authority=0.2)
    assert_array_equal(np.isnan(opening), [False, True, True])
    with pytest.warns(ValidityWarning, match=r"2 of 3 rows have a relative capacity outside \[0, 1\]"):
        opening = opening_for_installed([-0.1, 0.5, 1.01], "linear", authority=0.2)
    assert_array_equal(np.isnan(opening), [True, False, True])


def test_scalars_stay_scalars():
    assert np.ndim(installed_characteristic(0.5, "linear", authority=0.5)) == 0
    assert np.ndim(opening_for_installed(0.5, "linear", authority=0.5)) == 0
    assert np.ndim(valve_authority(1.0, 2.0)) == 0
