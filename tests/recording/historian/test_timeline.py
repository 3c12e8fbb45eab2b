# SPDX-License-Identifier: BSD-3-Clause
"""Times of a base written out: in parts the same as together."""

import numpy as np
import pytest

from sklvalve.recording.historian import timeline

SECONDS = 1_000_000 * np.arange(10, dtype=np.int64)


@pytest.mark.parametrize(
    ("base", "digits"),
    # in the last, one part alone needs more digits
    [(SECONDS, 0), (SECONDS // 500, 3), (SECONDS // 400 + 1, 6), (SECONDS + 1_500 * (SECONDS > 8e6), 6)],
)
def test_parts_of_a_base_are_written_alike(monkeypatch, base, digits):
    ticks = 1_719_560_000_000_000 + base
    together = timeline._iso(ticks)
    monkeypatch.setattr(timeline, "_PART", 3)
    in_parts = timeline._iso(ticks)
    assert in_parts.tolist() == together.tolist()
    assert {len(text.partition(".")[2]) for text in in_parts} == {digits}
    assert [np.datetime64(text, "us").astype(np.int64) for text in in_parts] == ticks.tolist()
