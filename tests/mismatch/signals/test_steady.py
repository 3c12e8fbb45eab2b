# SPDX-License-Identifier: BSD-3-Clause
"""Signals made by hand, of known noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from sklvalve import Recording, Valve
from sklvalve.mismatch.signals.model_free import model_free_noise
from sklvalve.mismatch.signals.repeats import repeats_floor
from sklvalve.mismatch.signals.steady import LENGTH, Driver, drivers_of, steady_floor, steady_starts

N = 4000


def _held(rng, n=N, each=150, levels=8):
    """A command that holds one of a few levels, then goes to the next."""
    drawn = rng.choice(np.linspace(0.2, 0.9, levels), n // each + 1)
    return np.repeat(drawn, each)[:n]


def _wander(rng, n, time):
    keep = np.exp(-1.0 / time)
    return lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(n))


def _command(values):
    return Driver("command", values, 1e-3)


@pytest.fixture(scope="module")
def made():
    rng = np.random.default_rng(5)
    command = _held(rng)
    settled = lfilter([0.3], [1.0, -0.7], command - command[0]) + command[0]
    return command, settled, rng.standard_normal(N), _wander(rng, N, 400.0)


def test_rests_begin_only_after_everything_has_settled(made):
    command = made[0]
    starts = steady_starts(made[1], _command(command), every=LENGTH)
    assert len(starts) > 40
    moved = np.flatnonzero(np.diff(command)) + 1
    for k in starts:
        before = moved[moved <= k + LENGTH - 1]
        assert len(before) == 0 or before[-1] <= k - 20


@pytest.mark.parametrize("sigma", [0.002, 0.02])
def test_white_noise_is_met(made, sigma):
    command, settled, white, _ = made
    floor = steady_floor(settled + sigma * white, _command(command))
    assert floor.value == pytest.approx(sigma, rel=0.06)
    assert floor.rows > 1500
    assert floor.reason == ""


def test_slow_wander_is_not_in_the_rests_and_is_in_the_repeats(made):
    command, settled, white, wander = made
    signal = settled + 0.002 * white + 0.004 * wander
    quick = steady_floor(signal, _command(command)).value
    assert quick == pytest.approx(0.002, rel=0.15)
    every = repeats_floor(signal, _command(command))
    assert every.value == pytest.approx(np.hypot(0.002, 0.004 * wander.std()), rel=0.2)
    assert every.rows > 100


def test_play_is_in_the_repeats_only(made):
    command, settled, white, _ = made
    rising = np.sign(np.concatenate([[1.0], np.diff(command)]))
    for k in range(1, N):
        rising[k] = rising[k] or rising[k - 1]
    signal = settled + 0.002 * white + 0.01 * rising
    assert steady_floor(signal, _command(command)).value == pytest.approx(0.002, rel=0.06)
    assert repeats_floor(signal, _command(command)).value > 0.006


def test_pressures_that_move_are_taken_out(made):
    command, settled, white, _ = made
    rng = np.random.default_rng(8)
    truth = 5e5 + 4e3 * _wander(rng, N, 15.0)
    pressure = Driver("p1", truth + 100.0 * rng.standard_normal(N), 100.0)
    signal = settled * (1.0 + (truth - 5e5) / 1e5) + 0.003 * white
    told = steady_floor(signal, _command(command), [pressure]).value
    assert told == pytest.approx(0.003, rel=0.08)
    assert steady_floor(signal, _command(command)).value > 1.5 * told
    # where the pressure comes back as well
    assert repeats_floor(signal, _command(command), [pressure]).value == pytest.approx(0.003, rel=0.25)


def test_noise_of_the_driver_is_no_noise_of_the_signal(made):
    _, settled, white, _ = made
    rng = np.random.default_rng(9)
    opening = Driver("opening", settled + 0.001 * rng.standard_normal(N), 0.001)
    signal = 2.0 * settled + 0.001 * white
    assert steady_floor(signal, opening).value == pytest.approx(0.001, rel=0.06)
    # rows paired by a noisy reading differ by more than their own noise, and that is taken off
    assert repeats_floor(signal, opening).value == pytest.approx(0.001, rel=0.25)


def test_what_never_rests_has_no_floor_and_says_why():
    rng = np.random.default_rng(1)
    command = 0.5 + 0.2 * np.sin(np.arange(N) / 40.0)
    for told in (steady_floor, repeats_floor):
        floor = told(command + 0.002 * rng.standard_normal(N), _command(command))
        assert floor.value is None
        assert "rests" in floor.reason
        assert told(command, None).value is None
        assert told(command[:50], _command(command[:50])).value is None


def test_a_staircase_that_never_turns_has_no_repeats():
    rng = np.random.default_rng(2)
    command = np.full(N, 0.5)
    command[:100], command[-100:] = 0.3, 0.7
    floor = repeats_floor(command + 0.002 * rng.standard_normal(N), _command(command), quantum=1e-4)
    # half an hour at the same place does come back to itself, a tenth of the recording later
    assert floor.value == pytest.approx(0.002, rel=0.15)
    ramp = np.repeat(np.linspace(0.1, 0.9, N // 100), 100)
    none = repeats_floor(ramp + 0.002 * rng.standard_normal(N), _command(ramp))
    assert none.value is None
    assert "comes back" in none.reason


def test_gaps_and_rounding(made):
    command, settled, white, _ = made
    signal = np.round(settled + 0.0003 * white, 2)
    assert steady_floor(signal, _command(command), quantum=0.01).value >= 0.01 / np.sqrt(12.0)
    holed = settled + 0.002 * white
    holed[::500] = np.nan
    holed[1000:1400] = np.nan
    starts = steady_starts(holed, _command(command))
    assert all(np.isfinite(holed[k - 20 : k + LENGTH]).all() for k in starts)
    assert steady_floor(holed, _command(command)).value == pytest.approx(0.002, rel=0.08)
    assert repeats_floor(holed, _command(command)).value == pytest.approx(0.002, rel=0.2)
    assert steady_floor(np.full(N, np.nan), _command(command)).value is None


@pytest.fixture(scope="module")
def recording(made):
    pd = pytest.importorskip("pandas")
    command, settled, white, _ = made
    valve = {
        "valve": {"tag": "V", "kv_rated": 40.0, "characteristic": "linear"},
        "fluid": {"name": "water"},
        "recording": {
            "time": "time",
            "command": {"column": "CV", "unit": "%"},
            "opening": {"column": "X", "unit": "%"},
            "flow": {"column": "F", "unit": "m3/h"},
        },
    }
    rng = np.random.default_rng(3)
    frame = pd.DataFrame(
        {
            "time": np.arange(N, dtype=float),
            "CV": np.round(100.0 * command, 2),
            "X": np.round(100.0 * (settled + 0.001 * rng.standard_normal(N)), 3),
            "F": np.round(40.0 * settled + 0.1 * white, 4),
        }
    )
    return Recording.from_frame(frame, Valve.from_dict(valve))


def test_flow_is_driven_by_the_opening_and_the_opening_by_the_command(recording):
    assert drivers_of(recording, "flow")[0].name == "opening"
    assert drivers_of(recording, "opening")[0].name == "command"
    assert drivers_of(recording, "flow")[1] == []


def test_entry_of_a_channel(recording):
    entry = model_free_noise(recording, "flow", 0.1 / 3600.0, 0.1)
    assert entry["unit"] == "m3/h"
    assert entry["steady"]["value"] == pytest.approx(0.1, rel=0.06)
    assert entry["repeats"]["value"] == pytest.approx(0.1, rel=0.2)
    assert entry["noise_model_above_steady"] is False
    assert entry["at_repeats"] is True
    high = model_free_noise(recording, "flow", 0.2 / 3600.0, 0.2)
    assert high["noise_model_above_steady"] is True
    assert high["at_repeats"] is False
    assert high["repeats_above_steady"] is False
    opening = model_free_noise(recording, "opening", 0.001)
    assert opening["steady"]["value"] == pytest.approx({"%": 0.1, "1": 0.001}[opening["unit"]], rel=0.06)
    assert opening["at_repeats"] is None


def test_a_signal_that_has_changed_in_time_is_no_noise(recording):
    values = recording["flow"].copy()
    values[N // 2 :] *= 0.9

    changed = replace(recording, signals={**recording.signals, "flow": values})
    entry = model_free_noise(changed, "flow", 0.1 / 3600.0, 1.0)
    assert entry["steady"]["value"] == pytest.approx(0.095, rel=0.06)
    assert entry["repeats_above_steady"] is True
    assert entry["at_repeats"] is False
