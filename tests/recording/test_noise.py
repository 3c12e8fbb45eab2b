# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.recording import noise_floor


@given(sigma=st.floats(1e-6, 1e3), seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=30)
def test_white_noise_on_a_smooth_course_with_steps_and_outliers(sigma, seed):
    rng = np.random.default_rng(seed)
    time = np.arange(4000)
    signal = sigma * (20.0 * np.sin(time / 200.0) + rng.normal(size=4000) + 50.0 * (time > 2000))
    signal[rng.integers(0, 4000, 40)] += 100.0 * sigma
    # outliers touch 3 % of the second differences, which lifts the median by 4 %; its own spread is 2 %
    assert noise_floor(signal) == pytest.approx(sigma, rel=0.15)


def test_gaps_are_left_out():
    signal = np.random.default_rng(3).normal(size=5000)
    whole = noise_floor(signal)
    signal[::7] = np.nan
    assert noise_floor(signal) == pytest.approx(whole, rel=0.1)


def test_held_signal_has_none_and_short_one_no_answer():
    assert noise_floor(np.repeat([1.0, 2.0, 3.0], 50)) == 0.0
    assert np.isnan(noise_floor([1.0, 2.0, 4.0]))
    assert np.isnan(noise_floor(np.full(100, np.nan)))
