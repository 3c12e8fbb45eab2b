# SPDX-License-Identifier: BSD-3-Clause
"""From the search to the judgement: what stands of the findings, and the model that goes with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.case import Case
from sklvalve.mismatch.decide.decision import by_evidence
from sklvalve.mismatch.decide.detect import (
    p_value_of_effects,
)
from sklvalve.mismatch.decide.judgement import Judgement, with_learnt
from sklvalve.mismatch.decide.reasons import too_much_left
from sklvalve.mismatch.decide.standing import Fit, elsewhere, fit_of, fitted_with, upheld
from sklvalve.mismatch.decide.weighing import Weighed, what_evidence_leaves
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.proof.held_out import cross_validated
from sklvalve.mismatch.residual.goodness_of_fit import FINE, REFUTED, LeftOver, held_against_noise, left_over
from sklvalve.mismatch.residual.pulses import find_pulses
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.residual.stem_residual import P_VALUE as STRAYS_BY_CHANCE
from sklvalve.mismatch.residual.stem_residual import stem_residual
from sklvalve.mismatch.search.events import P_VALUE, Events, beside_events, with_events
from sklvalve.mismatch.search.rivals import class_of

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.smooth_pattern import Pattern
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.mismatch.search.explain import Explanation
    from sklvalve.mismatch.search.rivals import Finding

# an effect that by itself gains this share of what the best one does tells where to look
_COMES_NEAR = 0.25


def judge(case: Case, events: Events | None = None) -> Judgement:
    """Verdict, what stands of the findings, and the model and the learnt residual that go with it.

    Slips of the stem that are evident, or its hunting, name what makes them where the search has not: then
    its findings in the actuator, which they explain, go, and so does what it left unexplained of the opening.

    Parameters
    ----------
    case : Case
    events : Events, default=None
        Those that are evident, where they may name what makes them.

    Returns
    -------
    judgement : Judgement
    """
    problem, explanation = case.problem, case.explanation
    searched = _judged(case, explanation.findings, explanation.model)
    if events is None or _names_one_of(events.names, searched):
        return searched
    findings, model = beside_events(explanation.findings), explanation.model
    if len(findings) < len(explanation.findings):
        model = problem.fit(tuple(f.term for f in findings), start=model)
    others = tuple(c for c in problem.channels if c != "opening")
    case = replace(case, channels=others, _residuals={})
    beside = _judged(case, findings, model)
    also: LeftSince | Pattern | None = beside.also
    if beside.verdict != "no_mismatch" and not beside.findings and beside.evidence is not None:
        also = beside.pattern or elsewhere(case, (), beside.model, beside.evidence)
    finding, model = with_events(beside.model, events, problem, case.random_state)
    return replace(
        beside,
        verdict="named",
        p_value=P_VALUE if searched.p_value is None else min(searched.p_value, P_VALUE),
        findings=[finding, *beside.findings],
        model=model,
        tried=beside.tried or cross_validated(problem, beside.model),
        suspected=None,
        why=(),
        also=also,
        pattern=None,
        # what stopped a name beside it is none of its own rules
        rules=rules.passed(rules.without(beside.rules, rules.OF_A_FIT)),
    )


def blocked(problem: Problem) -> Judgement:
    """Judgement of a recording whose data must be mended first: the calibrated simulation and no more."""
    problem, nominal = calibrated(problem)
    return Judgement(problem, "cannot_tell", None, [], None, nominal, nominal)


def _judged(case: Case, findings: Sequence[Finding], model: Model) -> Judgement:
    """The judgement, rule after rule: evidence, rows left out, what is left, noise, nameless patterns."""
    judged = _against_noise(case, _named_or_not(case, *upheld(case, findings, model)))
    judged = _by_least_error(case, judged)
    if judged.verdict == "no_mismatch" and case.channels is None:
        judged = _strays(case, judged)
    if judged.verdict == "no_mismatch" and case.channels is None:
        judged = _pulses(case, judged)
    if judged.verdict == "no_mismatch":
        return replace(judged, unknown=None)
    return with_learnt(judged)


def _named_or_not(case: Case, findings: list[Finding], model: Model) -> Judgement:
    """Verdict by the evidence, by rows left out of the fit, and by what is left beside the findings."""
    findings, unknown, weighed = what_evidence_leaves(case, findings, model)
    fit = fit_of(case, findings, model, weighed.evidence) if findings else Fit()
    kept = fit.kept
    if kept and len(kept) < len(findings):
        model = fitted_with(case, kept, findings, model)
        findings, unknown, weighed = what_evidence_leaves(case, kept, model)
        kept = findings
    asked = [rules.rarity(weighed.p_value, case.alpha)]
    if weighed.by_chance is not None:
        asked.append(rules.relevance(weighed.by_chance, case.alpha))
    asked += fit.asked
    left = replace(weighed, unknown=unknown)
    verdict, kept, about = _beside_what_is_left(case, replace(fit, kept=kept), findings, model, left)
    return Judgement(
        case.problem,
        verdict,
        weighed.p_value,
        kept,
        unknown,
        case.explanation.nominal,
        model,
        evidence=weighed.evidence,
        suspects=_suspects(case.explanation),
        why=(fit.why,) if fit.why else (),
        also=(fit.beside or elsewhere(case, kept, model, weighed.evidence)) if kept else None,
        rules=(*asked, *about),
        left=None if kept else _of_none(case, weighed),
        pattern=fit.pattern if verdict == "none_of_these" else None,
    )


def _beside_what_is_left(
    case: Case, fit: Fit, findings: Sequence[Finding], model: Model, weighed: Weighed
) -> tuple[str, list[Finding], list[rules.Rule]]:
    """Verdict and names by what is left beside them, and the rule on that where it was not asked yet."""
    asked = next((rule for rule in fit.asked if rule.name == "residual"), None)
    # since a history a pattern beside names was asked for by the history's own noise
    unknown = None if fit.kept and asked is not None else weighed.unknown
    explained = _explained(case, findings, model, unknown)
    about = []
    if unknown is not None and weighed.enough and (asked is None or asked.passed):
        about.append(rules.residual(unknown.size, explained if fit.kept else 0.0))
    verdict, kept = by_evidence(fit.kept, unknown, weighed.enough, explained)
    if fit.pattern is not None and verdict == "cannot_tell":
        verdict = "none_of_these"
    return verdict, kept, about


def _explained(case: Case, findings: Sequence[Finding], model: Model, unknown: Unknown | None) -> float:
    """What findings explain in the signal of an unknown, of all recordings together, as the unknown is."""
    if unknown is None or not findings:
        return 0.0
    bare = case.problem.baseline(model, (), case.explanation.nominal)
    return case.problem.change_in_all(unknown.channel, model, bare)


def _of_none(case: Case, weighed: Weighed) -> LeftSince | None:
    """What is new and follows from no effect: one that is rare itself comes near to explaining it."""
    return weighed.new if p_value_of_effects(weighed.evidence) > case.alpha else None


def _against_noise(case: Case, judged: Judgement) -> Judgement:
    """A judgement held against noise that no model has a part in.

    The noise model took for wander what an imitation leaves.
    """
    problem, explanation = case.problem, case.explanation
    left, said = held_against_noise(problem, explanation, judged.model, judged.findings, case.alpha)
    if left is not None:
        judged = _with_what_is_left(case, judged, left, said)
    elif said != FINE:
        judged = replace(judged, rules=(*judged.rules, rules.noise(None, False)))
    of_flow = "flow" in problem.touched_by(f.term for f in judged.findings)
    closest: list[Finding] = []
    if said == REFUTED or (said != FINE and of_flow):
        closest = judged.findings
        judged = replace(judged, findings=[])
    judged = _nameless(case, judged, said == REFUTED or judged.left is not None)
    if said == REFUTED:
        beyond = left_over(problem, explanation.nominal, explanation.nominal)
        judged = replace(judged, left=beyond, closest=closest, closest_leaves=left)
    return judged


def _nameless(case: Case, judged: Judgement, refuted: bool) -> Judgement:
    """A judgement of which no name is left: what no effect explains, if that is shown, else open."""
    if judged.findings or judged.verdict == "no_mismatch":
        return judged
    unknown = case.residual_of(case.explanation.nominal).unknown or judged.unknown
    shown = refuted or unknown is not None or judged.verdict == "none_of_these"
    verdict = "none_of_these" if shown else "cannot_tell"
    return replace(judged, verdict=verdict, unknown=unknown)


def _with_what_is_left(case: Case, judged: Judgement, left: LeftOver, said: str) -> Judgement:
    """A judgement with the outcome of the rule on noise, and with its doubt where there is one."""
    # an effect of the stem stands beside a flow that is not explained, unless that refutes it
    of_flow = "flow" in case.problem.touched_by(f.term for f in judged.findings)
    passed = said == FINE or (said != REFUTED and bool(judged.findings) and not of_flow)
    judged = replace(judged, rules=(*judged.rules, rules.noise(left.times, passed)))
    if said == FINE:
        return judged
    judged = replace(judged, why=(*judged.why, too_much_left(left, judged.findings, case.problem)))
    if judged.verdict != "no_mismatch":
        return judged
    p_value = min(judged.p_value or 1.0, left.p_value)
    return replace(judged, verdict="cannot_tell", p_value=p_value)


def _by_least_error(case: Case, judged: Judgement) -> Judgement:
    """A judgement with its simulations fitted for the least error itself."""
    nameless = judged.verdict != "no_mismatch" and not judged.findings
    if nameless and judged.unknown is None and case.explanation.model.terms:
        # what was found and may not be named shows where it is all the same
        judged = replace(judged, suspected=case.explanation.model)
    nominal = case.problem.least_squares(judged.nominal)
    model = nominal
    if judged.findings:
        model = _else_as(case.problem, case.problem.least_squares(judged.model), nominal)
    return replace(judged, nominal=nominal, model=model)


def _strays(case: Case, judged: Judgement) -> Judgement:
    """A judgement with a stem that is further off than any sound one, where nothing else was found."""
    if case.alpha < STRAYS_BY_CHANCE:
        return judged
    strays = stem_residual(case.problem, judged.nominal)
    if strays is None or not strays.evident:
        return judged
    p_value = min(judged.p_value or 1.0, STRAYS_BY_CHANCE)
    asked = (*judged.rules, rules.nameless(strays.reason))
    return replace(judged, verdict="cannot_tell", p_value=p_value, unknown=None, strays=strays, rules=asked)


def _pulses(case: Case, judged: Judgement) -> Judgement:
    """A judgement with a flow that breaks out to one side, where nothing else was found."""
    pulses = find_pulses(case.problem, judged.nominal, case.alpha)
    if pulses is None:
        return judged
    p_value = min(judged.p_value or 1.0, pulses.p_value)
    asked = (*judged.rules, rules.nameless(pulses.reason))
    return replace(judged, verdict="none_of_these", p_value=p_value, unknown=None, pulses=pulses, rules=asked)


def _suspects(explanation: Explanation) -> tuple[str, ...]:
    """Blocks of what was found, and of what comes near the best of what was tried; no name, but a place."""
    blocks = {f.term.effect.block for f in explanation.findings}
    gains = {key: tried.gain for key, tried in explanation.tried.items()}
    enough = _COMES_NEAR * max(gains.values(), default=0.0)
    blocks |= {e.block for e in explanation.effects if gains.get(e.key, -1.0) >= enough}
    return tuple(sorted(blocks))


def _else_as(problem: Problem, model: Model, nominal: Model) -> Model:
    """A model whose channels that no effect touches are simulated as the nominal simulation does."""
    touched = problem.touched_by(model.terms)
    others = [c for c in problem.channels if c not in touched]
    values = {p.name: nominal.values[p.name] for c in others for p in problem.calibration((c,))}
    predictions = {c: nominal.predictions[c] for c in others}
    return replace(model, values=model.values | values, predictions=model.predictions | predictions)


def _names_one_of(names: set[str], judgement: Judgement) -> bool:
    named = judgement.verdict == "named"
    return named and any(names & set(class_of(f)) for f in judgement.findings)
