# SPDX-License-Identifier: BSD-3-Clause
"""The race of the effects: who leaves it, and that none of those leaves who would have won."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch import screening
from sklvalve.mismatch.calibrating import calibrated
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.preparation import prepared_workbench
from sklvalve.mismatch.screening import screened


def _left(trials, staying=()):
    """Keys that stay of (key, worth, reach)."""
    told = [SimpleNamespace(key=key, worth=worth, reach=reach) for key, worth, reach in trials]
    return [t.key for t in screening._within_reach(told, set(staying))]


FIVE = [("a", 50.0, 100.0), ("b", 40.0, 80.0), ("c", 30.0, 60.0), ("d", 20.0, 40.0), ("e", 9.0, 18.0)]


def test_those_leave_that_cannot_reach_the_fourth_best():
    assert _left(FIVE) == ["a", "b", "c", "d"]
    assert _left([*FIVE[:4], ("e", 11.0, 22.0)]) == ["a", "b", "c", "d", "e"]
    assert _left(FIVE, staying="e") == ["a", "b", "c", "d", "e"]


def test_two_trials_of_one_effect_hold_one_place():
    assert _left([*FIVE[:3], ("a", 45.0, 90.0), FIVE[4]]) == ["a", "b", "c", "a", "e"]


def test_fewer_than_the_best_all_stay():
    assert _left([]) == []
    assert _left([("a", -50.0, 0.0)]) == ["a"]


@pytest.fixture(scope="module")
def bench(leaking):
    workbench = prepared_workbench(leaking)
    return workbench, calibrated(workbench)


def _best(workbench, tried):
    """Of the four best effects key and gain."""
    best = {}
    for m in tried:
        best.setdefault(m.members[-1].effect.key, m.log_likelihood)
    return dict(list(best.items())[:4])


def test_the_race_leaves_the_best_as_they_are_and_saves_most_steps(bench, monkeypatch):
    workbench, nominal = bench
    effects = [e for e in CATALOGUE if e.possible(nominal.chain)]
    steps, step = [], screening.Trial.step
    monkeypatch.setattr(screening.Trial, "step", lambda trial: steps.append(1) or step(trial))
    raced, taken = screened(workbench, nominal, effects), len(steps)
    monkeypatch.setattr(screening, "_AT_MOST", np.inf)
    every = screened(workbench, nominal, effects)
    assert _best(workbench, raced) == _best(workbench, every)
    assert len(raced) < 0.5 * len(every)
    assert taken < 0.5 * (len(steps) - taken)


def test_what_is_fitted_in_any_case_stays(bench):
    workbench, nominal = bench
    effects = [e for e in CATALOGUE if e.possible(nominal.chain)]
    last = screened(workbench, nominal, effects, always=effects)[-1].members[-1].effect
    keys = [m.members[-1].effect.key for m in screened(workbench, nominal, effects, always=[last])]
    assert last.key in keys
    assert last.key not in [m.members[-1].effect.key for m in screened(workbench, nominal, effects)]


def test_effects_are_tried_from_other_calibrations_too(bench):
    workbench, nominal = bench
    leak = [e for e in CATALOGUE if e.key == "seat_leakage"]
    once = screened(workbench, nominal, leak)
    assert len(screened(workbench, nominal, leak, also=[(nominal, leak)])) == 2 * len(once)
