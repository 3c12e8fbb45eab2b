# SPDX-License-Identifier: BSD-3-Clause
"""Long recordings: searched on stretches spread over them, and what is found is fitted to every row."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.data.gathering import without_settling
from sklvalve.mismatch.decide.detect import mismatch_p_value
from sklvalve.mismatch.decide.judgement import Judgement, with_learnt
from sklvalve.mismatch.decide.rules import noise, without_pattern
from sklvalve.mismatch.effects import EVENTS
from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.residual.goodness_of_fit import imitates_any_time_profile, left_over
from sklvalve.mismatch.residual.pulses import find_pulses
from sklvalve.mismatch.residual.stem_residual import stem_residual
from sklvalve.mismatch.search.events import simulated
from sklvalve.mismatch.search.onset import best_onset
from sklvalve.mismatch.search.onset_sample import to_the_sample
from sklvalve.mismatch.search.own_noise import fitted_with_its_noise
from sklvalve.recording import Recording

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Finding, Rival

#: Rows of one stretch: long beside the slow wander of a meter, short beside a recording of a day.
STRETCH = 640


def stretches_of(recording: Recording, most: int | None) -> Recording:
    """Evenly spread stretches of a recording, one behind the other, each with the times of its own.

    Parameters
    ----------
    recording : Recording
    most : int or None
        Rows to keep, about.

    Returns
    -------
    stretches : Recording
        The recording itself where it has hardly more rows than `most`. Opening and flow are gaps in the
        first rows of each stretch, in which a simulation still has to forget where it comes from.
    """
    n = len(recording)
    if most is None or n <= 1.25 * most:
        return recording
    length = min(STRETCH, most)
    many = max(most // length, 2)
    starts = np.linspace(0, n - length, many).round().astype(int)
    place = (starts[:, None] + np.arange(length)).ravel()
    signals = {role: values[place] for role, values in recording.signals.items()}
    chosen = replace(recording, time=recording.time[place], stamps=recording.stamps[place], signals=signals)
    return without_settling(chosen, np.arange(many) * length)


def over_the_whole(problem: Problem, judged: Judgement, alpha: float) -> Judgement:
    """A judgement made on stretches, with its simulations fitted to every row.

    Names, classes, the test for any mismatch, and what differs beside a name stay those of the stretches;
    parameters, their intervals, onsets and what is learnt of an unknown effect's worth are of the whole. So
    is whether what was found leaves too much over to be named.

    Parameters
    ----------
    problem : Problem
        Of the whole recording.
    judged : Judgement
    alpha : float
        Level of the test.

    Returns
    -------
    judged : Judgement
    """
    if _leaves_too_much(judged):
        upheld = _fitted_to_all(problem, _before_the_rule(judged), alpha)
        left = left_over(upheld.problem, upheld.model, upheld.nominal)
        if left is not None and not left.too_much:
            return replace(upheld, rules=(*upheld.rules, noise(left.times, True)))
    return _fitted_to_all(problem, judged, alpha)


def _leaves_too_much(judged: Judgement) -> bool:
    """Whether what was found has no name for what it leaves over alone.

    At the beginning of a stretch nobody knows on which side play stands, and what that leaves over looks like
    missing physics. In all rows it does so once.
    """
    leaves = judged.closest_leaves
    if judged.findings or not judged.closest or leaves is None:
        return False
    return leaves.too_much and not imitates_any_time_profile(judged.closest)


def _before_the_rule(judged: Judgement) -> Judgement:
    """The judgement as it was before what is left over took the names."""
    first = judged.closest[0]
    model = next(r.model for r in first.rivals if r.term is first.term)
    return replace(
        judged,
        verdict="named",
        findings=judged.closest,
        # of the hypothesis of the search what stood, and no more
        model=replace(model, terms=tuple(finding.term for finding in judged.closest)),
        unknown=None,
        kept=False,
        errors=None,
        left=None,
        closest=[],
        closest_leaves=None,
        suspected=None,
        why=(),
    )


def _fitted_to_all(problem: Problem, judged: Judgement, alpha: float) -> Judgement:
    """A judgement made on stretches, with its simulations fitted to every row."""
    nominal, model = judged.nominal, judged.model
    nothing = model is nominal
    problem, model = _fitted(problem, simulated(model))
    nominal = problem.least_squares(model if nothing else problem.fit((), start=nominal))
    findings = [_finding(problem, f, _with_events(problem, model, judged.model)) for f in judged.findings]
    model = nominal if nothing else _with_events(problem, problem.least_squares(model), judged.model)
    # what comes closest and is not named is fitted no more than the rivals of what is
    closest = [replace(f, rivals=[_rival(problem, r) for r in f.rivals]) for f in judged.closest]
    judged = replace(
        judged, problem=problem, nominal=nominal, model=model, findings=findings, closest=closest
    )
    if judged.suspected is not None:
        near = judged.suspected
        judged = replace(judged, suspected=problem.simulate(near.terms, near.values))
    judged = _seen_in_the_whole(problem, judged, alpha)
    return with_learnt(judged)


def _seen_in_the_whole(problem: Problem, judged: Judgement, alpha: float) -> Judgement:
    """A judgement whose rows that speak for themselves are those of the whole; none if that shows none."""
    strays, pulses = judged.strays, judged.pulses
    if strays is None and pulses is None:
        return judged
    if strays is not None:
        strays = stem_residual(problem, judged.nominal)
        strays = strays if strays is not None and strays.evident else None
    if pulses is not None:
        pulses = find_pulses(problem, judged.nominal, alpha)
    judged = replace(judged, strays=strays, pulses=pulses)
    if strays is None and pulses is None and judged.evidence is not None:
        # seen in a few stretches and not in all rows: what else there was decides, as it did before
        asked = without_pattern(judged.rules)
        p_value = mismatch_p_value(judged.evidence)
        return replace(judged, verdict="no_mismatch", p_value=p_value, rules=asked)
    return judged


def _with_events(problem: Problem, model: Model, searched: Model) -> Model:
    """A hypothesis with the events that the search told, which change no simulation."""
    events = tuple(m for m in searched.terms if m.effect in EVENTS)
    if not events:
        return model
    prefixes = tuple(f"{m.effect.key}." for m in events)
    terms = (*events, *model.terms)
    return replace(
        model,
        terms=terms,
        chain=problem.chain(terms),
        values=model.values | {k: v for k, v in searched.values.items() if k.startswith(prefixes)},
        spreads=model.spreads | {k: v for k, v in searched.spreads.items() if k.startswith(prefixes)},
    )


def _fitted(problem: Problem, model: Model) -> tuple[Problem, Model]:
    """The problem with the noise that a hypothesis leaves in every row, and the hypothesis fitted to that."""
    # rows between a stretch and the onset that it suggested must not pass for noise
    fitted = _dated(problem, problem.simulate(model.terms, model.values))
    # the whole has no noise yet but a first guess, by which no likelihood is comparable
    problem, fitted = fitted_with_its_noise(problem.with_noise_of(fitted), fitted)
    for term in fitted.terms:
        if term.onset is not None and not term.effect.grows:
            others = tuple(m for m in fitted.terms if m is not term)
            fitted = to_the_sample(problem, problem.fit((*others, term), start=fitted))
    return problem, fitted


def _dated(problem: Problem, model: Model) -> Model:
    """A simulated hypothesis with the onsets that all rows tell; stretches leave hours between them."""
    for term in model.terms:
        if term.onset is None or term.effect.grows or term.switches:
            continue
        others = tuple(m for m in model.terms if m is not term)
        without = problem.simulate(others, model.values)
        throughout = problem.simulate((*others, replace(term, onset=None)), model.values)
        moved = replace(term, onset=best_onset(problem, without, throughout))
        model = problem.simulate((*others, moved), model.values)
    return model


def _finding(problem: Problem, finding: Finding, model: Model) -> Finding:
    """A finding with the parameters of the whole for the effect in place; its rivals stay, as simulated."""
    in_place = {m.effect.key: m for m in model.terms}[finding.term.effect.key]
    searched = next(r.model for r in finding.rivals if r.term.effect.key == in_place.effect.key)
    # all rows are many times those searched: of likelihoods only differences go with the others
    gain = model.log_likelihood - searched.log_likelihood
    rivals = [
        replace(r, term=in_place, model=model) if r.model is searched else _rival(problem, r, gain)
        for r in finding.rivals
    ]
    return replace(finding, term=in_place, rivals=rivals)


def with_every_row(problem: Problem, finding: Finding) -> Finding:
    """A finding of a part of the rows with its explanations simulated in every row, as they are."""
    rivals = [_rival(problem, r) for r in finding.rivals]
    return replace(finding, rivals=rivals)


def _rival(problem: Problem, rival: Rival, gain: float = 0.0) -> Rival:
    """A rival with every row simulated, its log likelihood larger by so much."""
    model = rival.model
    made = problem.simulate(model.terms, model.values)
    made = replace(made, log_likelihood=model.log_likelihood + gain, spreads=model.spreads)
    return replace(rival, model=made)
