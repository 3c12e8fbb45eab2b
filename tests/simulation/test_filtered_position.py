# SPDX-License-Identifier: BSD-3-Clause
"""A position is filtered where the stem rests; strokes, gaps and joined recordings stay what they are."""

import numpy as np
import pytest

from sklvalve.recording import Recording, join_recordings
from sklvalve.simulation.filtered_position import filtered_position
from sklvalve.simulation.stages import play

ROWS, NOISE = 1200, 0.003


def _recording(valve, opening, flow=0.005):
    """A recording of a position, a flow and nothing else that matters."""
    rows = len(opening)
    signals = {
        "opening": np.asarray(opening, dtype=float),
        "flow": np.broadcast_to(flow, rows).astype(float),
        "p1": np.full(rows, 6e5),
        "p2": np.full(rows, 2e5),
        "temperature": np.full(rows, 293.0),
    }
    time = np.arange(float(rows))
    return Recording(time=time, stamps=time, signals=signals, valve=valve)


@pytest.fixture
def steps():
    """A stem that rests for two minutes at a time, and its strokes of a quarter of the travel."""
    return np.repeat([0.2, 0.45, 0.7, 0.45, 0.2, 0.7, 0.95, 0.7, 0.45, 0.2], ROWS // 10)


@pytest.fixture
def trembling(steps):
    return steps + NOISE * np.random.default_rng(4).standard_normal(ROWS)


def test_noise_is_averaged_out_where_the_stem_rests(recording, steps, trembling):
    left = filtered_position(_recording(recording.valve, trembling)) - steps
    assert np.std(left) < 0.5 * NOISE


def test_strokes_stay_where_they_are(recording, steps, trembling):
    filtered = filtered_position(_recording(recording.valve, trembling))
    np.testing.assert_allclose(
        np.diff(filtered)[np.diff(steps) != 0.0], np.diff(steps)[np.diff(steps) != 0.0], atol=0.012
    )


def test_a_ramp_is_not_delayed(recording):
    ramp = np.linspace(0.1, 0.9, ROWS)
    noisy = ramp + NOISE * np.random.default_rng(5).standard_normal(ROWS)
    left = filtered_position(_recording(recording.valve, noisy)) - ramp
    assert abs(np.mean(left[20:-20])) < 0.2 * NOISE


def test_play_as_wide_as_the_noise_explains_less_of_it_than_before(recording, steps, trembling):
    filtered = filtered_position(_recording(recording.valve, trembling))
    before, now = (np.std(x - steps) - np.std(play(x, 2.0 * NOISE) - steps) for x in (trembling, filtered))
    # play filters the noise of the raw reading; in the filtered one it only holds the plug off its place
    assert before > 0.3 * NOISE
    assert now <= 0.0


def test_a_reading_without_noise_is_returned_as_it_is(recording, steps):
    assert np.array_equal(filtered_position(_recording(recording.valve, steps)), steps)


def test_gaps_stay_gaps_and_touch_nothing_else(recording, steps, trembling):
    gap = slice(300, 330)
    trembling[gap] = np.nan
    filtered = filtered_position(_recording(recording.valve, trembling))
    assert np.isnan(filtered[gap]).all()
    assert np.isfinite(np.delete(filtered, np.arange(ROWS)[gap])).all()
    assert np.nanstd(filtered - steps) < 0.5 * NOISE


def test_joined_recordings_are_kept_apart(recording, trembling):
    one, other = _recording(recording.valve, trembling), _recording(recording.valve, trembling[::-1])
    both = filtered_position(join_recordings([one, other]))
    np.testing.assert_array_equal(both, np.concatenate([filtered_position(one), filtered_position(other)]))


@pytest.mark.parametrize("late", [0, 2])
def test_a_stem_that_never_rests_is_no_noise_where_the_flow_follows_it(recording, trembling, late):
    flow = 0.01 * np.roll(trembling, late)
    left = filtered_position(_recording(recording.valve, trembling, flow)) - trembling
    assert np.std(left) < 0.1 * NOISE


def test_of_what_a_flow_follows_in_part_as_much_is_kept_as_is_sure(recording, trembling):
    rng = np.random.default_rng(8)
    flow = 0.01 * (trembling + NOISE * rng.standard_normal(ROWS))
    averaged = filtered_position(_recording(recording.valve, trembling)) - trembling
    left = filtered_position(_recording(recording.valve, trembling, flow)) - trembling
    # half of the flow's quick variance is the stem's
    assert np.std(left) / np.std(averaged) == pytest.approx(0.5, abs=0.1)


def test_a_flow_that_moves_against_it_is_no_sign_of_movement(recording, trembling):
    against = filtered_position(_recording(recording.valve, trembling, 0.02 - 0.01 * trembling))
    averaged = filtered_position(_recording(recording.valve, trembling))
    assert np.std(against - averaged) < 0.1 * np.std(trembling - averaged)


def test_gaps_of_the_flow_say_nothing(recording, trembling):
    flow = 0.01 * trembling
    flow[100:400] = np.nan
    left = filtered_position(_recording(recording.valve, trembling, flow)) - trembling
    assert np.isfinite(left).all()
    assert np.std(left) < 0.1 * NOISE
    nothing = np.full(ROWS, np.nan)
    np.testing.assert_array_equal(
        filtered_position(_recording(recording.valve, trembling, nothing)),
        filtered_position(_recording(recording.valve, trembling)),
    )


def test_one_event_in_both_is_no_stem_that_never_rests(recording, trembling):
    rng = np.random.default_rng(9)
    flow = 0.01 + 0.001 * NOISE * rng.standard_normal(ROWS)
    struck = trembling.copy()
    struck[200:202] += 40.0 * NOISE
    flow[200:202] += 0.04 * NOISE
    alone = filtered_position(_recording(recording.valve, struck))
    both = filtered_position(_recording(recording.valve, struck, flow))
    assert np.std(both - alone) < 0.05 * np.std(struck - alone)
