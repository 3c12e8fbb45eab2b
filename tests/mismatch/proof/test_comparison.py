# SPDX-License-Identifier: BSD-3-Clause
"""What a correction adds to the error of rows ahead, in standard errors of itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.proof.comparison import Compared, rise

ROWS, AHEAD = 1_600, 640
HELD = np.arange(ROWS) >= ROWS - AHEAD
PROBLEM = SimpleNamespace(
    plain=SimpleNamespace(clock=np.arange(float(ROWS))), recording=SimpleNamespace(sample_time=1.0)
)


def compared(added, before=1.0):
    """Errors of one channel of which the correction adds so much in each row."""
    losses = {"nominal": before, "corrected": before + float(added[HELD].sum()), "black_box": before}
    return Compared("flow", AHEAD, losses, losses, 0, True, False, added, 4)


def noisy(mean, deviation=1e-4, seed=1):
    return mean + deviation * np.random.default_rng(seed).standard_normal(ROWS)


def test_it_is_the_rise_over_what_stretches_scatter_by():
    added = noisy(2e-5)
    stretches = np.array([part.sum() for part in np.array_split(added[HELD], 16)])
    expected = stretches.sum() / (np.sqrt(16) * stretches.std(ddof=1))
    assert rise(PROBLEM, [compared(added)], HELD) == pytest.approx(expected)
    assert expected > 1.0


def test_every_channel_counts_and_only_rows_ahead():
    nothing, worse = np.zeros(ROWS), noisy(2e-5)
    alone = rise(PROBLEM, [compared(worse)], HELD)
    assert rise(PROBLEM, [compared(nothing, 0.0), compared(worse)], HELD) == pytest.approx(alone)
    before = np.where(HELD, worse, 1.0)
    assert rise(PROBLEM, [compared(before)], HELD) == pytest.approx(alone)


def test_an_error_that_one_stretch_more_than_doubles_is_no_chance():
    added = noisy(-1e-6, 1e-7)
    added[-20:] = 0.5
    assert rise(PROBLEM, [compared(added)], HELD) == pytest.approx(10.0, rel=0.01)


def test_a_rise_that_is_the_same_everywhere_is_certain():
    assert rise(PROBLEM, [compared(np.full(ROWS, 1e-3))], HELD) > 1e6
    assert rise(PROBLEM, [compared(np.full(ROWS, 1e-3), 0.0)], HELD) == np.inf
    assert rise(PROBLEM, [compared(np.zeros(ROWS))], HELD) == 0.0
    assert rise(PROBLEM, [], HELD) == 0.0
