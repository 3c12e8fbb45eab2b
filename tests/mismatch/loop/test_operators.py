# SPDX-License-Identifier: BSD-3-Clause
"""The stem's law, against play computed another way, and by its properties."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sklvalve.mismatch.loop.operators import candidate_stems, stick_glide, stick_jump, stick_slip
from sklvalve.mismatch.loop.signals import loop_signals
from sklvalve.recording import Recording


def _walk(seed, n=300):
    return np.cumsum(np.random.default_rng(seed).standard_normal(n)) * 0.01


def _glide(command, stick, slip):
    return stick_glide(command, np.array([stick]), np.array([slip]), command[:1], command)[0][0]


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), stick=st.floats(0.001, 0.2), jump=st.floats(0.0, 1.0))
def test_the_stem_is_never_further_behind_than_its_band(seed, stick, jump):
    command = _walk(seed)
    stem = stick_slip(command, stick, jump * stick)
    assert np.abs(command - stem).max() <= 0.5 * stick * (1.0 + jump) + 1e-12


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), stick=st.floats(0.001, 0.2))
def test_without_a_jump_it_is_play(seed, stick):
    command = _walk(seed)
    expected, stem = [], command[0]
    for value in command:
        stem = min(max(stem, value - 0.5 * stick), value + 0.5 * stick)
        expected.append(stem)
    assert_allclose(stick_slip(command, stick, 0.0), expected, rtol=0, atol=1e-12)


def test_a_turn_moves_the_stem_after_the_band_and_by_the_jump():
    rise = np.linspace(0.0, 0.5, 501)
    command = np.concatenate([rise, rise[::-1]])
    stem = stick_slip(command, 0.1, 0.04, start=command[0])
    moved = np.flatnonzero(np.diff(stem[500:]) < 0.0)[0]
    assert command[500] - command[501 + moved] == pytest.approx(0.1, abs=0.041)
    assert stem[500 + moved] - stem[501 + moved] == pytest.approx(0.04, abs=0.0011)


def test_no_band_is_the_command_itself():
    command = _walk(0)
    assert_allclose(stick_slip(command, 0.0, 0.0), command, rtol=0, atol=0)


def test_a_jump_larger_than_the_band_is_refused():
    with pytest.raises(ValueError, match="0 <= slip <= stick"):
        stick_slip([0.0, 1.0], 0.1, 0.2)


def test_the_first_candidate_is_the_command_and_a_good_forecast_of_it_forecasts_the_stems():
    command = _walk(1)
    value = np.linspace(1.0, 2.0, len(command))
    frame = {"time": np.arange(len(command)), "command": 0.5 + 0.1 * command, "flow": value}
    loop = replace(
        loop_signals(Recording.from_frame(frame)),
        command=command,
        recorded_command=command,
        decimation=1,
        span=0.5,
    )
    tried = candidate_stems(loop, command)
    assert tried.stick[0] == 0.0
    assert_allclose(tried.stem[0], command)
    assert_allclose(tried.stem_forecast, tried.stem, rtol=0, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), stick=st.floats(0.001, 0.2))
def test_without_a_jump_both_forms_are_play(seed, stick):
    command = _walk(seed)
    assert_allclose(_glide(command, stick, 0.0), stick_slip(command, stick, 0.0), atol=1e-12)


def test_a_gliding_stem_jumps_once_a_turn_and_then_keeps_its_distance():
    rise = np.linspace(0.0, 0.5, 501)
    command = np.concatenate([rise, rise[::-1]])
    stem = _glide(command, 0.1, 0.06)
    steps = np.abs(np.diff(stem))
    assert_allclose(np.flatnonzero(steps > 0.05), [80, 600], rtol=0, atol=1)
    assert_allclose(stem[90:501], command[90:501] - 0.02, rtol=0, atol=1e-12)
    assert_allclose(stem[610:], command[610:] + 0.02, rtol=0, atol=1e-12)


@pytest.mark.parametrize("law", [stick_jump, stick_glide])
def test_a_good_forecast_of_the_command_forecasts_the_stem(law):
    command = _walk(3)
    stem, ahead = law(
        command, np.array([0.05, 0.1]), np.array([0.02, 0.1]), start=np.zeros(2), forecast=command
    )
    assert_allclose(ahead, stem, rtol=0, atol=1e-12)
