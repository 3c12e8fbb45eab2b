# SPDX-License-Identifier: BSD-3-Clause
"""Stages that remember: play, lag, delay, rate limit, and the actuator behind its positioner."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sklvalve.simulation.faults import FAULTS
from sklvalve.simulation.stages import (
    delayed,
    first_order_lag,
    from_table,
    limited_rate,
    play,
    play_with_overshoot,
)
from sklvalve.simulation.stem import positioner_and_actuator

SIGNALS = arrays(np.float64, st.integers(2, 60), elements=st.floats(0.0, 1.0))
# an ordinary actuator, in travels of its spring: 20 to 100 kPa of spring, 340 kPa of supply, all gauge
AIR, SPRING, SUPPLY = 101.325 / 80.0, (101.325 + 20.0) / 80.0, (101.325 + 340.0) / 80.0
SOUND = np.empty((0, len(FAULTS)))


def _triangle(n=2000):
    phase = np.linspace(0.0, 4.0, n) % 2.0
    return 0.2 + 0.6 * np.minimum(phase, 2.0 - phase)


def _stem(
    command, *, supply=SUPPLY, coulomb=0.003, stick=0.0, dead_band=0.0, start=None, gain=20.0, reset=0.3
):
    n = len(command)
    return positioner_and_actuator(
        np.asarray(command, dtype=float),
        np.ones(n),
        command[0] if start is None else start,
        SPRING,
        AIR,
        np.full(n, supply),
        np.full(n, coulomb),
        np.full(n, stick),
        np.full(n, dead_band),
        SOUND,
        0.1,
        gain,
        reset,
        1.0,
        0.0,
        1.0,
    )


# ---- play


@settings(max_examples=50, deadline=None)
@given(SIGNALS, st.floats(0.0, 0.5))
def test_play_stays_within_half_its_width_and_moves_only_when_pushed(inside, width):
    outside = play(inside, width)
    assert np.all(np.abs(outside - inside) <= 0.5 * width + 1e-12)
    moved = np.diff(outside)
    assert np.all(moved * np.diff(inside) >= 0.0)


@settings(max_examples=50, deadline=None)
@given(SIGNALS)
def test_play_of_no_width_changes_nothing(inside):
    np.testing.assert_array_equal(play(inside, 0.0), inside)


@settings(max_examples=50, deadline=None)
@given(SIGNALS, st.floats(0.0, 0.5))
def test_play_is_the_same_anywhere_on_the_travel(inside, width):
    outside = play(inside, width)
    np.testing.assert_allclose(play(inside + 0.25, width), outside + 0.25, atol=1e-12)


def test_play_opens_a_hysteresis_of_its_whole_width():
    inside = _triangle()
    outside = play(inside, 0.05)
    rising, falling = np.gradient(inside) > 0, np.gradient(inside) < 0
    middle = (np.arange(len(inside)) > 600) & (np.abs(inside - 0.5) < 0.05)
    up = np.mean((outside - inside)[rising & middle])
    down = np.mean((outside - inside)[falling & middle])
    assert down - up == pytest.approx(0.05, rel=1e-9)


def test_play_keeps_gaps_and_its_place_over_them():
    outside = play(np.array([0.5, np.nan, 0.51, 0.6]), 0.1)
    np.testing.assert_allclose(outside, [0.5, np.nan, 0.5, 0.55])


def test_a_way_that_was_not_seen_is_no_stroke():
    slow, step = np.linspace(0.2, 0.8, 61), np.ones(61)
    seen = play_with_overshoot(slow, step, 0.04, 0.3, 0.0)[-1]
    gap = np.where((np.arange(61) > 0) & (np.arange(61) < 60), np.nan, slow)
    assert play_with_overshoot(gap, step, 0.04, 0.3, 0.0)[-1] == pytest.approx(seen, abs=0.003)
    jump = play_with_overshoot(np.array([0.2, 0.2, 0.8]), np.array([1.0, 1.0, 3600.0]), 0.04, 0.3, 0.0)
    assert jump[-1] == pytest.approx(0.78, abs=0.003)


# ---- lag


@pytest.mark.parametrize("steps", [1, 7, 400])
def test_a_table_is_read_as_numpy_reads_it(steps):
    rng = np.random.default_rng(steps)
    grid = np.linspace(0.0, 1.0, steps + 1)
    table = np.cumsum(rng.normal(size=steps + 1))
    beside = [np.nextafter(grid, -np.inf), np.nextafter(grid, np.inf)]
    at = np.concatenate([grid, *beside, rng.uniform(-0.2, 1.2, 1000), [np.nan, np.inf, -np.inf]])
    np.testing.assert_array_equal(from_table(at, grid, table), np.interp(at, grid, table))


@pytest.mark.parametrize("time_constant", [0.3, 2.0, 17.0])
def test_lag_of_a_step_is_the_exponential(time_constant):
    values = np.r_[np.zeros(5), np.ones(40)]
    step = np.linspace(0.5, 1.5, len(values))
    since = np.cumsum(step[5:])
    lagged = first_order_lag(values, step, time_constant, 1.0)
    np.testing.assert_allclose(lagged[5:], 1.0 - np.exp(-since / time_constant), atol=1e-12)
    # a step right before its sample is one sample younger
    late = first_order_lag(values, step, time_constant, 0.0)
    np.testing.assert_allclose(late[6:], 1.0 - np.exp(-(since[1:] - since[0]) / time_constant), atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(SIGNALS, st.floats(0.01, 50.0), st.floats(0.0, 1.0))
def test_lag_stays_between_what_it_has_seen(values, time_constant, ahead):
    lagged = first_order_lag(values, np.ones(len(values)), time_constant, ahead)
    assert np.all(lagged <= np.maximum.accumulate(values) + 1e-12)
    assert np.all(lagged >= np.minimum.accumulate(values) - 1e-12)


@pytest.mark.parametrize("ahead", [0.0, 0.6, 1.0])
def test_a_lag_is_at_rest_behind_an_hour_that_was_not_seen(ahead):
    jump = first_order_lag(np.array([0.2, 0.2, 0.8, 0.8]), np.array([1.0, 1.0, 3600.0, 1.0]), 2.0, ahead)
    np.testing.assert_allclose(jump, [0.2, 0.2, 0.8, 0.8], atol=1e-3)
    values = np.r_[0.2, 0.2, np.full(40, np.nan), 0.8, 0.8]
    gap = first_order_lag(values, np.ones(len(values)), 2.0, ahead)
    np.testing.assert_allclose(gap[-2:], 0.8, atol=0.04)


def test_a_lag_over_a_gap_is_that_of_a_straight_way():
    ramp, step = np.arange(60.0), np.ones(60)
    seen = np.where((np.arange(60) > 20) & (np.arange(60) < 27), np.nan, ramp)
    # of many small steps, each of which comes in the middle of its sample
    finely = first_order_lag(np.linspace(0.0, 59.0, 5901), np.full(5901, 0.01), 3.0, 0.5)[::100]
    lagged = first_order_lag(seen, step, 3.0, 0.5)
    known = np.isfinite(seen)
    np.testing.assert_allclose(lagged[known], finely[known], atol=0.05)


def test_a_slower_pace_is_no_gap():
    pace, swing = np.r_[np.ones(50), np.full(80, 60.0)], np.r_[np.full(50, 0.5), np.tile([0.0, 1.0], 40)]
    lagged = first_order_lag(swing, pace, 20.0, 1.0)
    settled = 1.0 / (1.0 + np.exp(-3.0))
    np.testing.assert_allclose(lagged[-2:], [1.0 - settled, settled], atol=1e-6)


def test_lag_of_nothing_and_gaps():
    values = np.array([1.0, 2.0, np.nan, 4.0])
    np.testing.assert_array_equal(first_order_lag(values, np.ones(4), 0.0, 1.0), values)
    lagged = first_order_lag(values, np.ones(4), 2.0, 1.0)
    np.testing.assert_array_equal(np.isnan(lagged), np.isnan(values))


# ---- delay and rate


def test_delay_by_whole_samples_shifts():
    time = np.arange(50.0)
    values = np.sin(time / 3.0)
    np.testing.assert_allclose(delayed(values, time, 4.0)[4:], values[:-4], atol=1e-12)
    np.testing.assert_array_equal(delayed(values, time, 4.0)[:4], values[0])


def test_delay_between_samples_is_linear_and_none_is_none():
    time = np.array([0.0, 1.0, 2.0, 4.0])
    values = np.array([0.0, 1.0, 3.0, 3.0])
    np.testing.assert_allclose(delayed(values, time, 0.5), [0.0, 0.5, 2.0, 3.0])
    assert delayed(values, time, 0.0) is values


def test_delay_bridges_gaps():
    time = np.arange(5.0)
    values = np.array([0.0, 1.0, np.nan, 3.0, 4.0])
    np.testing.assert_allclose(delayed(values, time, 1.0), [0.0, 0.0, 1.0, 2.0, 3.0])


@settings(max_examples=50, deadline=None)
@given(SIGNALS, st.floats(0.001, 2.0), st.floats(0.001, 2.0))
def test_rate_limit_is_kept_in_each_direction(values, up, down):
    step = np.linspace(0.5, 2.0, len(values))
    followed = limited_rate(values, step, up, down)
    rate = np.diff(followed) / step[1:]
    assert np.all(rate <= up + 1e-9)
    assert np.all(rate >= -down - 1e-9)
    np.testing.assert_allclose(limited_rate(values, step, 1e9, 1e9), values, atol=1e-12)


def test_rate_limit_holds_in_gaps_and_has_had_their_time_behind_them():
    followed = limited_rate(np.array([0.0, 1.0, np.nan, 0.0]), np.ones(4), 0.2, 0.05)
    np.testing.assert_allclose(followed, [0.0, 0.2, 0.2, 0.1])


# ---- positioner and actuator


@pytest.mark.parametrize("goal", [0.1, 0.37, 0.6, 0.95])
def test_stem_settles_on_the_command(goal):
    stem = _stem(np.r_[np.full(20, 0.5), np.full(200, goal)])
    assert stem[-1] == pytest.approx(goal, abs=0.003)


def test_stem_stays_within_its_travel():
    stem = _stem(np.r_[np.full(50, 1.3), np.full(50, -0.3)], start=0.5)
    assert stem.max() == 1.0
    assert stem.min() == 0.0


@pytest.mark.parametrize("balance", [0.3, 0.55, 0.8])
def test_low_supply_ends_the_travel_where_the_spring_balances_it(balance):
    stem = _stem(np.full(900, 1.0), supply=SPRING + balance, start=0.1)
    assert stem[-1] == pytest.approx(balance, abs=0.01)
    # and venting is as before: the way down is open
    down = _stem(np.r_[np.full(600, 1.0), np.full(300, 0.15)], supply=SPRING + balance, start=0.1)
    assert down[-1] == pytest.approx(0.15, abs=0.01)


def _hysteresis(**options):
    command = _triangle(4000)
    stem = _stem(command, **options)
    rising, falling = np.gradient(command) > 0, np.gradient(command) < 0
    middle = (np.arange(len(command)) > 1200) & (np.abs(command - 0.5) < 0.1)
    return np.mean((stem - command)[falling & middle]) - np.mean((stem - command)[rising & middle])


def _wave():
    return 0.5 + 0.05 * np.sin(2.0 * np.pi * np.arange(1200.0) / 200.0)


def test_friction_widens_the_way_round():
    # of a positioner without integral; each reversal has twice the friction to overcome
    command = _wave()
    errors = [
        np.sqrt(np.mean((_stem(command, coulomb=c, gain=5.0, reset=0.0) - command)[300:] ** 2))
        for c in (0.002, 0.03, 0.1)
    ]
    assert errors[1] > 1.5 * errors[0]
    assert errors[2] > 1.5 * errors[1]


def test_dead_band_widens_the_hysteresis_by_its_width():
    plain, banded = (_hysteresis(dead_band=d) for d in (0.0, 0.02))
    assert banded - plain == pytest.approx(0.04, abs=0.01)


def test_friction_at_rest_makes_the_stem_jump():
    smooth, sticky = (_stem(_wave(), stick=s, gain=5.0, reset=0.0) for s in (0.0, 0.2))
    assert np.abs(np.diff(smooth)).max() < 0.005
    # a stem that slips loses all of the force at rest: the spring and the chamber's air take it up
    air = (SPRING + 0.5) / (5.0 + 0.5)
    assert 0.6 < np.abs(np.diff(sticky)).max() / (0.2 / (1.0 + air)) < 1.0


def test_gap_in_the_command_holds_the_value_before_it():
    command = np.r_[np.full(20, 0.2), np.full(30, 0.7), np.full(50, 0.7)]
    gappy = command.copy()
    gappy[40:60] = np.nan
    np.testing.assert_array_equal(_stem(gappy), _stem(command))


def test_a_recording_that_begins_with_a_gap_begins_where_the_stem_is():
    stem = _stem(np.r_[np.full(30, np.nan), np.full(30, 0.4)], start=0.4)
    np.testing.assert_allclose(stem, 0.4, atol=0.005)


@pytest.mark.parametrize("gap", [600.0, 20_000.0, 5e6])
def test_a_night_without_samples_settles_the_stem_and_keeps_it_finite(gap):
    command = np.r_[np.full(50, 0.3), np.full(50, 0.7)]
    step = np.ones(100)
    step[50] = gap
    n = len(command)
    stem = positioner_and_actuator(
        command,
        step,
        0.3,
        SPRING,
        AIR,
        np.full(n, SUPPLY),
        np.full(n, 0.003),
        np.zeros(n),
        np.zeros(n),
        SOUND,
        0.1,
        20.0,
        0.3,
        1.0,
        0.0,
        1.0,
    )
    assert np.all(np.isfinite(stem))
    np.testing.assert_allclose(stem[50:], 0.7, atol=0.01)
