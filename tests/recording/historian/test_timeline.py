# SPDX-License-Identifier: BSD-3-Clause
"""Times of a base written out: in parts the same as together."""

import numpy as np
import pytest

from sklvalve.recording.historian import timeline


@pytest.mark.parametrize(("step", "digits"), [(1_000_000, 0), (1_500, 6), (2_000, 3)])
def test_parts_of_a_base_are_written_alike(monkeypatch, step, digits):
    ticks = 1_719_560_000_000_000 + step * np.arange(10, dtype=np.int64)
    together = timeline._iso(ticks)
    monkeypatch.setattr(timeline, "_PART", 3)
    in_parts = timeline._iso(ticks)
    assert in_parts.tolist() == together.tolist()
    assert {len(text.partition(".")[2]) for text in in_parts} == {digits}
    assert [np.datetime64(text, "us").astype(np.int64) for text in in_parts] == ticks.tolist()
