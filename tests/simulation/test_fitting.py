# SPDX-License-Identifier: BSD-3-Clause
"""Fits end inside the bounds of the numbers that they move."""

import numpy as np
import pytest

from sklvalve.simulation import fitting
from sklvalve.simulation.parameters import Parameter, ParameterVector


@pytest.mark.parametrize(("wanted", "end"), [(-1.0, 0.0), (2.0, 1.0)])
def test_a_fit_that_ends_at_a_bound_does_not_lie_beyond_it_by_rounding(monkeypatch, wanted, end):
    vector = ParameterVector([Parameter("share", "1", 0.0, 1.0, 0.5)])
    exactly = fitting.step_inside
    monkeypatch.setattr(fitting, "step_inside", lambda *given: exactly(*given) * (1.0 + 1e-15))

    def slopes(z, left):
        return np.full((1, 1), 10.0)

    z, *_ = fitting._minimise(
        lambda z: 10.0 * (z - wanted), slopes, np.array([0.5]), vector, 20, fitting.SOFT
    )
    assert z == end
