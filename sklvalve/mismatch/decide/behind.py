# SPDX-License-Identifier: BSD-3-Clause
"""What lies behind a property: the search begins anew from a simulation that holds it.

A slow motor, or a dead time, is the largest thing that a simulation without it leaves out, and hides the
rest: fitted alone it bends to make up for play, and what is named beside it must be ten times as rare. But a
property is part of the sound valve. So it joins the calibration, as if it had been declared, and what is
behind it is searched and judged as a first finding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from sklvalve.mismatch.constants import HELD_OUT_ERRORS
from sklvalve.mismatch.decide.compare import HeldOut
from sklvalve.mismatch.decide.detect import leaves_much, p_value_of_one
from sklvalve.mismatch.inference.hypothesis import Term, is_in
from sklvalve.mismatch.proof.held_out import cross_validated
from sklvalve.mismatch.search.own_noise import fitted_with_its_noise
from sklvalve.mismatch.search.rivals import class_of, find_rivals

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.decide.null_reference import Covariates
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.explain import Explanation

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
    of_all = covariates
    behind: Judgement | None = None
    for _ in range(_MOST):
        held = _property_in_front(explanation, covariates, alpha)
        if held is None:
            break
        holding = explanation.problem.holding((held,), _alone(explanation, held)[1])
        left = [e for e in effects if not is_in(e, holding.held)]
        explanation, covariates, judged_beside = judge_on(holding, left)
        if judged_beside.verdict == "named":
            behind = judged_beside
    return judged if behind is None else _joined(judged, behind, effects, of_all)


def _property_in_front(explanation: Explanation, covariates: Covariates, alpha: float) -> Term | None:
    """The strongest thing found, where a sheet might have declared it and chance makes none as strong."""
    problem = explanation.problem
    if not explanation.findings:
        return None
    finding = explanation.findings[0]
    term = next(iter(class_of(finding).values()))[1]
    declared = [bool(m.effect.declared_as) for _, m, _ in class_of(finding).values()]
    late = term.onset is not None
    if not any(declared) or late or term.effect.kind_of(problem.plain, late) == "fault":
        return None
    return term if p_value_of_one(finding, problem, covariates) <= alpha else None


def _alone(explanation: Explanation, term: Term) -> tuple[Problem, Model]:
    """A property fitted without what else was found, that may have bent it, by the noise that it leaves."""
    return fitted_with_its_noise(
        explanation.problem, explanation.problem.fit((term,), start=explanation.nominal)
    )


def _joined(
    judged: Judgement, judged_beside: Judgement, effects: Sequence[Effect], covariates: Covariates
) -> Judgement:
    """What was found behind properties that the problem of `judged_beside` holds, and those beside it."""
    added = tuple(m for m in judged_beside.problem.held if m not in judged.problem.held)
    problem = judged.problem.with_noise(judged_beside.problem.noise)
    with_added: dict[Model, Model] = {}

    def whole(model: Model) -> Model:
        if model not in with_added:
            with_added[model] = replace(model, terms=(*added, *model.terms))
        return with_added[model]

    model = whole(cast("Model", judged_beside.model))
    # what is named anew must predict better than what was judged without it, not than nothing alone
    gain, error = HeldOut(problem, judged.model).gain(model)
    if not (gain >= HELD_OUT_ERRORS * error):
        return judged
    # a property is named by the same right as what lies behind it: where its own signals are explained
    if leaves_much(covariates, problem, model, problem.touched_by(added)):
        return judged
    behind = [
        replace(f, rivals=[replace(r, model=whole(r.model)) for r in f.rivals])
        for f in judged_beside.findings
    ]
    # by one noise and one calibration, as its rivals are
    as_rivals = problem.fit(model.terms, start=model)
    properties = find_rivals(problem, as_rivals, effects, None, of=added)
    return replace(
        judged_beside,
        problem=problem,
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
