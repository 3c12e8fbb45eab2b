# SPDX-License-Identifier: BSD-3-Clause
"""The branch-free elementary functions against those of numpy, in their whole range."""

import numpy as np
import pytest

from sklvalve.mechanism import _vector_math

EPS = np.finfo(float).eps
RNG = np.random.default_rng(0)
EXPONENTS = np.concatenate(
    [RNG.uniform(-690.0, 690.0, 500), RNG.uniform(-1.0, 1.0, 500), [0.0, -0.5, 1e-300]]
)
WIDE = np.concatenate([np.exp(EXPONENTS), np.nextafter(1.0, [0.0, 2.0]), [1.0, 2.0, 0.5, 1e-300, 1e300]])


@pytest.mark.parametrize(
    ("ours", "reference", "values"),
    [
        (_vector_math.exp, np.exp, EXPONENTS),
        (_vector_math.log, np.log, WIDE),
        (_vector_math.one_over_cube_root, lambda x: 1.0 / np.cbrt(x), WIDE),
    ],
)
def test_right_to_the_last_places_and_nan_for_nan(ours, reference, values):
    found = np.array([ours(float(value)) for value in values])
    np.testing.assert_allclose(found, reference(values), rtol=4 * EPS, atol=0.0)
    assert np.isnan(ours(np.nan))
