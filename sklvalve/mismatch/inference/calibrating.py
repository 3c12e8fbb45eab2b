# SPDX-License-Identifier: BSD-3-Clause
"""The nominal simulation, calibrated, and the noise that it leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.inference.sampled import sampled_fit
from sklvalve.simulation.first_values import first_values

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem


def calibrated(problem: Problem) -> tuple[Problem, Model]:
    """The simulation without any further effect, calibrated from several starts, and its noise.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    problem : Problem
        It knows the noise, and the values of a sound actuator.
    nominal : Model
    """
    guess, sound = first_guess(problem)
    problem = problem.with_sound_values(sound)
    hold = "actuator_" if guess.values and not problem.coupled else None
    model = problem.fit((), start=guess, hold=hold)
    for _ in range(2):
        problem = problem.with_noise_of(model, cautious=True, anew=problem.channels)
        other = _from_sound(problem, model)
        model = problem.fit((), start=model)
        if other is not None and other.log_likelihood > model.log_likelihood:
            model = other
    return _likelier_from_samples(problem, model)


def _likelier_from_samples(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """The calibration from points sampled over the stem's parameters, if likelier by the noise it leaves."""
    other = sampled_fit(problem, model)
    if other is model:
        return problem, model
    by_its_noise = problem.beside().with_noise_of(other, cautious=True, anew=("opening",))
    other = by_its_noise.fit((), start=other)
    if _likelihood(by_its_noise, other) > _likelihood(problem, model):
        return by_its_noise, other
    return problem, model


def _likelihood(problem: Problem, model: Model) -> float:
    """Comparable between noises: wide noise costs what it makes likelier."""
    return model.log_likelihood - sum(problem.noise[c].log_spread for c in problem.channels)


def first_guess(problem: Problem) -> tuple[Model, dict[str, float]]:
    """Values to begin with, as a model of values alone, and those of a sound actuator.

    Parameters
    ----------
    problem : Problem
    """
    moves = "command" in problem.recording and not problem.coupled
    if problem.history is not None:
        known = expected_values(problem)
        sound = {name: value for name, value in known.items() if moves and name.startswith("actuator_")}
        return Model((), problem.plain, known | problem.held_values, {}, np.nan, {}), sound
    values, sound = first_values(
        problem.plain,
        problem.calibration(("opening",)) if moves else (),
        flow="flow" in problem.channels,
        begin=problem.held_values,
        rows=problem.rows,
    )
    return Model((), problem.plain, values, {}, np.nan, {}), sound


def expected_values(problem: Problem) -> dict[str, float]:
    """Values of the calibration as the data sheet, or the valve's history, expects them."""
    return {p.name: p.start for p in problem.calibration(problem.channels)}


def _from_sound(problem: Problem, model: Model) -> Model | None:
    """The calibration begun anew from a sound actuator, which may lie in another valley."""
    if not problem.sound_values:
        return None
    return problem.fit((), start=problem.sound(model))
