# SPDX-License-Identifier: BSD-3-Clause
"""The race of the effects: who leaves it, and that none of those leaves who would have won."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.search import screening
from sklvalve.mismatch.search.screening import screened
from sklvalve.simulation.noise import NoiseModel


def _left(trials, staying=()):
    """Keys that stay of (key, worth, reach)."""
    told = [
        SimpleNamespace(key=key, penalised_likelihood=penalised_likelihood, reach=reach)
        for key, penalised_likelihood, reach in trials
    ]
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
    problem = prepared_problem(leaking)
    return calibrated(problem)


def _best(problem, tried):
    """Of the four best effects key and gain."""
    best = {}
    for m in tried:
        best.setdefault(m.terms[-1].effect.key, m.log_likelihood)
    return dict(list(best.items())[:4])


def test_the_race_leaves_the_best_as_they_are_and_saves_most_steps(bench, monkeypatch):
    problem, nominal = bench
    effects = [e for e in CATALOGUE if e.possible(nominal.chain)]
    steps, step = [], screening.Trial.step
    monkeypatch.setattr(screening.Trial, "step", lambda trial: steps.append(1) or step(trial))
    raced, taken = screened(problem, nominal, effects), len(steps)
    monkeypatch.setattr(screening, "_AT_MOST", np.inf)
    every = screened(problem, nominal, effects)
    assert _best(problem, raced) == _best(problem, every)
    assert len(raced) < 0.5 * len(every)
    assert taken < 0.5 * (len(steps) - taken)


def test_what_is_fitted_in_any_case_stays(bench):
    problem, nominal = bench
    effects = [e for e in CATALOGUE if e.possible(nominal.chain)]
    last = screened(problem, nominal, effects, always=effects)[-1].terms[-1].effect
    keys = [m.terms[-1].effect.key for m in screened(problem, nominal, effects, always=[last])]
    assert last.key in keys
    assert last.key not in [m.terms[-1].effect.key for m in screened(problem, nominal, effects)]


def test_effects_are_tried_from_other_calibrations_too(bench):
    problem, nominal = bench
    leak = [e for e in CATALOGUE if e.key == "seat_leakage"]
    once = screened(problem, nominal, leak)
    assert len(screened(problem, nominal, leak, also=[(nominal, leak)])) == 2 * len(once)


def test_a_step_beside_a_wander_is_dated_by_its_jump(bench):
    problem, nominal = bench
    rows, row = len(problem.recording), 700
    # a random walk forgets within some rows that it has made a step: all later rows look alike
    wander = np.cumsum(np.random.default_rng(3).normal(0.0, 1.0, rows))
    unit = 0.002 * problem.spans["flow"]
    flow = nominal.predictions["flow"] + unit * (wander + 8.0 * (np.arange(rows) >= row))
    recording = replace(problem.recording, signals=problem.recording.signals | {"flow": flow})
    changed = prepared_problem(recording)
    noise = NoiseModel(
        np.full(rows, 0.1 * unit**2), np.ones(rows), 1.0, 1e-12, 1000.0, 500.0 * unit**2, sensor=unit**2
    )
    changed = changed.with_noise(problem.noise | {"flow": noise})
    base = changed.judged(changed.simulate((), nominal.values))
    bias = [e for e in CATALOGUE if e.key == "flow_meter_bias"]
    late = next(m for m in screened(changed, base, bias) if m.terms[-1].onset is not None)
    at = changed.plain.clock[row]
    assert late.terms[-1].onset == pytest.approx(at, abs=1.5 * problem.recording.sample_time)
