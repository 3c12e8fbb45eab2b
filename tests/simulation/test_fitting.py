# SPDX-License-Identifier: BSD-3-Clause
"""Fits end inside the bounds of the numbers that they move."""

import numpy as np
import pytest

from sklvalve.simulation import fitting
from sklvalve.simulation.parameters import Parameter


@pytest.mark.parametrize(("beyond", "end"), [(-6.6e-24, 0.0), (1.0 + 2e-16, 1.0)])
def test_a_fit_that_ends_at_a_bound_does_not_lie_beyond_it_by_rounding(monkeypatch, beyond, end):
    def ends_beyond(stacked, slopes, z, vector, max_steps, loss):
        return np.array([beyond]), 1.0, np.eye(1), True

    monkeypatch.setattr(fitting, "_minimise", ends_beyond)
    monkeypatch.setattr(fitting, "simulate_channels", lambda chain, values, channels: {})
    fit = fitting.fit_chain(None, [Parameter("share", "1", 0.0, 1.0, 0.5)], ("flow",), {})
    assert fit.values["share"] == end
