# SPDX-License-Identifier: BSD-3-Clause
"""Cavitation index, pressure ratio, and where cavitation begins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sklvalve.mechanism import ValidityWarning, cavitation_index, incipient_xfz, pressure_ratio_xf


def test_against_fluids():
    theirs = pytest.importorskip("fluids.control_valve").cavitation_index
    rng = np.random.default_rng(0)
    p1 = rng.uniform(2e5, 1e6, 100)
    p2, p_vapour = p1 * rng.uniform(0.0, 0.99, 100), p1 * rng.uniform(0.0, 0.9, 100)
    expected = [theirs(P1=a, P2=b, Psat=c) for a, b, c in zip(p1, p2, p_vapour, strict=True)]
    assert_allclose(cavitation_index(p1, p2, p_vapour), expected, rtol=1e-12)


@given(st.floats(1e5, 1e7), st.floats(0.0, 0.99), st.floats(0.0, 0.99))
@settings(max_examples=50, deadline=None)
def test_one_is_the_inverse_of_the_other(p1, behind, vapour):
    sigma = cavitation_index(p1, behind * p1, vapour * p1)
    xf = pressure_ratio_xf(p1, behind * p1, vapour * p1)
    assert_allclose(sigma * xf, 1.0, rtol=1e-14)
    # the outlet boils from a ratio of 1 on
    assert (xf > 1.0) == (behind < vapour) or abs(xf - 1.0) < 1e-12


def test_no_drop_backward_flow_and_boiling():
    assert cavitation_index(3e5, 3e5, 1e5) == np.inf
    assert pressure_ratio_xf(3e5, 3e5, 1e5) == 0.0
    assert cavitation_index(1e5, 3e5, 2e4) == cavitation_index(3e5, 1e5, 2e4)
    with pytest.warns(ValidityWarning, match="cavitation_index: 1 of 2 rows have liquid at or below"):
        sigma = cavitation_index([3e5, 1e5], 0.5e5, 1e5)
    assert np.isnan(sigma[1])
    assert np.isnan(pressure_ratio_xf(1e5, 0.5e5, 1e5, warn=False))
    assert isinstance(cavitation_index(3e5, 1e5, 2e4), float)


def test_cavitation_begins_earlier_in_a_larger_valve_and_at_a_higher_pressure():
    kv = np.geomspace(0.1, 1000.0, 50)
    xfz = incipient_xfz(kv, 0.9, 0.46)
    assert np.all(np.diff(xfz) < 0.0)
    assert np.all((xfz > 0.0) & (xfz < 0.9))
    assert_allclose(incipient_xfz(kv, 0.9, 0.46, p1=6e5), xfz, rtol=1e-15)
    assert_allclose(incipient_xfz(kv, 0.9, 0.46, p1=12e5) / xfz, 2.0**-0.125, rtol=1e-14)
    assert incipient_xfz(0.0, 0.9, 0.46) == 0.9
    assert np.isnan(incipient_xfz(10.0, 0.9, 0.46, p1=0.0))
    assert np.isnan(incipient_xfz(np.nan, 0.9, 0.46))
