# SPDX-License-Identifier: BSD-3-Clause
"""The nominal simulation, calibrated, and the noise that it leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sklvalve.mismatch.first_guess import first_guess

if TYPE_CHECKING:
    from sklvalve.mismatch.hypothesis import Model
    from sklvalve.mismatch.problem import Problem


def calibrated(problem: Problem) -> Model:
    """The simulation without any further effect, calibrated from several starts; the noise is learnt from it.

    Parameters
    ----------
    problem : Problem
        Afterwards it knows the noise, and the values of a sound actuator.

    Returns
    -------
    nominal : Model
    """
    guess, problem.sound_values = first_guess(problem)
    hold = "actuator_" if guess.values and not problem.coupled else None
    model = problem.fit((), start=guess, hold=hold)
    for _ in range(2):
        problem.learn_noise(model, cautious=True, anew=True)
        other = _from_sound(problem, model)
        model = problem.fit((), start=model)
        if other is not None and other.log_likelihood > model.log_likelihood:
            model = other
    return model


def _from_sound(problem: Problem, model: Model) -> Model | None:
    """The calibration begun anew from a sound actuator, which may lie in another valley."""
    if not problem.sound_values:
        return None
    return problem.fit((), start=problem.sound(model))
