# SPDX-License-Identifier: BSD-3-Clause
"""A fit within bounds does not hang on the units of its parameters."""

import numpy as np
import pytest

from sklvalve.simulation.robust import least_within


@pytest.mark.parametrize("unit", [1.0, 1e5, 1e-6])
def test_a_parameter_in_any_unit_is_found(unit):
    rng = np.random.default_rng(2)
    slopes = 1e3 * rng.standard_normal((400, 3))
    column = rng.standard_normal((400, 1))
    errors = -(slopes @ [0.01, -0.02, 0.03]) - 0.7 * column[:, 0] + 0.01 * rng.standard_normal(400)
    far = np.array([1.0, 1.0, 1.0, 10.0 * unit])
    _, at = least_within(np.vstack([slopes.T, column.T / unit]), errors, -far, far)
    np.testing.assert_allclose(at[:3], [0.01, -0.02, 0.03], atol=1e-5)
    assert at[3] == pytest.approx(0.7 * unit, rel=0.01)
