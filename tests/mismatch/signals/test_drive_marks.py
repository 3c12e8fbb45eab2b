# SPDX-License-Identifier: BSD-3-Clause
"""What a drive shows of itself, and that a motor's start and run are no slips."""

import numpy as np
import pytest

from sklvalve.mismatch.signals.drive_marks import rows_between_readings, rows_late, way_in_a_row
from sklvalve.mismatch.signals.stick_slip import find_slips

N = 3000


def _steps(seed=0, hold=60):
    return np.repeat(np.random.default_rng(seed).uniform(0.2, 0.8, N // hold), hold)


def _motor(command, late, way, band=0.0):
    """Position of a motor that starts some rows late and runs at one speed, from row to row."""
    wanted = np.concatenate([np.full(late, command[0]), command])[: len(command)]
    at, on, out = wanted[0], False, np.empty(len(command))
    for k, target in enumerate(wanted):
        left = target - at
        on = on or abs(left) > band
        if on:
            at += np.clip(left, -way, way)
            on = abs(target - at) > 1e-12
        out[k] = at
    return out


def _sticking(command, band=0.02, carry=0.012):
    """Stem that rests until the error exceeds a band, and then lands beyond its command."""
    at, out = command[0], np.empty(len(command))
    for k, target in enumerate(command):
        if abs(target - at) > band:
            at = target + carry * np.sign(target - at)
        out[k] = at
    return out


@pytest.mark.parametrize("late", [3, 20, 45])
def test_a_dead_time_is_seen_where_all_steps_wait_as_long(late):
    command = _steps()
    found = rows_late(command, _motor(command, late, 0.05), 0.0)
    assert late <= found <= 1.3 * late + 4


def test_the_delay_of_a_stem_that_follows_a_moving_command():
    command = 0.5 + 0.2 * np.sin(np.arange(N) / 60.0)
    assert rows_late(command, _motor(command, 50, 0.05), 0.0) == pytest.approx(50, abs=6)


def test_a_stem_that_sticks_waits_for_no_constant_time():
    slow = 0.5 + 0.1 * np.sin(np.arange(N) / 40.0)
    assert rows_late(slow, _sticking(slow), 0.0) <= 12


def test_one_speed_is_seen_of_a_motor_and_not_of_a_lag():
    command = _steps()
    assert way_in_a_row(_motor(command, 0, 0.02), 0.0) == pytest.approx(0.02)
    lagged, at = np.empty(N), command[0]
    for k, target in enumerate(command):
        at += 0.1 * (target - at)
        lagged[k] = at
    assert way_in_a_row(lagged, 0.0) == 0.0


def test_readings_held_for_some_rows():
    moving = np.cumsum(np.full(N, 1e-4))
    assert rows_between_readings(np.repeat(moving[::5], 5)) == 5
    assert rows_between_readings(moving) == 1
    # slips come when the error is large enough, and not at every so manieth row
    assert rows_between_readings(_sticking(0.5 + 0.1 * np.sin(np.arange(N) / 37.0))) == 1


@pytest.mark.parametrize("late", [40, 80])
@pytest.mark.parametrize("way", [0.012, 0.05])
def test_a_late_motor_does_not_slip(late, way):
    rng = np.random.default_rng(2)
    small = 0.5 + np.cumsum(rng.choice([-0.04, 0.04, 0.02, -0.02], N // 100))
    command = np.repeat(np.clip(small, 0.1, 0.9), 100)
    assert not find_slips(command, _motor(command, late, way)).evident


def test_readings_now_and_then_of_a_motor_are_no_slips():
    command = _steps(hold=100)
    seen = np.repeat(_motor(command, 8, 0.01)[::5], 5)
    assert not find_slips(command, seen).evident


def test_a_sticking_stem_still_slips():
    for command in (0.5 + 0.06 * np.sin(np.arange(N) / 40.0), 0.5 + 0.06 * np.sin(np.arange(N) / 20.0)):
        assert find_slips(command, _sticking(command)).evident
