# SPDX-License-Identifier: BSD-3-Clause
"""Processes, noise and the fit of one stem."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from benchmarks.loop_plant import draw_loop
from sklvalve.mismatch.loop.fit import mixture_of
from sklvalve.mismatch.loop.noise import autoregression, rhythm, whiten
from sklvalve.mismatch.loop.process import foreseen_command, lagged, responses, sense_of_process


def test_lagged_rows_start_with_the_first_value():
    assert_allclose(lagged(np.array([3.0, 4.0, 5.0]), 2), [[3, 3], [3, 3], [4, 3]])


@pytest.mark.parametrize("integrates", [False, True])
def test_no_response_turns_back(integrates):
    step = np.concatenate([np.zeros(200), np.ones(200)])
    columns = responses(step, step, integrates)
    after = columns[:, 200:] - (columns[:, 199:200] if not integrates else 0.0)
    if not integrates:
        assert (np.diff(after, axis=1) >= -1e-12).all()
        assert_allclose(after[:, -1], 1.0, atol=1e-4)
    else:
        # the same step later differs by a response that is never negative
        later = responses(np.roll(step, 5), np.roll(step, 5), integrates)
        ramp = np.polyfit(np.arange(50), (columns - later)[:, 300:350].T, 1)[0]
        assert (ramp >= -1e-3).all()


@pytest.mark.parametrize("kind", ["flow", "pressure", "level"])
def test_a_controller_that_raises_the_command_needs_a_positive_process(kind):
    drawn = draw_loop(5, kind, "setpoint")
    assert sense_of_process(drawn.command, drawn.process_value, drawn.setpoint) == 1
    assert sense_of_process(-drawn.command, drawn.process_value, drawn.setpoint) == -1


def test_the_future_of_the_command_is_not_used():
    drawn = draw_loop(3, "flow", "quiet")
    changed = drawn.command.copy()
    changed[-1] += 1.0
    before = foreseen_command(drawn.command, drawn.process_value)
    # one outlier moves the coefficients, but the row itself is not copied
    assert abs(foreseen_command(changed, drawn.process_value)[-1] - before[-1]) < 0.2


def test_weights_of_a_known_process_come_back():
    rng = np.random.default_rng(0)
    stem = np.cumsum(rng.standard_normal(1500)) * 0.01
    columns = responses(stem, stem, False)
    truth = np.array([0.5, 0.0, 0.0, 2.0, 0.0, 0.0])
    wander = 0.002 * np.cumsum(rng.standard_normal(1500))
    found, _ = mixture_of(columns, 3.0 + truth @ columns + wander, np.ones(1500, bool), 1, (1.0, 0.0))
    assert found.sum() == pytest.approx(2.5, rel=0.05)
    assert (found >= 0.0).all()


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
    assert len(autoregression(noise)) <= 2
    out = np.zeros(3000)
    for k in range(2, 3000):
        out[k] = 1.6 * out[k - 1] - 0.9 * out[k - 2] + noise[k]
    assert_allclose(autoregression(out)[:2], [1.6, -0.9], atol=0.08)


def test_an_oscillation_lies_in_its_waves():
    time = np.arange(700)
    wave = np.sign(np.sin(2 * np.pi * time / 50.0))
    waves = rhythm(wave + 0.001 * time)
    left = wave - waves.T @ np.linalg.lstsq(waves.T, wave, rcond=None)[0]
    assert left.var() < 0.15 * wave.var()
