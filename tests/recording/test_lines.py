# SPDX-License-Identifier: BSD-3-Clause
"""A historian's straight lines, with the digits that a recording is written in."""

import numpy as np
import pytest

from tests.recording.test_screening import healthy, names, screened, swinging_door


@pytest.mark.parametrize("column", ["P1", "P2"])
def test_long_shallow_lines_written_to_one_decimal(column):
    columns = healthy()
    columns[column] = np.round(swinging_door(columns[column], 8.0), 1)
    found = screened(columns)
    assert names(found) == {("compressed", column.lower())}
    assert "straight lines" in found[0]["detail"]


def test_smooth_course_without_noise_is_no_compression():
    columns = healthy()
    columns["P2"] = np.round(
        300.0 + 60.0 * np.sin(columns["time"] / 97.0 + np.cos(columns["time"] / 61.0)), 1
    )
    assert ("compressed", "p2") not in names(screened(columns))
