# SPDX-License-Identifier: BSD-3-Clause
"""The finder of oscillations on signals whose period is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from sklvalve.mismatch.loop.oscillation import find_oscillation


def _wave(rows, count, seed, jitter=0.3):
    """A sine whose phase wanders a little."""
    rng = np.random.default_rng(seed)
    wander = np.cumsum(jitter * rng.standard_normal(count)) / np.sqrt(rows)
    return np.sin(2.0 * np.pi * np.arange(count) / rows + wander)


@pytest.mark.parametrize("sample_time", [0.2, 60.0])
@pytest.mark.parametrize("rows", [5, 20, 100, 500])
def test_the_period_is_found_in_noise_and_drift(rows, sample_time):
    count = max(1000, 8 * rows)
    rng = np.random.default_rng(1)
    wave = _wave(rows, count, 2)
    value = 300.0 + 7.0 * (wave + 0.5 * rng.standard_normal(count) + np.linspace(0.0, 6.0, count))
    found = find_oscillation(50.0 + rng.standard_normal(count), value, sample_time)
    assert found.regular
    assert found.signal == "value"
    assert found.rows == pytest.approx(rows, rel=0.06)
    assert found.period == pytest.approx(found.rows * sample_time)
    assert found.cycles == pytest.approx(count / found.rows)


def test_of_several_the_strongest_is_taken():
    value = 2.0 * _wave(80, 4000, 0) + _wave(13, 4000, 1) + 0.7 * _wave(300, 4000, 2)
    found = find_oscillation(np.zeros(4000), value, 1.0)
    assert found.regular
    assert found.rows == pytest.approx(80, rel=0.05)
    assert 0.5 < found.share < 0.85


@pytest.mark.parametrize("colour", [0.0, 0.5, 0.9, 0.98, 1.0])
@pytest.mark.parametrize("count", [300, 2000])
def test_noise_of_any_colour_seldom_oscillates(colour, count):
    rng = np.random.default_rng(3)
    noise = lfilter([1.0], [1.0, -colour], rng.standard_normal((40, 2, count)))
    assert sum(find_oscillation(*each, 1.0).regular for each in noise) <= 2


def test_a_set_point_that_swings_is_no_oscillation_of_the_error():
    wave = _wave(40, 2000, 4)
    noise = np.random.default_rng(5).standard_normal(2000)
    found = find_oscillation(noise, wave + 0.01 * noise, 1.0, setpoint=wave)
    assert not found.regular


@pytest.mark.parametrize("count", [3, 11, 500])
def test_what_does_not_move_has_no_line(count):
    found = find_oscillation(np.full(count, 40.0), np.full(count, 2.5), 1.0)
    assert (found.period, found.rows, found.regular) == (None, None, False)
    assert found.share == 0.0


def test_rows_that_were_not_recorded_are_bridged():
    wave = _wave(30, 900, 6)
    wave[100:110] = np.nan
    found = find_oscillation(np.full(900, np.nan), wave, 1.0)
    assert found.regular
    assert found.rows == pytest.approx(30, rel=0.05)


def test_the_period_does_not_depend_on_units():
    wave, noise = _wave(25, 1000, 7), np.random.default_rng(8).standard_normal(1000)
    first = find_oscillation(wave, wave + 0.3 * noise, 1.0)
    second = find_oscillation(1e-6 * wave, 1e5 - 3e4 * (wave + 0.3 * noise), 1.0)
    assert second.rows == pytest.approx(first.rows, rel=1e-6)
    assert second.regularity == pytest.approx(first.regularity, rel=1e-3)
