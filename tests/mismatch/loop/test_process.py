# SPDX-License-Identifier: BSD-3-Clause
"""Processes, noise and the fit of one stem."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import nnls

from benchmarks.loop_plant import draw_loop
from sklvalve.mismatch.loop.fit import fit_weights
from sklvalve.mismatch.loop.least_squares import nonnegative_weights
from sklvalve.mismatch.loop.noise import external_oscillations, fit_autoregression, whiten
from sklvalve.mismatch.loop.operators import count_reversals
from sklvalve.mismatch.loop.process import forecast_command, lagged, responses
from sklvalve.mismatch.loop.signals import decimation_of, swing_rows


def test_lagged_rows_start_with_the_first_value():
    assert_allclose(lagged(np.array([3.0, 4.0, 5.0]), 2), [[3, 3], [3, 3], [4, 3]])


@pytest.mark.parametrize("integrates", [False, True])
def test_no_response_turns_back(integrates):
    step = np.concatenate([np.zeros(200), np.ones(200)])
    columns = responses(step, step, integrates)
    if not integrates:
        after = columns[:, 200:] - columns[:, 199:200]
        assert (np.diff(after, axis=1) >= -1e-12).all()
        assert_allclose(after[:, -1], 1.0, atol=1e-3)
    else:
        # the same step later differs by a response that is never negative
        later = responses(np.roll(step, 5), np.roll(step, 5), integrates)
        ramp = np.polyfit(np.arange(50), (columns - later)[:, 300:350].T, 1)[0]
        assert (ramp >= -1e-3).all()


def test_the_future_of_the_command_is_not_used():
    drawn = draw_loop(3, "flow", "quiet")
    changed = drawn.command.copy()
    changed[-1] += 1.0
    before = forecast_command(drawn.command, drawn.process_value)
    # one outlier moves the coefficients, but the row itself is not copied
    assert abs(forecast_command(changed, drawn.process_value)[-1] - before[-1]) < 0.2


def test_weights_of_a_known_process_come_back():
    rng = np.random.default_rng(0)
    stem = np.cumsum(rng.standard_normal(1500)) * 0.01
    columns = responses(stem, stem, False)
    truth = np.zeros(len(columns))
    truth[[0, 6]] = 0.5, 2.0
    wander = 0.002 * np.cumsum(rng.standard_normal(1500))
    weights, _ = fit_weights(columns, 3.0 + truth @ columns + wander, np.ones(1500, bool), 1, (1.0, 0.0))
    assert weights.sum() == pytest.approx(2.5, rel=0.05)
    assert (weights >= 0.0).all()


def test_a_random_walk_under_white_noise_is_whitened():
    rng = np.random.default_rng(1)
    # variance 1 of steps to 2 of noise: the innovations form follows with 0.5
    walk = np.cumsum(rng.standard_normal(20000)) + np.sqrt(2.0) * rng.standard_normal(20000)
    new = whiten(walk, 1.0, 0.5)[100:]
    for late in (1, 2, 5):
        assert abs(np.corrcoef(new[late:], new[:-late])[0, 1]) < 0.03


def test_an_autoregression_is_found_and_white_noise_has_none():
    rng = np.random.default_rng(2)
    noise = rng.standard_normal(3000)
    assert len(fit_autoregression(noise)) <= 2
    out = np.zeros(3000)
    for k in range(2, 3000):
        out[k] = 1.6 * out[k - 1] - 0.9 * out[k - 2] + noise[k]
    assert_allclose(fit_autoregression(out)[:2], [1.6, -0.9], atol=0.08)


def test_an_oscillation_lies_in_its_waves():
    time = np.arange(700)
    wave = np.sign(np.sin(2 * np.pi * time / 50.0))
    waves = external_oscillations(wave + 0.001 * time, np.ones(700, bool))[1]
    left = wave - waves.T @ np.linalg.lstsq(waves.T, wave, rcond=None)[0]
    assert left.var() < 0.15 * wave.var()


def test_white_noise_is_not_taken_for_a_fast_swing():
    rng = np.random.default_rng(0)
    slow = np.sin(2 * np.pi * np.arange(3000) / 300.0)
    assert swing_rows(slow + 0.3 * rng.standard_normal(3000)) == pytest.approx(300.0, rel=0.05)
    every, period = decimation_of(slow, slow + 0.3 * rng.standard_normal(3000))
    assert every == 5
    assert period / every >= 20.0


def test_a_fast_swing_keeps_every_row():
    fast = np.sin(2 * np.pi * np.arange(3000) / 12.0)
    assert decimation_of(fast, fast)[0] == 1


def test_a_command_turns_where_it_comes_back():
    assert count_reversals(np.linspace(0.0, 1.0, 50), 0.3) == 0
    wave = np.sin(2 * np.pi * np.arange(100) / 25.0)
    assert count_reversals(wave, 0.6) == 8
    assert count_reversals(wave, 2.5) == 0


def test_weights_of_one_sign_are_those_of_a_reference_solver():
    rng = np.random.default_rng(4)
    for _ in range(20):
        design, aim = rng.standard_normal((40, 7)), rng.standard_normal(40)
        weights, gain = nonnegative_weights(design.T @ design, design.T @ aim)
        reference, norm = nnls(design, aim)
        assert_allclose(weights, reference, atol=1e-6)
        assert gain == pytest.approx(aim @ aim - norm**2, abs=1e-6)


def test_few_rows_bear_few_coefficients_and_few_waves():
    rng = np.random.default_rng(5)
    slow = np.sin(2 * np.pi * np.arange(2000) / 50.0)
    for rows in (100, 400, 2000):
        residual = np.convolve(rng.standard_normal(rows), np.ones(60), mode="same")
        assert len(fit_autoregression(residual)) <= rows // 20
        assert all(
            len(waves) <= rows // 20 for waves in external_oscillations(slow[:rows], np.ones(rows, bool))
        )
    assert len(fit_autoregression(residual)) > 14
    assert max(len(waves) for waves in external_oscillations(slow, np.ones(2000, bool))) > 50


def test_only_recorded_rows_bear_waves():
    slow = np.sin(2 * np.pi * np.arange(2000) / 50.0)
    recorded = np.arange(2000) % 4 == 0
    assert max(len(waves) for waves in external_oscillations(slow, recorded)) <= recorded.sum() // 20
