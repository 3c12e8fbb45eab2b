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
from sklvalve.mismatch.inference.hypothesis import Model, Term, penalised_likelihood
from sklvalve.mismatch.inference.posterior import posterior

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem


def fitted_with_its_noise(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """Noise and hypothesis fitted in turn, twice.

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
    for _ in range(2):
        problem = problem.with_noise_of(model)
        model = problem.fit(model.terms, start=model)
    return problem, model


def likelihood_across_noises(problem: Problem, model: Model) -> float:
    """Log likelihood, comparable between noises: wide noise costs what it makes likelier."""
    return model.log_likelihood - sum(problem.noise[c].log_spread for c in problem.channels)


def penalised_across_noises(problem: Problem, model: Model) -> float:
    """As `penalised_likelihood`, but comparable between noises."""
    return penalised_likelihood(problem, model) - sum(problem.noise[c].log_spread for c in problem.channels)


def explains_as_much(problem: Problem, simple: Model, full: Model, term: Term) -> bool:
    """Whether a hypothesis is in one class with another that has one effect more.

    An equation gets a share of its effect wrong, and what it gets wrong is no effect of its own. So the two
    are weighed as rivals are, by the temperature of what the simple one explains in the same signals.

    Parameters
    ----------
    problem : Problem
    simple, full : Model
    term : Term
        What the other has more.

    Returns
    -------
    as_much : bool
    """
    here = set(problem.channels_touched(term.effect))
    elsewhere = [m for m in simple.terms if not here & set(problem.channels_touched(m.effect))]
    bare, less, more = (
        penalised_across_noises(*fitted_with_its_noise(problem, m))
        for m in (problem.fit(elsewhere, start=simple), simple, full)
    )
    return bool(posterior(np.array([less, more]), less - bare)[0] > 1.0 - IN_CLASS)
