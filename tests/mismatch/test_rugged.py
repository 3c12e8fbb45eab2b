# SPDX-License-Identifier: BSD-3-Clause
"""The search before the fit of an effect with many side valleys."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch.effects.stiction import Stiction
from sklvalve.mismatch.rugged import episodes_of, rugged_start
from sklvalve.mismatch.workbench import Member, Workbench
from sklvalve.simulation.stages import followed_stem, positioner_and_actuator
from sklvalve.simulation.tolerance import Tolerance

FRICTION = {"stiction.static_friction": 0.15, "stiction.sliding_share": 0.9}


def _stem_arguments(command, stick):
    ones = np.ones(len(command))
    friction = (0.05 * ones, stick * ones, 0.0 * ones)
    return (command, ones, command[0], 1.5, 5.5 * ones, *friction, 0.1, 6.0, 0.01, 1.0)


def _moved(n=400):
    walk = np.repeat(np.random.default_rng(3).uniform(0.2, 0.8, n // 40), 40)
    return walk + 0.02 * np.sin(np.arange(n) / 7.0)


def test_stem_that_is_not_held_runs_freely():
    arguments = _stem_arguments(_moved(), 0.2)
    free = positioner_and_actuator(*arguments)
    followed = followed_stem(*arguments, 0.0, np.zeros(len(free)), 0.0)
    np.testing.assert_array_equal(followed, free)


def test_held_stem_forgets_a_wrong_beginning():
    command = _moved()
    true = positioner_and_actuator(*_stem_arguments(command, 0.2))
    wrong = list(_stem_arguments(command, 0.2))
    wrong[2] = command[0] + 0.3
    followed = followed_stem(*wrong, 0.0, true, 1.0)
    assert abs(followed[0] - true[0]) > 0.02
    assert np.median(np.abs(followed - true)[200:]) < 1e-3


def test_pressure_fed_back_lets_a_stem_stay_where_friction_holds_it():
    command = np.where(np.arange(300) < 20, 0.5, 0.52)
    arguments = _stem_arguments(command, 0.3)
    rising = positioner_and_actuator(*arguments)
    staying = positioner_and_actuator(*arguments, 4.0)
    # 2 % ask for less pressure than friction takes up, but they keep a spool without feedback open
    assert abs(rising[-1] - 0.52) < 0.001
    assert abs(staying[-1] - 0.50) < 0.005


def test_pressure_fed_back_changes_little_without_friction():
    command = _moved()
    arguments = list(_stem_arguments(command, 0.0))
    arguments[5] = np.full(len(command), 1e-3)
    arguments[9] = 6.0
    without = positioner_and_actuator(*arguments)
    arguments[9] = 4.0
    with_feedback = positioner_and_actuator(*arguments, 2.0)
    assert np.sqrt(np.mean((without - with_feedback) ** 2)) < 0.005


def test_episodes_lie_where_the_gap_is():
    gap = np.zeros(2000)
    gap[700:730], gap[1500:1520] = 0.1, 0.05
    found = episodes_of(gap, np.full(2000, 0.5), 1.0)
    assert len(found) == 2
    for (begin, compared, end), middle in zip(found, (715, 1510), strict=True):
        assert begin < compared <= middle < end
        assert compared - begin >= 30
    assert episodes_of(gap, np.full(2000, 0.5), 1.0, first=1000)[0][1] >= 1000


def test_episodes_of_nothing_are_none():
    assert episodes_of(np.zeros(500), np.full(500, 0.5), 1.0) == []
    assert episodes_of(np.ones(30), np.full(30, 0.5), 1.0) == []


@pytest.fixture(scope="module")
def sticking(healthy):
    """A recording whose opening is the simulation's own, with friction and a little noise."""
    bench = Workbench(healthy, Tolerance(), ())
    values = bench.calibrated().values
    opening = bench.chain((Member(Stiction()),)).opening(values | FRICTION)
    noisy = opening + np.random.default_rng(5).normal(0.0, 0.001, len(opening))
    recording = replace(healthy, signals=healthy.signals | {"opening": noisy})
    bench = Workbench(recording, Tolerance(), ())
    return bench, bench.calibrated()


def _rms(bench, members, values):
    left = bench.recording["opening"] - bench.chain(members).opening(values)
    return float(np.sqrt(np.nanmean(left**2)))


def test_search_finds_what_the_nominal_lacks(sticking):
    bench, nominal = sticking
    members = (Member(Stiction()),)
    values = rugged_start(bench, nominal, Stiction())
    assert set(values) == set(nominal.values) | set(FRICTION)
    assert values["stiction.static_friction"] == pytest.approx(0.15, rel=0.25)
    assert _rms(bench, members, values) < 0.75 * _rms(bench, (), nominal.values)


def test_search_gives_the_same_twice(sticking):
    bench, nominal = sticking
    assert rugged_start(bench, nominal, Stiction()) == rugged_start(bench, nominal, Stiction())


def test_search_stays_within_bounds_and_leaves_the_rest(sticking):
    bench, nominal = sticking
    onset = float(bench.plain.clock[400])
    values = rugged_start(bench, nominal, Stiction(), onset)
    for p in bench.calibration(("opening",)):
        assert p.low * (1 - 1e-9) - 1e-12 <= values[p.name] <= p.high * (1 + 1e-9)
    for q in Stiction.parameters:
        assert q.low * (1 - 1e-9) <= values[f"stiction.{q.name}"] <= q.high * (1 + 1e-9)
    assert values["position_zero"] == nominal.values["position_zero"]
