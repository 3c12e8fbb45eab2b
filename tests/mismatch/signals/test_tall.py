# SPDX-License-Identifier: BSD-3-Clause
"""Tall least squares block by block are those of the whole."""

import numpy as np
import pytest

from sklvalve.mismatch.signals.tall import row_blocks, triangle


def test_blocks_hold_every_row_once():
    rows = np.arange(20_000)
    assert np.array_equal(np.concatenate([rows[block] for block in row_blocks(3, 20_000)]), rows[3:])
    assert row_blocks(5, 5) == []


@pytest.mark.parametrize("rows", [2, 7, 8_192, 20_001])
def test_a_triangle_solves_as_the_whole_does(rows):
    rng = np.random.default_rng(rows)
    table = rng.standard_normal((rows, 5)) * [1.0, 1e6, 1e-6, 3.0, 1.0]
    first = triangle(table[block] for block in row_blocks(0, rows // 2)) if rows > 2 else None
    made = triangle((table[block] for block in row_blocks(rows // 2 if rows > 2 else 0, rows)), first)
    assert len(made) == min(rows, 5)
    scale = np.linalg.norm(table, axis=0)
    np.testing.assert_allclose(
        made.T @ made / np.outer(scale, scale), table.T @ table / np.outer(scale, scale), atol=1e-12
    )


def test_without_rows_there_is_no_triangle():
    with pytest.raises(ValueError, match="expected a block of rows"):
        triangle([])
