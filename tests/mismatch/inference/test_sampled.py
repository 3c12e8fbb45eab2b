# SPDX-License-Identifier: BSD-3-Clause
"""A stem's fit from sampled points: where it ends does not hang on where it began."""

from dataclasses import replace

import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.history import ValveHistory
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference import calibrating
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.sampled import sampled_fit
from sklvalve.recording import Recording, Valve

FRICTION, LEAK, BAND = (
    next(e for e in CATALOGUE if e.key == key) for key in ("friction", "seat_leakage", "positioner_deadband")
)


def prepared(effect, strength, n_samples):
    made = make_valve_recording(
        effect, strength, loop="wide", onset=0.0, n_samples=n_samples, n_later=0, random_state=5
    )
    return prepared_problem(Recording.from_frame(made.frame, Valve.from_dict(made.valve)))


@pytest.fixture(scope="module")
def banded():
    """A problem, calibrated, of a valve whose positioner has a dead band."""
    return calibrated(prepared("positioner_deadband", 0.025, 1500))


def begun(problem, nominal, size):
    return problem.simulate((Term(FRICTION),), nominal.values | {"friction.friction": size})


def test_fits_from_two_starts_end_apart_and_samples_bring_them_together(banded):
    problem, nominal = banded
    plain = [problem.fit((Term(FRICTION),), start=begun(problem, nominal, size)) for size in (0.02, 0.08)]
    met = [sampled_fit(problem, model) for model in plain]
    likelihoods, sampled = ([m.log_likelihood for m in models] for models in (plain, met))
    assert abs(likelihoods[0] - likelihoods[1]) > 20.0
    assert min(sampled) >= max(likelihoods)
    assert abs(sampled[0] - sampled[1]) < 5.0


def test_an_effect_on_the_flow_alone_is_not_sampled(banded):
    problem, nominal = banded
    model = problem.fit((Term(LEAK),), start=nominal)
    assert sampled_fit(problem, model) is model


def test_a_stem_that_is_not_simulated_is_not_sampled():
    made = make_valve_recording("seat_leakage", 0.02, loop="wide", n_samples=600, n_later=0, random_state=5)
    frame = made.frame.drop(columns=[c for c in made.frame if c.startswith("command")])
    problem, nominal = calibrated(prepared_problem(Recording.from_frame(frame, Valve.from_dict(made.valve))))
    assert sampled_fit(problem, nominal) is nominal


def test_a_calibration_that_only_its_old_noise_prefers_is_left(monkeypatch):
    problem, nominal = calibrated(prepared(None, None, 600))
    # far off, and made out to be likelier: by the noise that it leaves it is not
    far = problem.simulate((), nominal.values | {"actuator_delay": 2.0, "actuator_gain": 1.0})
    worse = replace(far, log_likelihood=nominal.log_likelihood + 1.0)
    monkeypatch.setattr(calibrating, "sampled_fit", lambda problem, model: worse)
    monkeypatch.setattr(type(problem), "fit", lambda problem, terms, *, start, **_: problem.judged(start))
    kept, model = calibrating._likelier_from_samples(problem, nominal)
    assert model is nominal
    assert kept is problem
    # nor does what was learnt for the trial come up later
    assert problem.with_noise_of(nominal, cautious=True).noise["opening"] is problem.noise["opening"]


def test_beside_a_history_a_fit_ends_in_one_place_wherever_it_began():
    history = ValveHistory().fit([prepared(None, None, 900).recording])
    recording = prepared("positioner_deadband", 0.025, 900).recording
    problem, nominal = calibrated(prepared_problem(recording, history=history))
    gain = nominal.values["actuator_gain"]
    begun_with = [
        nominal.values | {"positioner_deadband.half_width": 0.002, "actuator_gain": gain * times}
        for times in (0.3, 1.0, 3.0)
    ]
    terms = (Term(BAND),)
    plain = [problem.fit(terms, start=problem.simulate(terms, values)) for values in begun_with]
    met = [sampled_fit(problem, model) for model in plain]
    likelihoods, sampled = ([m.log_likelihood for m in models] for models in (plain, met))
    assert max(likelihoods) - min(likelihoods) > 5.0
    assert max(sampled) - min(sampled) < 1.0
    assert min(sampled) > max(likelihoods)
