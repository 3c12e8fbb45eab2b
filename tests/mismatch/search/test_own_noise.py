# SPDX-License-Identifier: BSD-3-Clause
"""Hypotheses by the noise that they leave themselves."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.search.own_noise import (
    explains_as_much,
    fitted_with_its_noise,
    likelihood_across_noises,
    penalised_by_its_noise,
)
from sklvalve.mismatch.search.rivals import _at_other_times, weighed
from sklvalve.recording import Recording, Valve

EFFECTS = {e.key: e for e in CATALOGUE}
LEAK, GAIN, DEAD = (Term(EFFECTS[key]) for key in ("seat_leakage", "flow_meter_gain", "dead_time"))
THRESHOLD = 15.0


@pytest.fixture(scope="module")
def leaking():
    made = make_valve_recording("seat_leakage", 0.04, loop="wide", n_samples=900, n_later=0, random_state=3)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    problem, nominal = calibrated(prepared_problem(recording, None, None))
    return problem, nominal, {m: problem.fit((m,), start=nominal) for m in (LEAK, GAIN)}


def _likelihood(problem, model):
    return likelihood_across_noises(*fitted_with_its_noise(problem, model))


def as_much(problem, simple, full, term):
    less, more = (penalised_by_its_noise(problem, m) for m in (simple, full))
    return explains_as_much(problem, simple, term, less, more)


def test_the_right_hypothesis_is_the_likeliest_by_its_own_noise(leaking):
    problem, nominal, fits = leaking
    others = (fits[GAIN], nominal)
    assert _likelihood(problem, fits[LEAK]) > THRESHOLD + max(_likelihood(problem, m) for m in others)


def test_the_likelihood_does_not_hang_on_the_noise_that_it_begins_with(leaking):
    problem, nominal, fits = leaking
    by_wide = _likelihood(problem.with_noise_of(nominal), fits[LEAK])
    by_narrow = _likelihood(problem.with_noise_of(fits[LEAK]), fits[LEAK])
    assert by_wide == pytest.approx(by_narrow, abs=1.0)


def test_no_hypothesis_is_less_likely_than_by_the_noise_that_it_came_with(leaking, monkeypatch):
    problem, nominal, fits = leaking
    by_its_own, fitted = fitted_with_its_noise(problem, fits[LEAK])
    # a noise fit that ends in a valley of its own: whatever it is asked for, the noise of nothing
    valley = problem.with_noise_of(nominal)
    monkeypatch.setattr(type(problem), "with_noise_of", lambda self, model: self.with_noise(valley.noise))
    kept, model = fitted_with_its_noise(by_its_own, fitted)
    assert kept is by_its_own
    assert model.log_likelihood == pytest.approx(fitted.log_likelihood, abs=0.01)


def test_a_second_effect_must_tell_more_than_the_first_one_gets_wrong(leaking):
    problem, _, fits = leaking
    both = {
        first: problem.fit((first, second), start=fits[first])
        for first, second in ((LEAK, GAIN), (GAIN, LEAK))
    }
    assert as_much(problem, fits[LEAK], both[LEAK], GAIN)
    assert not as_much(problem, fits[GAIN], both[GAIN], LEAK)


def test_what_is_explained_in_another_signal_asks_for_no_more(leaking, monkeypatch):
    problem, _, fits = leaking
    asked = []
    monkeypatch.setattr(
        "sklvalve.mismatch.search.own_noise.posterior", lambda both, gain: asked.append(gain) or both
    )
    as_much(problem, fits[LEAK], fits[LEAK], DEAD)
    assert "opening" in problem.channels
    assert asked == [pytest.approx(0.0, abs=1e-6)]
    as_much(problem, fits[LEAK], fits[LEAK], GAIN)
    assert asked[-1] > THRESHOLD


def test_rivals_are_weighed_by_their_own_noise(leaking):
    problem, nominal, fits = leaking
    # the wrong one stands, and with it its noise
    problem = problem.with_noise_of(fits[GAIN])
    places = [(m, problem.fit((m,), start=fits[m])) for m in (GAIN, LEAK)]
    without = problem.fit((), start=nominal)
    first, second = weighed(problem, places, without)
    assert first.term is LEAK
    assert first.gain - second.gain == pytest.approx(
        _likelihood(problem, places[1][1]) - _likelihood(problem, places[0][1]), abs=1e-6
    )
    assert np.isclose(first.probability + second.probability, 1.0)
    assert second.distance > first.distance == 0.0


def test_an_effect_at_other_times_stands_once_and_only_throughout_against_within():
    def met(key, onset, likelihood):
        return Model((Term(EFFECTS[key], onset),), None, {}, {}, likelihood, {})

    def fit(terms, *, start):
        return replace(start, terms=terms)

    several = [met("clogging", 310.0, -9.0), met("clogging", 311.0, -5.0), met("seat_leakage", None, -4.0)]
    bench, without = SimpleNamespace(fit=fit), SimpleNamespace(values={})
    effects = [EFFECTS["clogging"], EFFECTS["seat_leakage"]]
    place = Term(EFFECTS["flow_meter_drift"])
    found = _at_other_times(bench, (), without, effects, place, several)
    assert [(t.effect.key, t.onset) for t, _ in found] == [("clogging", 311.0)]
    within = Term(EFFECTS["flow_meter_gain"], 300.0)
    found = _at_other_times(bench, (), without, effects, within, several)
    assert [(t.effect.key, t.onset) for t, _ in found] == [("seat_leakage", None)]
