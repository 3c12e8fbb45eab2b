# SPDX-License-Identifier: BSD-3-Clause
"""What else could stand in the place of an effect that was found, and how far from it that is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import DETECTABLE
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import Model, Term, is_in
from sklvalve.mismatch.inference.posterior import distance, posterior, smallest_class
from sklvalve.mismatch.inference.sampled import sampled_fit
from sklvalve.mismatch.search.onset import penalty_with_times
from sklvalve.mismatch.search.onset_sample import to_the_sample
from sklvalve.mismatch.search.own_noise import fitted_with_its_noise, likelihood_across_noises
from sklvalve.mismatch.search.relevance import may_be_instead
from sklvalve.mismatch.search.scatter import OverTime
from sklvalve.mismatch.search.screening import screened
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# rivals at a smaller distance by the common noise are judged by their own, too
_IN_REACH = 60.0


@dataclass(frozen=True, eq=False)
class Rival:
    """An explanation in the place of a finding.

    Attributes
    ----------
    term : Term
    model : Model
        The hypothesis with it in place.
    probability : float
    distance : float
        Profile-likelihood distance D from the best.
    gain : float
        Log likelihood that it gains on nothing in its place, each by the noise that it leaves.
    """

    term: Term
    model: Model
    probability: float
    distance: float
    gain: float = 0.0


@dataclass(frozen=True, eq=False)
class Finding:
    """One thing found: an effect, and those the recording cannot tell from it.

    Attributes
    ----------
    term : Term
        The most likely explanation.
    rivals : list of Rival
        Explanations in its place, its own among them, the most probable first.
    gain : float
        Log likelihood that the explanation adds to the rest of the hypothesis.
    sizes : dict
        Channel -> change that it makes, share of span [1].
    by_beginning : float or None, default=None
        Of one that begins within the recording: log likelihood that it gains over the likeliest effect that
        acts throughout. None of one that acts throughout, and where it was not asked.
    over_time : OverTime
        How the stretches of the recording agree on it.
    """

    term: Term
    rivals: list[Rival]
    gain: float
    sizes: dict[str, float]
    by_beginning: float | None = None
    over_time: OverTime = field(default_factory=OverTime)

    @property
    def stage(self) -> str:
        """Stage of its effect."""
        return self.term.effect.stage


def find_rivals(
    problem: Problem,
    model: Model,
    effects: Sequence[Effect],
    report: Callable[[float], object] | None,
    of: Sequence[Term] | None = None,
    met: Sequence[Model] = (),
) -> list[Finding]:
    """For each effect found, what else could stand in its place.

    Parameters
    ----------
    problem : Problem
    model : Model
    effects : sequence of Effect
    report : callable or None
    of : sequence of Term, default=None
        Those of the hypothesis that are asked; all unless given.
    met : sequence of Model, default=()
        Hypotheses settled on the way: the last effect of one may act at other times than the one found.

    Returns
    -------
    findings : list of Finding
        The strongest first.
    """
    findings = []
    for i, term in enumerate(model.terms if of is None else of):
        other_terms = tuple(m for m in model.terms if m is not term)
        without = problem.fit(other_terms, start=model)
        others = [e for e in effects if e.key != term.effect.key and not is_in(e, other_terms)]
        others = [e for e in others if _touch_the_same(problem, e, term.effect)]
        places = [(term, model)]
        instead = _others_in_place(problem, model, other_terms, without, others, term)
        instead += _at_other_times(problem, other_terms, without, others, term, met)
        places += [(place, fitted) for place, fitted in instead if may_be_instead(problem, fitted, without)]
        gain = model.log_likelihood - without.log_likelihood
        rivals = weighed(problem, places, without)
        sizes = problem.change(model, problem.baseline(model, other_terms, without))
        over_time = OverTime.of(problem, model, without)
        findings.append(Finding(term, rivals, gain, sizes, over_time=over_time))
        if report:
            report(0.8 + 0.2 * (i + 1) / len(model.terms))
    return sorted(findings, key=lambda f: f.gain, reverse=True)


def without_rival(problem: Problem, finding: Finding, model: Model, rejected: Model) -> Finding:
    """A finding without one of its rivals, the others weighed anew.

    Parameters
    ----------
    problem : Problem
    finding : Finding
    model : Model
        The hypothesis that stands.
    rejected : Model
        That of the rival.
    """
    left = [(r.term, r.model) for r in finding.rivals if r.model is not rejected]
    if len(left) == len(finding.rivals):
        return finding
    other_terms = tuple(m for m in model.terms if m is not finding.term)
    return replace(finding, rivals=weighed(problem, left, problem.fit(other_terms, start=model)))


def _others_in_place(
    problem: Problem,
    model: Model,
    other_terms: tuple[Term, ...],
    without: Model,
    others: Sequence[Effect],
    term: Term,
) -> list[tuple[Term, Model]]:
    """Other effects in the place of one, each from the best of two calibrations, as (Term, Model)."""
    # that of the explanation in place, and that without it, which may have bent to make up for what it lacks
    bare = problem.judged(problem.simulate(other_terms, model.values))
    rough: dict[str, Model] = {}
    for base in (bare, without):
        _keep_the_best(rough, screened(problem, base, others, onset=term.times, always=others))
    # no race: a class is to hold all that cannot be told apart, and what is screened ends in poor valleys
    best: dict[str, Model] = {}
    _keep_the_best(best, parallel_map(lambda m: problem.fit(m.terms, start=m), list(rough.values())))
    # the samples are the same whatever a fit began from: each effect is sampled once
    gain = model.log_likelihood - without.log_likelihood
    near = [m for m in best.values() if distance(model.log_likelihood, m.log_likelihood, gain) < DETECTABLE]
    _keep_the_best(best, parallel_map(lambda m: to_the_sample(problem, sampled_fit(problem, m)), near))
    return [(m.terms[-1], m) for m in best.values()]


def _at_other_times(
    problem: Problem,
    other_terms: tuple[Term, ...],
    without: Model,
    effects: Sequence[Effect],
    term: Term,
    met: Sequence[Model],
) -> list[tuple[Term, Model]]:
    """Effects in the place of one, throughout where it begins and begun where it acts throughout.

    Screened are those that begin when it does. But a drift throughout and a step within look alike.
    """
    keys = {effect.key for effect in effects}
    # one of each effect: the price of its times has summed over those near it already
    best: dict[str, Model] = {}
    for m in met:
        other = m.terms[-1]
        if other.effect.key in keys and (other.onset is None) != (term.onset is None):
            start = replace(m, values=without.values | m.values)
            _keep_the_best(best, [problem.fit((*other_terms, other), start=start)])
    return [(m.terms[-1], m) for m in best.values()]


def _keep_the_best(best: dict[str, Model], models: Iterable[Model]) -> None:
    for m in models:
        before = best.get(m.terms[-1].effect.key)
        if before is None or m.log_likelihood > before.log_likelihood:
            best[m.terms[-1].effect.key] = m


def weighed(
    problem: Problem,
    places: Sequence[tuple[Term, Model]],
    without: Model,
    gains: Sequence[float] | None = None,
) -> list[Rival]:
    """Explanations in one place, with distances from the best and probabilities, the most probable first.

    Parameters
    ----------
    problem : Problem
    places : list of (Term, Model)
    without : Model
        The hypothesis without any of them.
    gains : sequence of float, default=None
        Log likelihood that each gains on that; by the noise that each leaves unless given.
    """
    if gains is None:
        gains = _gains_by_their_noise(problem, [fitted for _, fitted in places], without)
    best = max(gains)
    prices = [penalty_with_times(problem, fitted, term) for term, fitted in places]
    probabilities = posterior(np.array(gains) - np.array(prices), best)
    rivals = [
        Rival(term, fitted, float(probability), distance(best, gain, best), gain)
        for (term, fitted), probability, gain in zip(places, probabilities, gains, strict=True)
    ]
    return sorted(rivals, key=lambda r: r.probability, reverse=True)


def _gains_by_their_noise(problem: Problem, fits: Sequence[Model], without: Model) -> list[float]:
    """Log likelihood that each gains on nothing in its place, every one by the noise that it leaves.

    What is far behind by the common noise stays as far behind.
    """
    likelihoods = [m.log_likelihood for m in fits]
    top = max(likelihoods)
    near = [distance(top, likelihood, top - without.log_likelihood) < _IN_REACH for likelihood in likelihoods]
    asked = [without, *(m for m, asks in zip(fits, near, strict=True) if asks)]
    bare, *each = parallel_map(lambda m: likelihood_across_noises(*fitted_with_its_noise(problem, m)), asked)
    left, best = iter(each), max(each)
    return [
        (next(left) if asks else best - (top - likelihood)) - bare
        for asks, likelihood in zip(near, likelihoods, strict=True)
    ]


def _touch_the_same(problem: Problem, effect: Effect, other: Effect) -> bool:
    return bool(set(problem.channels_touched(effect)) & set(problem.channels_touched(other)))


def leading_term(finding: Finding) -> Term:
    """The most probable member of the class of a finding, which gives it its name."""
    return next(iter(class_of(finding).values()))[1]


def class_of(finding: Finding) -> dict[str, tuple[float, Term, Model]]:
    """Members of the smallest class that most likely holds the truth: name -> (probability, Term, Model).

    Forms of one effect are one name, with the most probable form's member and model.
    """
    likeliest: dict[str, Rival] = {}
    for rival in sorted(finding.rivals, key=lambda r: -r.probability):
        likeliest.setdefault(rival.term.effect.name, rival)
    total = dict.fromkeys(likeliest, 0.0)
    for rival in finding.rivals:
        total[rival.term.effect.name] += rival.probability
    return {
        name: (probability, likeliest[name].term, likeliest[name].model)
        for name, probability in smallest_class(total).items()
    }
