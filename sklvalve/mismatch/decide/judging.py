# SPDX-License-Identifier: BSD-3-Clause
"""From the search to the judgement: what stands of the findings, and the model that goes with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.constants import HELD_OUT_ERRORS
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.decision import by_evidence
from sklvalve.mismatch.decide.detect import (
    Evidence,
    effect_sizes,
    law_for,
    mismatch_p_value,
    p_value_of_effects,
    p_value_of_one,
    p_value_of_residual,
    p_value_of_what_counts,
)
from sklvalve.mismatch.decide.judgement import Judgement, with_learnt
from sklvalve.mismatch.decide.reasons import exceeds_noise, not_upheld, too_much_left
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.proof.held_out import correction_holds_out, cross_validated
from sklvalve.mismatch.residual.goodness_of_fit import FINE, REFUTED, LeftOver, held_against_noise, left_over
from sklvalve.mismatch.residual.pulses import find_pulses
from sklvalve.mismatch.residual.since_history import LeftSince, left_since
from sklvalve.mismatch.residual.stem_residual import P_VALUE as STRAYS_BY_CHANCE
from sklvalve.mismatch.residual.stem_residual import stem_residual
from sklvalve.mismatch.residual.unknown import Unknown, look_for_residual
from sklvalve.mismatch.search.events import P_VALUE, Events, beside_events, with_events
from sklvalve.mismatch.search.rivals import class_of

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.compare import Comparison
    from sklvalve.mismatch.decide.null_reference import Covariates
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.explain import Explanation
    from sklvalve.mismatch.search.rivals import Finding

# a residual of so many times what counts needs no further proof
_LARGE = 2.0
# an effect that by itself gains this share of what the best one does tells where to look
_COMES_NEAR = 0.25

# of the level of an alarm, what is named beside a stronger effect of the same signals
_BESIDE = 0.1


@dataclass(frozen=True, eq=False)
class _Residual:
    """What a model leaves over: what follows from something, how strong, and what is new since a history.

    `fitted` is the model for the least error itself, of which it is left.
    """

    fitted: Model
    unknown: Unknown | None
    strong: float | None
    new: LeftSince | None


@dataclass(frozen=True, eq=False)
class Case:
    """What a judgement is made on.

    Parameters
    ----------
    explanation : Explanation
    covariates : Covariates
        What chance depends on, as they were before the search.
    comparison : Comparison
        The table of the explanation.
    alpha : float
        Level of the test.
    random_state : int
    channels : tuple of str, default=None
        Those in which something unknown is looked for; all unless given.
    """

    explanation: Explanation
    covariates: Covariates
    comparison: Comparison
    alpha: float
    random_state: int
    channels: tuple[str, ...] | None = None
    _residuals: dict = field(default_factory=dict)

    @property
    def problem(self) -> Problem:
        """What it is made on, judged by the noise that the explanation leaves."""
        return self.explanation.problem

    def residual_of(self, model: Model) -> _Residual:
        """What a model leaves over."""
        if model not in self._residuals:
            # of the least error itself: orthogonal to all that was fitted and is free to move
            fitted = self.problem.least_squares(model)
            unknown, strong = look_for_residual(
                self.problem,
                fitted,
                alpha=self.alpha,
                random_state=self.random_state,
                channels=self.channels,
            )
            stands = unknown is not None and _stands(self.problem, fitted, unknown)
            new = left_since(self.problem, fitted, self.channels)
            if self.problem.history is not None:
                # what the healthy valve left over tells chance better than what can be learnt of this one
                strong = None if new is None else new.effect_size
            self._residuals[model] = _Residual(fitted, unknown if stands else None, strong, new)
        return self._residuals[model]

    def left_where_they_act(self, findings: Sequence[Finding], model: Model) -> LeftSince | None:
        """What is left over since the history in the signals that some findings change.

        What is left of another signal is something else that is missing.
        """
        touched = self.problem.touched_by(f.term for f in findings)
        asked = self.problem.channels if self.channels is None else self.channels
        asked = tuple(c for c in asked if c in touched)
        return left_since(self.problem, self.residual_of(model).fitted, asked)

    def is_rare(self, finding: Finding, level: float | None = None) -> bool:
        """Whether few healthy recordings, alpha of them unless told, show any effect as strong."""
        level = self.alpha if level is None else level
        return p_value_of_one(finding, self.problem, self.covariates) <= level

    def held_out_gain(self, finding: Finding) -> float:
        """Gain of a finding on rows left out of its fit, in standard errors."""
        return self.comparison.held_out_errors(1 + self.explanation.findings.index(finding))


@dataclass(frozen=True)
class _Weighed:
    """Evidence for a mismatch: what is left, p-values, whether it is enough, and what is new in it."""

    unknown: Unknown | None
    evidence: Evidence
    p_value: float
    by_chance: float | None
    enough: bool
    new: LeftSince | None


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
    beside = _judged(replace(case, channels=others, _residuals={}), findings, model)
    finding, model = with_events(beside.model, events, problem, case.random_state)
    return replace(
        beside,
        verdict="named",
        p_value=P_VALUE if searched.p_value is None else min(searched.p_value, P_VALUE),
        findings=[finding, *beside.findings],
        model=model,
        tried=beside.tried or cross_validated(problem, beside.model),
        suspected=None,
        rules=rules.without(beside.rules, rules.OF_A_FIT),
    )


def blocked(problem: Problem) -> Judgement:
    """Judgement of a recording whose data must be mended first: the calibrated simulation and no more."""
    problem, nominal = calibrated(problem)
    return Judgement(problem, "cannot_tell", None, [], None, nominal, nominal)


def _judged(case: Case, findings: Sequence[Finding], model: Model) -> Judgement:
    """The judgement, rule after rule: evidence, rows left out, what is left, noise, nameless patterns."""
    judged = _against_noise(case, _named_or_not(case, *_upheld(case, findings, model)))
    judged = _by_least_error(case, judged)
    if judged.verdict == "no_mismatch" and case.channels is None:
        judged = _strays(case, judged)
    if judged.verdict == "no_mismatch" and case.channels is None:
        judged = _pulses(case, judged)
    if judged.verdict == "no_mismatch":
        return replace(judged, unknown=None)
    return with_learnt(judged)


def _upheld(case: Case, findings: Sequence[Finding], model: Model) -> tuple[list[Finding], Model]:
    """The strongest finding and those beside it that may be named, and the model with them.

    One mismatch makes others look likely, for no effect is simulated just as it is. What is rarer than an
    alarm and gains on rows left out is named in signals of its own; to be named beside a stronger one of the
    same signals it must be ten times as rare.
    """
    if not findings:
        return [], model
    stand = [findings[0]]
    for finding in findings[1:]:
        level = case.alpha if _shows_alone(case.problem, finding, stand) else _BESIDE * case.alpha
        if case.held_out_gain(finding) >= HELD_OUT_ERRORS and case.is_rare(finding, level):
            stand.append(finding)
    return stand, _fitted_with(case, stand, findings, model)


def _fitted_with(case: Case, stand: Sequence[Finding], findings: Sequence[Finding], model: Model) -> Model:
    """The model of some findings with those of them that stand."""
    if len(stand) == len(findings):
        return model
    return case.problem.fit(tuple(f.term for f in stand), start=model)


def _shows_alone(problem: Problem, finding: Finding, stronger: Sequence[Finding]) -> bool:
    """Whether a finding shows in no signal in which a stronger one does."""
    if problem.coupled:
        return False
    elsewhere = problem.touched_by(f.term for f in stronger)
    return elsewhere.isdisjoint(problem.touched_by([finding.term]))


def _named_or_not(case: Case, findings: list[Finding], model: Model) -> Judgement:
    """Verdict by the evidence, by rows left out of the fit, and by what is left beside the findings."""
    nominal = case.explanation.nominal
    findings, unknown, weighed = _by_evidence(case, findings, model)
    asked = [rules.rarity(weighed.p_value, case.alpha)]
    if weighed.by_chance is not None:
        asked.append(rules.relevance(weighed.by_chance, case.alpha))
    explained, why = 0.0, ""
    if findings:
        if unknown is not None:
            # of all recordings together, as the unknown is
            bare = case.problem.baseline(model, (), nominal)
            explained = case.problem.change_in_all(unknown.channel, model, bare)
        of_fit, kept, why = _of_fit(case, findings, model, weighed.evidence)
        asked += of_fit
        if kept:
            model = _fitted_with(case, kept, findings, model)
        findings = kept
    if unknown is not None and weighed.enough:
        asked.append(rules.residual(unknown.size, explained if findings else 0.0))
    verdict, findings = by_evidence(findings, unknown, weighed.enough, explained)
    return Judgement(
        case.problem,
        verdict,
        weighed.p_value,
        findings,
        unknown,
        nominal,
        model,
        evidence=weighed.evidence,
        suspects=_suspects(case.explanation),
        why=(why,) if why else (),
        also=_elsewhere(case, findings, model, weighed.evidence) if findings else None,
        rules=tuple(asked),
        left=None if findings else _of_none(case, weighed),
    )


def _of_fit(
    case: Case, findings: Sequence[Finding], model: Model, evidence: Evidence
) -> tuple[list[rules.Rule], list[Finding], str]:
    """Rules on the fit of findings, those that may be named, and why others may not; empty where all may."""
    asked = [rules.held_out(case.held_out_gain(findings[0]))]
    if not asked[-1].passed:
        # blocks that the fit had not seen speak against it: no name is better than a wrong one
        return asked, [], not_upheld(findings)
    kept: list[Finding] = []
    outcomes: dict[float, rules.Rule] = {}
    why = ""
    for some in _by_signals(case.problem, findings):
        new = case.left_where_they_act(some, model)
        if new is None:
            kept += some
            continue
        # an imitation leaves over what healthy valves do not, in the signals that it is to explain
        p_value = p_value_of_residual(replace(evidence, residual=new.effect_size))
        outcomes[p_value] = rules.history_noise(p_value)
        if outcomes[p_value].passed:
            kept += some
        else:
            why = exceeds_noise(new, some, case.problem)
    # that of the signals which are explained, where any are: what acts on the others has no name
    counting = [p_value for p_value, rule in outcomes.items() if rule.passed or not kept]
    asked += [outcomes[p_value] for p_value in sorted(counting)[:1]]
    return asked, [f for f in findings if f in kept], why


def _by_signals(problem: Problem, findings: Sequence[Finding]) -> list[list[Finding]]:
    """Findings in groups of which each has signals of its own; one group where any two share some."""
    groups: dict[frozenset[str], list[Finding]] = {}
    for finding in findings:
        groups.setdefault(frozenset(problem.touched_by([finding.term])), []).append(finding)
    alone = sum(map(len, groups)) == len(frozenset().union(*groups))
    return list(groups.values()) if alone else [list(findings)]


def _elsewhere(case: Case, findings: Sequence[Finding], model: Model, evidence: Evidence) -> LeftSince | None:
    """What differs from the history in a signal that no finding changes."""
    new = case.residual_of(model).new
    if new is None or new.channel in case.problem.touched_by(f.term for f in findings):
        return None
    return new if _is_rare(case, replace(evidence, residual=new.effect_size)) else None


def _of_none(case: Case, weighed: _Weighed) -> LeftSince | None:
    """What is new and follows from no effect: one that is rare itself comes near to explaining it."""
    return weighed.new if p_value_of_effects(weighed.evidence) > case.alpha else None


def _is_rare(case: Case, evidence: Evidence) -> bool:
    """Whether few healthy recordings, alpha of them, leave over as much that can be learnt."""
    return p_value_of_residual(evidence) <= case.alpha


def _by_evidence(
    case: Case, findings: list[Finding], model: Model
) -> tuple[list[Finding], Unknown | None, _Weighed]:
    """What the evidence leaves of the findings, the unknown beside them, and that evidence."""
    weighed = _weighed(case, findings, model)
    if weighed.enough or not findings:
        return findings, weighed.unknown, weighed
    # effects too weak to be told from chance must not hide a residual that is not; what decides is what is
    # told beside it
    alone = _weighed(case, [], case.explanation.nominal)
    # where the mismatch is told anyway, what is rare among healthy recordings may say what it is, and so may
    # what leaves nothing rare where too much was left over since the history
    known = case.problem.history is not None and weighed.evidence.residual is not None
    explains = known and _is_rare(case, alone.evidence) and not _is_rare(case, weighed.evidence)
    if alone.enough and (explains or any(map(case.is_rare, findings))):
        return findings, weighed.unknown, alone
    return [], alone.unknown, alone


def evidence_of(case: Case) -> Evidence:
    """Evidence for a mismatch, with all that is left over where no effect is taken for true.

    Parameters
    ----------
    case : Case
    """
    return _weighed(case, [], case.explanation.nominal).evidence


def _weighed(case: Case, findings: Sequence[Finding], model: Model) -> _Weighed:
    """What is left beside findings, and the evidence for a mismatch with its p-values."""
    left = case.residual_of(model)
    strengths = effect_sizes(case.explanation, case.problem)
    evidence = Evidence.of(strengths, left.strong, case.covariates, law_for(case.problem))
    p_value = mismatch_p_value(evidence)
    rare = _is_rare(case, evidence)
    # what chance leaves over as often takes no name away
    unknown = _beside(findings, left.unknown, rare)
    new = left.new if rare else None
    by_chance = None
    # what was found is larger than what counts: where it is rare among healthy recordings that is enough
    if unknown is None and new is None and not any(map(case.is_rare, findings)):
        by_chance = p_value_of_what_counts(findings, case.explanation.tried, case.problem)
    elif unknown is not None and unknown.period is not None:
        # a cycle is told by a law of its own
        p_value = min(p_value, unknown.p_value)
    counts = by_chance is None or by_chance <= case.alpha
    enough = counts and p_value <= case.alpha
    return _Weighed(unknown, evidence, p_value, by_chance, enough, new if enough else None)


def _beside(findings: Sequence[Finding], unknown: Unknown | None, rare: bool) -> Unknown | None:
    """An unknown, where it is rare among healthy recordings or no finding stands beside it."""
    cycle = unknown is not None and unknown.period is not None
    return unknown if rare or cycle or not findings else None


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
    verdict = "none_of_these" if refuted or unknown is not None else "cannot_tell"
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


def _stands(problem: Problem, model: Model, unknown: Unknown) -> bool:
    """Whether a residual is large, or, once learnt, predicts blocks that it was not learnt from.

    What is hardly larger than what counts, and no help elsewhere, may be a slow chance of the noise.
    """
    if unknown.size >= _LARGE * problem.least(unknown.channel):
        return True
    tried = cross_validated(problem, model, unknown)
    return correction_holds_out(problem, tried, unknown.channel)[0]


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
