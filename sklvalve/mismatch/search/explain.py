# SPDX-License-Identifier: BSD-3-Clause
"""Which physics: effects taken up one by one, each fitted together with the calibration, and their rivals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sklvalve.mismatch.search.relevance import may_explain
from sklvalve.mismatch.search.rivals import find_rivals, without_rival
from sklvalve.mismatch.search.settling import settled_fit
from sklvalve.mismatch.search.taking_up import LeavesMuch, Search, Tried, drop_what_no_longer_counts

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.extended import Report
    from sklvalve.mismatch.search.rivals import Finding

# a rival so many times as probable takes the place of an effect
_CLEARLY = 30.0


@dataclass(eq=False)
class Explanation:
    """Result of the search.

    Attributes
    ----------
    problem : Problem
        Judged by the final noise.
    nominal : Model
        The calibrated simulation without further effects, under the final noise.
    model : Model
        With the effects taken up.
    findings : list of Finding
    tried : dict
        Effect key -> its best single fit as `Tried`, at the first step.
    effects : tuple of Effect
        The candidates.
    acting : dict
        Effect key -> what it would gain as the first one that acts throughout, whether or not it fits better
        with a beginning: of the stem's effects beyond tolerance the likeliest, and of the others.
    """

    problem: Problem
    nominal: Model
    model: Model
    findings: list[Finding]
    tried: dict[str, Tried] = field(default_factory=dict)
    effects: tuple[Effect, ...] = ()
    acting: dict[str, Tried] = field(default_factory=dict)


def explain(
    problem: Problem,
    nominal: Model,
    effects: Sequence[Effect],
    *,
    threshold: float,
    most: int = 4,
    hidden: Sequence[Effect] = (),
    report: Report | None = None,
    leaves_much: LeavesMuch | None = None,
) -> Explanation:
    """Search of the effects that the recording asks for.

    Parameters
    ----------
    problem : Problem
        With its noise learnt from `nominal`.
    nominal : Model
        The calibrated simulation.
    effects : sequence of Effect
        Candidates.
    threshold : float
        Log likelihood that an effect must add beyond its price.
    most : int, default=4
        Largest number of effects.
    hidden : sequence of Effect, default=()
        No candidates, for data that hide them, but what is found may be one of them.
    report : callable, default=None
        Called with the share done.
    leaves_much : callable, default=None
        Called as ``leaves_much(problem, model, channels)``: whether a hypothesis leaves over more than a
        healthy valve does beside its history; never unless given.

    Returns
    -------
    explanation : Explanation
    """
    search = Search(effects, threshold, most, report, leaves_much)
    problem, model = search.taken_up(problem, nominal)
    for last in (False, False, True):
        problem, model = _what_stands(problem, model, threshold)
        findings = find_rivals(problem, model, (*effects, *hidden), report, met=search.met)
        better = _better_in_place(problem, findings)
        if better is None or last:
            break
        by_its_noise, stood = _what_stands(*settled_fit(problem, better), threshold)
        if len(stood.terms) < len(better.terms):
            # by its own noise it explains too little to be anything at all
            findings = [without_rival(problem, f, model, better) for f in findings]
            break
        problem = by_its_noise.with_noise_of(stood, cautious=True)
        stood = problem.fit(stood.terms, start=stood)
        problem, model = search.taken_up(problem, stood)
    nominal = problem.fit((), start=search.nominal or nominal)
    if not model.terms:
        # one hypothesis, wherever its fit was begun
        nominal = model = max(nominal, model, key=lambda m: m.log_likelihood)
    findings = [search.with_its_beginning(problem, f, model, f.term) for f in findings]
    return Explanation(problem, nominal, model, findings, search.tried, tuple(effects), search.acting)


def _what_stands(problem: Problem, model: Model, threshold: float) -> tuple[Problem, Model]:
    """What remains of a hypothesis that is judged by the noise it leaves."""
    problem = problem.with_noise_of(model)
    model = problem.fit(model.terms, start=model)
    return problem, drop_what_no_longer_counts(problem, model, threshold, last_too=True)


def _better_in_place(problem: Problem, findings: Sequence[Finding]) -> Model | None:
    """A hypothesis with a rival in the place of an effect, where the recording prefers it; else None."""
    for finding in findings:
        best = next(r for r in finding.rivals if r.term is finding.term)
        for rival in finding.rivals:
            # of two that cannot be told apart either may stand in front: no reason to fit all again
            same = rival.term.effect.name == finding.term.effect.name
            if same or rival.probability <= _CLEARLY * best.probability:
                break
            without = problem.fit(rival.model.terms[:-1], start=rival.model)
            if may_explain(problem, rival.model, without):
                return rival.model
    return None
