# SPDX-License-Identifier: BSD-3-Clause
"""What lies behind a property: the search begins anew from a simulation that holds it.

A slow motor, or a dead time, is the largest thing that a simulation without it leaves out, and hides the
rest: fitted alone it bends to make up for play, and what is named beside it must be as rare as alpha twice
over. But a property is part of the sound valve. So it joins the calibration, as if it had been declared, and
what is behind it is searched and judged as a first finding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from sklvalve.mismatch.decide.compare import HeldOut
from sklvalve.mismatch.decide.constants import HELD_OUT_ERRORS
from sklvalve.mismatch.detect import p_value_of_one
from sklvalve.mismatch.explain import penalised_across_noises
from sklvalve.mismatch.hypothesis import Term, is_in
from sklvalve.mismatch.prove import cross_validated, holds_out
from sklvalve.mismatch.relevance import may_explain
from sklvalve.mismatch.rivals import Finding, find_rivals
from sklvalve.mismatch.verdict import class_of

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.explain import Explanation
    from sklvalve.mismatch.hypothesis import Model
    from sklvalve.mismatch.judgement import Judgement
    from sklvalve.mismatch.null_reference import Covariates
    from sklvalve.mismatch.problem import Problem

# so many properties may lie one behind the other
_MOST = 2


def judged_behind(
    problem: Problem,
    effects: Sequence[Effect],
    judge_on: Callable[[Problem, Sequence[Effect]], tuple[Explanation, Covariates, Judgement]],
    alpha: float,
) -> Judgement:
    """Judgement of a recording, with what lies behind the actuator's properties where that is named.

    Parameters
    ----------
    problem : Problem
    effects : sequence of Effect
        Candidates.
    judge_on : callable
        ``judge_on(problem, effects)`` calibrates, searches and judges; it gives the explanation, the
        covariates and the judgement.
    alpha : float
        Level of the test.

    Returns
    -------
    judged : Judgement
    """
    explanation, covariates, judged = judge_on(problem, effects)
    holding: Problem = problem
    behind: tuple[Problem, Judgement, dict[str, Any]] | None = None
    for _ in range(_MOST):
        held = _property_in_front(holding, explanation, covariates, alpha)
        if held is None and holding is problem:
            held = _likelier_alone(holding, explanation, effects, covariates, alpha)
        if held is None:
            break
        holding = holding.holding((held,), _alone(holding, held, explanation.nominal))
        left = [e for e in effects if not is_in(e, holding.held)]
        explanation, covariates, judged_beside = judge_on(holding, left)
        if judged_beside.verdict == "named":
            behind = holding, judged_beside, holding.noise
    return judged if behind is None else _joined(problem, judged, effects, *behind)


def _property_in_front(
    problem: Problem, explanation: Explanation, covariates: Covariates, alpha: float
) -> Term | None:
    """The strongest thing found, where a sheet might have declared it and chance makes none as strong."""
    if not explanation.findings:
        return None
    finding = explanation.findings[0]
    term = next(iter(class_of(finding).values()))[1]
    declared = [bool(m.effect.declared_as) for _, m, _ in class_of(finding).values()]
    late = term.onset is not None
    if not any(declared) or late or term.effect.kind_of(problem.plain, late) == "fault":
        return None
    return term if p_value_of_one(finding, problem, covariates) <= alpha else None


def _likelier_alone(
    problem: Problem,
    explanation: Explanation,
    effects: Sequence[Effect],
    covariates: Covariates,
    alpha: float,
) -> Term | None:
    """A property that by itself explains more than the strongest finding does; else None.

    The search takes up first what gains most under the noise that the nominal simulation leaves, which hides
    how much more the property explains.
    """
    if not explanation.findings:
        return None
    front, nominal, noise = explanation.findings[0].term, explanation.nominal, problem.noise
    touched = set(problem.channels_touched(front.effect))
    best, likeliest = None, penalised_across_noises(problem, _alone(problem, front, nominal, keep=True))
    for effect in effects:
        if not effect.declared_as or not touched & set(problem.channels_touched(effect)):
            continue
        model = _alone(problem, Term(effect), nominal, keep=True)
        without = problem.fit((), start=nominal)
        gain = model.log_likelihood - without.log_likelihood
        finding = Finding(model.terms[0], [], gain, problem.change(model, without))
        rare = p_value_of_one(finding, problem, covariates) <= alpha
        if (
            rare
            and may_explain(problem, model, without)
            and penalised_across_noises(problem, model) > likeliest
        ):
            best, likeliest = model.terms[0], penalised_across_noises(problem, model)
    problem.use_noise(noise)
    return best


def _alone(problem: Problem, term: Term, nominal: Model, *, keep: bool = False) -> Model:
    """A property fitted without what else was found, that may have bent it; `keep` its own noise."""
    noise, model = problem.noise, problem.fit((term,), start=nominal)
    for _ in range(2):
        problem.learn_noise(model)
        model = problem.fit((term,), start=model)
    if not keep:
        problem.use_noise(noise)
    return model


def _joined(
    problem: Problem,
    judged: Judgement,
    effects: Sequence[Effect],
    holding: Problem,
    judged_beside: Judgement,
    noise: dict[str, Any],
) -> Judgement:
    """What was found behind the properties that the problem `holding` holds, and those beside it."""
    added = tuple(m for m in holding.held if m not in problem.held)
    before = problem.noise
    problem.use_noise(noise)
    with_added: dict[Model, Model] = {}

    def whole(model: Model) -> Model:
        if model not in with_added:
            with_added[model] = replace(model, terms=(*added, *model.terms))
        return with_added[model]

    model = whole(cast("Model", judged_beside.model))
    # what is named anew must predict better than what was judged without it, not than nothing alone
    gain, error = HeldOut(problem, judged.model).gain(model)
    if not (gain >= HELD_OUT_ERRORS * error and holds_out(problem, judged.nominal, model)):
        problem.use_noise(before)
        return judged
    behind = [
        replace(f, rivals=[replace(r, model=whole(r.model)) for r in f.rivals])
        for f in judged_beside.findings
    ]
    properties = find_rivals(problem, model, effects, None, of=added)
    return replace(
        judged_beside,
        p_value=min(p for p in (judged.p_value, judged_beside.p_value) if p is not None),
        findings=sorted([*behind, *properties], key=lambda f: f.gain, reverse=True),
        nominal=judged.nominal,
        model=model,
        evidence=judged.evidence,
        comparison=judged_beside.comparison.behind(judged.comparison),
        tried=None
        if judged_beside.unknown is None
        else cross_validated(problem, model, judged_beside.unknown),
    )
