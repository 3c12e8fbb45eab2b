# SPDX-License-Identifier: BSD-3-Clause
"""A hypothesis and the noise it leaves, fitted in turn; throughout or in spells where that is likelier."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.inference.sampled import sampled_fit
from sklvalve.mismatch.search.intermittent import intermittent
from sklvalve.mismatch.search.onset import fit_with_onset
from sklvalve.mismatch.search.own_noise import fitted_with_its_noise, penalised_across_noises
from sklvalve.mismatch.search.relevance import SPREADS
from sklvalve.mismatch.search.scatter import gain_in_spreads

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem


def settled_fit(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """Noise and hypothesis fitted in turn: what the new effect explains is no longer noise."""
    problem, model = fitted_with_its_noise(problem, sampled_fit(problem, model))
    last = model.terms[-1]
    if last.onset is not None:
        # begun where the hypothesis stands: without the effect the calibration may lie in another valley
        without = replace(problem.fit(model.terms[:-1], start=model), values=model.values)
        begun = fit_with_onset(problem, without, last.effect, onset=last.onset, max_steps=15)
        model = max(model, begun, key=lambda m: m.log_likelihood)
        problem, model = _throughout_if_likelier(problem, model)
    return _intermittent_if_likelier(problem, model)


def _intermittent_if_likelier(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """The same effect in spells where that is likelier, each judged by its own noise."""
    spelled = intermittent(problem, model)
    if spelled is model:
        return problem, model
    by_its_noise, spelled = fitted_with_its_noise(problem, spelled)
    if penalised_across_noises(by_its_noise, spelled) > penalised_across_noises(problem, model):
        return by_its_noise, spelled
    return problem, model


def _throughout_if_likelier(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """The same effect without its onset, where that is likelier when each is judged by its own noise.

    Under the noise of a simulation that lacks the effect, an onset may hide rows in which the effect is
    modelled poorly: what is left there is no stranger than the nominal's own errors. So an onset that gains
    little beside the effect itself must gain in more than one or two events.
    """
    *others, last = model.terms
    by_its_noise, throughout = fitted_with_its_noise(
        problem, problem.fit((*others, Term(last.effect)), start=model)
    )
    gained = penalised_across_noises(problem, model) - penalised_across_noises(by_its_noise, throughout)
    if gained < 0.0:
        return by_its_noise, throughout
    bare = problem.fit(others, start=model)
    little = gained < SHARE_WRONG * (model.log_likelihood - bare.log_likelihood)
    if little and gain_in_spreads(problem, model, problem.judged(throughout)) < SPREADS:
        return by_its_noise, throughout
    return problem, model
