# SPDX-License-Identifier: BSD-3-Clause
"""What may change: named allowances by themselves, a response by what it moves."""

import numpy as np
import pytest

from sklvalve.history import Allowance
from sklvalve.simulation.parameters import Parameter

LAG = Parameter("meter_lag", "s", 0.02, 3.0, 0.7, spread=1.5, log=True)
FILTER = Parameter("actuator_filter", "s", 0.02, 3.0, 0.1, spread=1.5, log=True)
CAPACITY = Parameter("capacity", "m3/h", 10.0, 40.0, 20.0, spread=2.0)


def _covariance(parameters, moves, **settings):
    return Allowance(**settings).covariance(parameters, {"flow": 1.0}, np.asarray(moves, dtype=float))


def test_a_response_moves_the_signals_by_as_much_as_it_may():
    # by its logarithm a signal moves by 3 % of its span
    (variance,) = _covariance([LAG], [[0.03**2]], response=0.001).ravel()
    assert 0.03 * np.sqrt(variance) == pytest.approx(0.001, rel=0.01)


def test_what_moves_nothing_stays_as_open_as_the_sheet_leaves_it():
    found = _covariance([LAG, FILTER], [[0.03**2, 0.0], [0.0, 0.0]])
    assert found[1, 1] == pytest.approx(1.5**2)


def test_two_that_undo_each_other_may_change_together():
    # a slower filter and a quicker meter leave the signals as they are
    found = _covariance([LAG, FILTER], 0.03**2 * np.array([[1.0, 1.0], [1.0, 1.0]]))
    assert np.sqrt(found[0, 0]) > 1.0
    together, apart = np.array([1.0, 1.0]), np.array([1.0, -1.0])
    assert together @ found @ together < 0.01 * (apart @ found @ apart)


def test_a_named_allowance_is_its_own_and_no_movement_bounds_it():
    moves = np.full((2, 2), 0.5**2)
    found = _covariance([CAPACITY, LAG], moves, capacity=0.002)
    # in scaled parameters: the sheet's spread is one
    assert np.sqrt(found[0, 0]) == pytest.approx(0.002 * 20.0 / 2.0)
    assert found[0, 1] == pytest.approx(0.0, abs=1e-12)
