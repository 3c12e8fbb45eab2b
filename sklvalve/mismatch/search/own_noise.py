# SPDX-License-Identifier: BSD-3-Clause
"""Hypotheses each judged by the noise that they leave themselves.

What one hypothesis gets wrong, the noise fitted to it takes up. Under that noise all rivals gain little, and
the one that stands looks as good as the true one. So noise is a parameter of every hypothesis, fitted with
it, and wide noise costs what it makes likelier.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import IN_CLASS
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.inference.posterior import posterior
from sklvalve.mismatch.search.onset import penalty_with_times

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem


def fitted_with_its_noise(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """Noise and hypothesis fitted in turn, twice, and the likeliest met of them.

    The fit of a noise may end in a valley of its own. So a hypothesis is never less likely than by the noise
    that it came with, and one with an effect more never for its noise less likely than one without.

    Parameters
    ----------
    problem : Problem
    model : Model
        Where the fits begin.

    Returns
    -------
    problem : Problem
        Judged by the noise that the hypothesis leaves.
    model : Model
    """
    met = [(problem, problem.judged(model))]
    for _ in range(2):
        problem = problem.with_noise_of(model)
        model = problem.fit(model.terms, start=model)
        met.append((problem, model))
    return max(met, key=lambda one: penalised_across_noises(*one))


def likelihood_across_noises(problem: Problem, model: Model) -> float:
    """Log likelihood, comparable between noises: wide noise costs what it makes likelier."""
    return model.log_likelihood - _cost_of_noise(problem)


def penalised_across_noises(problem: Problem, model: Model) -> float:
    """Log likelihood less the price of the effects, their times summed over, comparable between noises."""
    penalties = sum(penalty_with_times(problem, model, term) for term in model.terms)
    return likelihood_across_noises(problem, model) - penalties


def penalised_by_its_noise(problem: Problem, model: Model) -> float:
    """As `penalised_across_noises`, by the noise that the hypothesis leaves."""
    return penalised_across_noises(*fitted_with_its_noise(problem, model))


def explains_as_much(problem: Problem, simple: Model, term: Term, of_simple: float, of_other: float) -> bool:
    """Whether a hypothesis is in one class with another that has one effect more.

    An equation gets a share of its effect wrong, and what it gets wrong is no effect of its own. So the two
    are weighed as rivals are, by the temperature of what the simple one explains in the same signals.

    Parameters
    ----------
    problem : Problem
    simple : Model
    term : Term
        What the other has more.
    of_simple, of_other : float
        Of this one and of the other, `penalised_by_its_noise`.

    Returns
    -------
    as_much : bool
    """
    here = problem.touched_by([term])
    elsewhere = [m for m in simple.terms if not here & problem.touched_by([m])]
    bare = penalised_by_its_noise(problem, problem.fit(elsewhere, start=simple))
    return bool(posterior(np.array([of_simple, of_other]), of_simple - bare)[0] > 1.0 - IN_CLASS)


def _cost_of_noise(problem: Problem) -> float:
    return float(sum(problem.noise[c].log_spread for c in problem.channels))
