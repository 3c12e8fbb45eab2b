# SPDX-License-Identifier: BSD-3-Clause
"""A curved valve and a gain that drifts are given their part, and a band and a reversed gain are not."""

import numpy as np
import pytest

from sklvalve.mismatch.loop.fit import Regression, refine
from sklvalve.mismatch.loop.operators import stick_slip
from sklvalve.mismatch.loop.process import responses
from sklvalve.mismatch.loop.signals import loop_signals
from sklvalve.mismatch.loop.varying_gain import likelihood_with_varying_gain
from sklvalve.recording import Recording

ROWS = 800


def wander():
    rng = np.random.default_rng(3)
    swings = np.sin(np.arange(ROWS) / 17.0) + 0.7 * np.sin(np.arange(ROWS) / 41.0)
    return 0.5 + 0.05 * swings + 0.001 * rng.standard_normal(ROWS)


def likelihoods(value, stem, forecast=None):
    """Log likelihood of a stem without and with a gain that may change, for a value [1] that it moves."""
    command = wander()
    noisy = value + 0.001 * np.random.default_rng(4).standard_normal(ROWS)
    loop = loop_signals(Recording.from_frame({"time": np.arange(ROWS), "command": command, "flow": noisy}))
    assert loop.decimation == 1
    forecast = stem if forecast is None else forecast
    regression = Regression(responses(stem, forecast, False)[None], loop.value, loop.used, 1)
    fit = refine(regression, 0, (0.9, 0.0))
    return fit.log_likelihood, likelihood_with_varying_gain(fit, stem, forecast, False)


def after(stem):
    return np.concatenate([stem[:1], stem[:-1]])


def test_a_curve_and_a_drift_of_the_gain_are_given_their_part():
    command = wander()
    moved = command - command.mean()
    for value in (3.0 * moved**2, 0.5 * moved * np.linspace(-1.0, 1.0, ROWS)):
        plain, varying = likelihoods(1.0 + after(moved + value), command)
        assert varying > plain + 20.0


def test_a_linear_process_gains_nothing():
    command = wander()
    plain, varying = likelihoods(1.0 + after(command), command)
    assert plain <= varying < plain + 5.0


def test_a_band_is_not_taken_for_a_varying_gain():
    command = wander()
    sticking = stick_slip(command, 0.06, 0.0)
    value = 1.0 + after(sticking)
    of_command, of_stem = likelihoods(value, command)[1], likelihoods(value, sticking)[1]
    assert of_stem > of_command + 100.0


def test_a_reversed_gain_is_not_allowed():
    command = wander()
    falling = 1.0 - after(command)
    plain, varying = likelihoods(falling, command)
    assert varying == pytest.approx(plain)


def test_a_varying_gain_reads_no_answer_of_the_same_row():
    command = wander()
    # what a controller of high gain makes of the value in the same row, which no forecast holds
    answers = 0.02 * np.random.default_rng(6).standard_normal(ROWS)
    gain = np.linspace(0.0, 2.0, ROWS)
    value = 1.0 + after(command) + gain * answers
    fooled = np.subtract(*likelihoods(value, command + answers)[::-1])
    forecast = np.subtract(*likelihoods(value, command + answers, command)[::-1])
    assert fooled > 100.0
    assert forecast < 10.0
