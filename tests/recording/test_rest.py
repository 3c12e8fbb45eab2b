# SPDX-License-Identifier: BSD-3-Clause
"""A rest under a constant command is no frozen sensor; a value held while the drive moves is one."""

import numpy as np
import pytest

from sklvalve.recording import Recording, screen_recording

N = 1200


def _steps(rows=120):
    """Command that rests for two minutes at a time."""
    levels = np.random.default_rng(4).uniform(0.2, 0.8, N // rows)
    return np.repeat(levels, rows)


def _motor(command, speed=0.01):
    """Position of a clean encoder: it moves at one speed, and holds one value exactly at rest."""
    at, out = command[0], np.empty(N)
    for k, target in enumerate(command):
        at += np.clip(target - at, -speed, speed)
        out[k] = at
    return np.round(out, 5)


def _frozen(command, opening):
    frame = {"time": np.arange(float(N)), "command": command, "opening": opening}
    found = screen_recording(Recording.from_frame(frame))
    return [each["rows"] for each in found if each["finding"] == "frozen" and each["role"] == "opening"]


@pytest.mark.parametrize("speed", [0.005, 0.02])
def test_a_motor_at_rest_is_not_frozen(speed):
    command = _steps()
    assert _frozen(command, _motor(command, speed)) == []


def test_a_motor_that_rests_once_between_ramps_is_not_frozen():
    command = 0.5 + 0.3 * np.sin(np.arange(N) / 40.0)
    command[500:600] = command[499]
    assert _frozen(command, _motor(command, 0.02)) == []


def test_an_encoder_that_stands_still_while_its_command_moves_is_frozen():
    command = 0.5 + 0.3 * np.sin(np.arange(N) / 40.0)
    opening = _motor(command, 0.02)
    opening[500:600] = opening[499]
    assert _frozen(command, opening) == [[[500 - 1, 600]]]


def test_a_sensor_that_jitters_in_every_other_rest_is_frozen():
    command = _steps()
    opening = _motor(command, 0.02) + 0.001 * np.random.default_rng(1).standard_normal(N)
    opening[650:710] = opening[649]
    assert _frozen(command, opening) == [[[649, 710]]]


def test_a_flow_at_rest_behind_a_resting_stem_is_not_frozen():
    command = _steps()
    opening = _motor(command, 0.02)
    frame = {"time": np.arange(float(N)), "command": command, "opening": opening, "flow": 10.0 * opening**2}
    assert [e for e in screen_recording(Recording.from_frame(frame)) if e["finding"] == "frozen"] == []
