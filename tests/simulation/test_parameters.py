# SPDX-License-Identifier: BSD-3-Clause
"""Parameters come back from the optimiser's vector as they went in, and inside their bounds."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.simulation.parameters import JointPrior, Parameter, ParameterVector

PARAMETERS = (
    Parameter("lag", "s", 0.02, 3.0, 0.5, spread=1.5, log=True),
    Parameter("zero", "1", -0.01, 0.01, 0.0, spread=0.005),
    Parameter("gain", "1", 0.0, 4.0, 1.0),
    Parameter("shift", "Pa", -np.inf, np.inf, 3.0),
)


@settings(max_examples=50, deadline=None)
@given(st.floats(0.02, 3.0), st.floats(-0.01, 0.01), st.floats(0.0, 4.0))
def test_values_inside_the_bounds_come_back(lag, zero, gain):
    vector = ParameterVector(PARAMETERS)
    back = vector.values(vector.pack({"lag": lag, "zero": zero, "gain": gain}))
    assert back["lag"] == pytest.approx(lag, rel=1e-12)
    assert back["zero"] == zero
    assert back["gain"] == gain
    assert back["shift"] == 3.0


@settings(max_examples=50, deadline=None)
@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_values_outside_are_put_on_the_bound(lag, zero):
    vector = ParameterVector(PARAMETERS)
    back = vector.values(vector.pack({"lag": lag, "zero": zero}))
    assert back["lag"] == pytest.approx(np.clip(lag, 0.02, 3.0), rel=1e-12)
    assert back["zero"] == np.clip(zero, -0.01, 0.01)


def test_a_value_that_is_not_given_stands_at_its_start():
    vector = ParameterVector(PARAMETERS)
    assert vector.values(vector.pack({})) == pytest.approx(
        {"lag": 0.5, "zero": 0.0, "gain": 1.0, "shift": 3.0}
    )


def test_bounds_and_scales():
    vector = ParameterVector(PARAMETERS)
    assert len(vector) == 4
    np.testing.assert_allclose(vector.low[:3], [np.log(0.02), -0.01, 0.0])
    np.testing.assert_allclose(vector.high[:3], [np.log(3.0), 0.01, 4.0])
    # one for a logarithm, the prior's spread, a quarter of the range, the size of the start
    np.testing.assert_allclose(vector.scale, [1.0, 0.005, 1.0, 3.0])


def test_priors_count_in_their_own_spread_and_only_where_there_is_one():
    vector = ParameterVector(PARAMETERS)
    z = vector.pack({"lag": 0.5 * np.exp(1.5), "zero": -0.01, "gain": 4.0})
    np.testing.assert_allclose(vector.prior_residuals(z), [1.0, -2.0], rtol=1e-12)
    np.testing.assert_allclose(vector.prior_residuals(vector.pack({})), 0.0, atol=1e-15)


def test_no_parameters_at_all():
    vector = ParameterVector(())
    assert len(vector) == 0
    assert vector.values(vector.pack({"lag": 1.0})) == {}


def test_scattered_vectors_fill_what_the_parameters_may_be():
    bounded = PARAMETERS[:3]
    vector = ParameterVector(bounded)
    made = vector.scattered(400, np.random.default_rng(0), 2.0)
    assert made.shape == (400, 3)
    # two spreads about the start, inside the bounds, and the whole range where nothing is expected
    lag = np.log(0.5)
    np.testing.assert_allclose(made.min(axis=0), [lag - 3.0, -0.01, 0.0], atol=0.05)
    np.testing.assert_allclose(made.max(axis=0), [np.log(3.0), 0.01, 4.0], atol=0.05)


def test_what_is_expected_together_is_drawn_from_that():
    covariance = np.array([[0.04, 0.0018], [0.0018, 1e-4]])
    joint = JointPrior(("lag", "zero"), np.array([np.log(0.3), 0.002]), covariance)
    known = [replace(p, joint=joint) for p in PARAMETERS[:2]]
    vector = ParameterVector((PARAMETERS[2], *known))
    made = vector.scattered(4000, np.random.default_rng(0), 2.0)
    np.testing.assert_allclose(np.mean(made[:, 1:], axis=0), joint.mean, atol=0.01)
    np.testing.assert_allclose(np.std(made[:, 1]), 0.2, rtol=0.05)
    assert np.corrcoef(made[:, 1:].T)[0, 1] == pytest.approx(0.9, abs=0.05)
    # and no further than is physically possible
    assert made[:, 2].min() >= -0.01
    assert made[:, 2].max() == 0.01
