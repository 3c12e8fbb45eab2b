# SPDX-License-Identifier: BSD-3-Clause
"""A controller that answers the value is seen, and a programme that does not is not."""

import numpy as np
import pytest
from scipy.signal import lfilter

from sklvalve.mismatch.loop.process import forecast_command
from sklvalve.mismatch.proof.feedback import ANSWERS_FROM, answers, driver_of
from sklvalve.mismatch.proof.one_sign import one_sign_predictions
from sklvalve.recording.gaps import filled

ROWS = 1500


def _wander(rng, size):
    return lfilter([1.0], [1.0, -0.98], size * rng.standard_normal(ROWS))


def _loop(rng, gain=0.4, reset=0.05):
    """PI control of a value that follows the command and wanders: command, value, wander."""
    wander, noise = _wander(rng, 0.05), 0.01 * rng.standard_normal(ROWS)
    command, value, stem, integral = np.zeros(ROWS), np.zeros(ROWS), 0.0, 0.0
    for k in range(ROWS):
        stem += 0.5 * ((command[k - 1] if k else 0.0) - stem)
        value[k] = stem + wander[k] + noise[k]
        integral -= reset * value[k]
        command[k] = integral - gain * value[k]
    return command, value, wander


@pytest.mark.parametrize("seed", range(4))
def test_a_controller_is_seen_and_a_programme_is_not(seed):
    rng = np.random.default_rng(seed)
    command, value, _ = _loop(rng)
    assert answers(command, value, command) >= ANSWERS_FROM
    steps = np.repeat(rng.uniform(0.0, 1.0, ROWS // 50), 50)
    # a valve that is slower than its simulation, or answers in the same row, is no controller
    for programme in (steps, lfilter([0.1], [1.0, -0.9], steps)):
        for keep in (0.0, 0.8):
            value = lfilter([1.0 - keep], [1.0, -keep], programme) + _wander(rng, 0.02)
            assert answers(programme, value, programme) < ANSWERS_FROM


def test_a_driver_at_rest_is_not_answered():
    rng = np.random.default_rng(0)
    assert answers(np.full(ROWS, 0.5), rng.standard_normal(ROWS), np.zeros(ROWS)) == 0.0
    assert answers(np.arange(50.0), rng.standard_normal(50), np.zeros(50)) == 0.0


def test_gaps_are_bridged():
    assert filled(np.array([1.0, np.nan, 3.0])).tolist() == [1.0, 2.0, 3.0]
    assert filled(np.array([np.nan, np.nan])).tolist() == [0.0, 0.0]


def test_the_opening_drives_a_flow_where_it_is_recorded():
    assert driver_of({"command": 0, "opening": 0}, "flow") == "opening"
    assert driver_of({"command": 0, "opening": 0}, "opening") == "command"
    assert driver_of({"command": 0}, "flow") == "command"


def test_in_a_closed_loop_the_black_box_does_not_read_the_controller():
    """With a constant set-point a constant forecasts better than any sound simulation."""
    train, ratios = np.arange(ROWS) < 900, []
    for seed in range(6):
        command, value, wander = _loop(np.random.default_rng(seed))
        forecast = forecast_command(command, value)
        predicted = one_sign_predictions(command, value, [900], forecast=forecast)[0]
        box, sound, constant = (
            float(np.std((value - made)[~train])) for made in (predicted, value - wander, np.zeros(ROWS))
        )
        assert constant < 0.7 * sound  # the trap is there
        ratios.append(sound / box)
    assert np.median(ratios) < 1.1  # and not walked into
    assert max(ratios) < 1.5


def test_responses_of_one_sign_learn_play_and_lag_without_feedback():
    rng = np.random.default_rng(5)
    command = np.repeat(rng.uniform(0.2, 0.8, ROWS // 30), 30)
    stem, value = command[0], np.empty(ROWS)
    for k in range(ROWS):
        stem = min(max(stem, command[k] - 0.05), command[k] + 0.05)
        value[k] = stem
    value = lfilter([0.3], [1.0, -0.7], value - value[0]) + value[0] + 0.002 * rng.standard_normal(ROWS)
    train = np.arange(ROWS) < 900
    error = np.std((value - one_sign_predictions(command, value, [900])[0])[~train])
    assert error < 0.35 * np.std((value - command)[~train])


def test_each_origin_learns_from_the_rows_before_it_alone():
    command, value, _ = _loop(np.random.default_rng(1))
    origins = [480, 660, 900]
    together = one_sign_predictions(command, value, origins)
    for origin, made in zip(origins, together, strict=True):
        changed = np.where(np.arange(ROWS) < origin, value, 7.0)
        [alone] = one_sign_predictions(command, changed, [origin])
        np.testing.assert_allclose(made, alone, rtol=1e-9, atol=1e-12)
