# SPDX-License-Identifier: BSD-3-Clause
"""Valve factors over travel."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import at_travel

TABLE = [[0.1, 0.96], [0.4, 0.92], [1.0, 0.8]]


def test_number_is_itself():
    assert at_travel(0.9) == 0.9
    assert at_travel(0.9, [0.1, 0.2]) == 0.9


def test_table_passes_its_points_and_holds_its_ends():
    assert_allclose(at_travel(TABLE, [0.0, 0.1, 0.4, 1.0, 1.2]), [0.96, 0.96, 0.92, 0.8, 0.8], rtol=1e-14)
    between = at_travel(TABLE, np.linspace(0.1, 1.0, 50))
    assert np.all(np.diff(between) < 0.0)


def test_gap_is_a_gap():
    assert np.isnan(at_travel(TABLE, np.nan))


@pytest.mark.parametrize(
    ("table", "opening", "message"),
    [
        ([0.9, 0.8], 0.5, "two or more pairs"),
        ([[0.5, 0.9], [0.2, 0.8]], 0.5, "must rise"),
        (TABLE, None, "the opening is needed"),
    ],
)
def test_bad_input(table, opening, message):
    with pytest.raises(ValueError, match=message):
        at_travel(table, opening)
