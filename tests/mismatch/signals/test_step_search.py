# SPDX-License-Identifier: BSD-3-Clause
"""The compiled search for a step gains what the same columns gain in plain least squares."""

import numpy as np
import pytest

from sklvalve.mismatch.signals.step_search import StepSearch
from sklvalve.simulation.noise import NoiseModel
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

ROWS = 90
GAPS = [0, 1, 17, 18, 19, 44, 45, 46, 47, 60, 88, 89]
SPANS = [(0, 30), (30, 55), (55, ROWS)]
SIGNAL = np.sin(np.arange(ROWS) / 4.0)
ROWS_TRIED = np.arange(1, ROWS - 2)


def _noise(gaps, spans):
    white = np.ones(ROWS)
    white[gaps] = np.inf
    steps = np.where(np.arange(ROWS) % 7 == 0, 2.5, 1.0)
    models = [NoiseModel(white[a:b], steps[a:b], 3.0, 0.5, 40.0, 0.3) for a, b in spans]
    return models[0] if len(models) == 1 else NoiseOfPieces(spans, models)


def _levels(spans):
    return [((np.arange(ROWS) >= a) & (np.arange(ROWS) < b)).astype(float) for a, b in spans]


def _case(*, gaps=(), spans=((0, ROWS),), unknown=(), more=(), seed=0):
    rng = np.random.default_rng(seed)
    left = rng.standard_normal(ROWS) + 0.8 * (np.arange(ROWS) >= 40)
    # far enough off that its weight falls
    left[70] += 9.0
    left[list(gaps)] = np.nan
    steady = [*_levels(spans), np.linspace(-1.0, 1.0, ROWS), np.maximum(SIGNAL, 0.0), *more]
    about = SIGNAL.copy()
    about[list(unknown)] = np.nan
    noise = _noise(list(gaps), list(spans))
    return StepSearch(noise, left, np.stack(steady, axis=1), about)


def _plain(search):
    """What a step, and one of the response too, explain of the squares; by singular values, row by row."""
    root, about = np.sqrt(search.weights), np.where(np.isfinite(search.about), search.about, 0.0)
    target = search.noise.whiten(search.left) * root

    def explained(columns):
        white = np.stack([search.noise.whiten(c) * root for c in columns], axis=1)
        white = white / np.maximum(np.linalg.norm(white, axis=0), 1e-300)
        base, size, _ = np.linalg.svd(white, full_matrices=False)
        return np.sum((base[:, size > 1e-9 * size[0]].T @ target) ** 2)

    steady, gains = list(search.steady.T), []
    without = explained(steady)
    for row in ROWS_TRIED:
        after = (np.arange(ROWS) >= row).astype(float)
        several = ([*steady, after], [*steady, after, after * about])
        gains.append([explained(columns) - without for columns in several])
    return np.array(gains)


CASES = {
    "whole": {},
    "gaps": {"gaps": GAPS},
    "joined": {"spans": SPANS},
    "joined, with gaps": {"spans": SPANS, "gaps": GAPS},
    "one of those joined holds nothing": {"spans": SPANS, "gaps": range(30, 55)},
    "signal unknown where the residual is known": {"unknown": [5, 30, 50, 51]},
    "signal unknown, joined, with gaps": {"spans": SPANS, "gaps": GAPS, "unknown": [*GAPS, 5, 30, 50, 51]},
    "columns that stand twice": {"more": [1e5 * np.ones(ROWS), 3.0 * np.maximum(SIGNAL, 0.0)]},
    "a column of nothing": {"more": [np.zeros(ROWS)]},
}


@pytest.mark.parametrize("settings", CASES.values(), ids=CASES)
def test_gains_are_those_of_plain_least_squares(settings):
    search = _case(**settings)
    assert search.weights.min() < 0.9
    gains = search.gains(ROWS_TRIED)
    np.testing.assert_allclose(gains, _plain(search), rtol=1e-9, atol=1e-9)
    assert gains.max() > 1.0


def test_a_level_that_a_join_has_gains_nothing_there_but_the_response_may():
    search = _case(spans=SPANS)
    for row in (30, 55):
        level, both = search.gains([row])[0]
        assert level == pytest.approx(0.0, abs=1e-9)
        assert both > 1e-3


def test_a_signal_unknown_at_rows_leaves_a_change_finite():
    search = _case(unknown=[5, 50], gaps=GAPS)
    made, left = search.split(40, True)
    assert np.isfinite(made).all()
    assert np.array_equal(np.isfinite(left), np.isfinite(search.left))
    assert made[50] == pytest.approx(made[40] - search.response * SIGNAL[40])
