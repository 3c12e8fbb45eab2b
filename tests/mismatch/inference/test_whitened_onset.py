# SPDX-License-Identifier: BSD-3-Clause
"""Sums over a change that begins at any row, held against that change whitened with each onset."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.mismatch.inference.whitened_onset import WhitenedOnset, losses_from_here
from sklvalve.simulation.fitting import PlainNoise
from sklvalve.simulation.noise import NoiseModel
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

N = 120


def noise_of(rng, many, gap):
    white = rng.uniform(0.1, 1.0, many)
    white[gap] = np.inf
    times, sizes = rng.uniform([1.0, 20.0], [10.0, 500.0]), rng.uniform(0.0, 3.0, 2)
    return NoiseModel(white, rng.uniform(0.5, 2.0, many), times[0], sizes[0], times[1], sizes[1], sensor=0.1)


def noises(rng, joined):
    if not joined:
        return noise_of(rng, N, slice(30, 37))
    models = [noise_of(rng, 50, slice(0, 3)), noise_of(rng, N - 50, slice(60, 70))]
    return NoiseOfPieces([(0, 50), (50, N)], models)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_sums_are_those_of_the_change_whitened_from_each_row_on(seed, joined):
    rng = np.random.default_rng(seed)
    noise = noises(rng, joined)
    weights, change, columns = rng.uniform(0.1, 1.0, N), rng.normal(1.0, 1.0, N), rng.normal(size=(2, N))
    onset, white = WhitenedOnset(noise, weights), noise.whiten(change)
    states = onset.states(white)
    squares = onset.squares(white, states)
    products = onset.products(white, states, columns, onset.answers(columns))
    for k in range(N):
        begun = noise.whiten(np.where(np.arange(N) >= k, change, 0.0))
        assert squares[k] == pytest.approx(np.sum(weights * begun**2), rel=1e-9, abs=1e-9)
        assert products[:, k] == pytest.approx(columns @ (weights * begun), rel=1e-9, abs=1e-9)


def test_noise_that_remembers_nothing_cuts_the_change_off():
    change, weights = np.arange(1.0, N + 1.0), np.full(N, 0.5)
    onset = WhitenedOnset(PlainNoise(2.0), weights)
    white = PlainNoise(2.0).whiten(change)
    squares = onset.squares(white, onset.states(white))
    assert squares[70] == pytest.approx(0.5 * np.sum((change[70:] / 2.0) ** 2))


def test_a_step_tells_of_itself_by_its_first_rows_in_noise_that_wanders():
    # a level has no more to tell once the filter takes it for wander; a step has all of it at its onset
    noise = NoiseModel(np.full(N, 0.01), np.ones(N), 1.0, 1e-9, 1000.0, 1.0, sensor=0.01)
    onset, white = WhitenedOnset(noise, np.ones(N)), noise.whiten(np.ones(N))
    cut_off = np.sum(white[70:] ** 2)
    assert onset.squares(white, onset.states(white))[70] > 20.0 * cut_off


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_losses_are_those_of_a_residual_that_changes_at_each_row(seed, joined):
    rng = np.random.default_rng(seed)
    noise = noises(rng, joined)
    without, acting = rng.normal(size=N), rng.normal(2.0, 1.0, N)
    losses = losses_from_here(noise, noise.whiten(without), noise.whiten(acting))
    for k in range(N):
        white = noise.whiten(np.where(np.arange(N) >= k, acting, without))[k:]
        assert losses[k] == pytest.approx(np.sum(9.0 * (np.sqrt(1.0 + (white / 3.0) ** 2) - 1.0)), abs=0.02)
