# SPDX-License-Identifier: BSD-3-Clause
"""From the search to the judgement: what stands of the findings, and the model that goes with it."""

from dataclasses import replace
from itertools import chain, combinations

from sklvalve.mismatch.calibrating import calibrated
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.constants import HELD_OUT_SHARE
from sklvalve.mismatch.detect import (
    Evidence,
    effect_strengths,
    mismatch_p_value,
    p_value_of_one,
    p_value_of_what_counts,
)
from sklvalve.mismatch.events import P_VALUE, beside_events, with_events
from sklvalve.mismatch.goodness_of_fit import FINE, REFUTED, held_against_noise, is_fine, left_over
from sklvalve.mismatch.judgement import Judgement
from sklvalve.mismatch.null_reference import EFFECTS
from sklvalve.mismatch.prove import correction_holds_out, cross_validated, held_out_share, holds_out
from sklvalve.mismatch.pulses import find_pulses
from sklvalve.mismatch.reasons import not_upheld, too_much_left
from sklvalve.mismatch.stem_residual import P_VALUE as STRAYS_BY_CHANCE
from sklvalve.mismatch.stem_residual import stem_residual
from sklvalve.mismatch.unknown import look_for_residual
from sklvalve.mismatch.verdict import class_of, verdict_of

# a rest of so many times what counts needs no further proof
_LARGE = 2.0
# an effect that by itself gains this share of what the best one does tells where to look
_COMES_NEAR = 0.25


def judge(problem, explanation, covariates, *, alpha, random_state, events=None):
    """Verdict, what stands of the findings, and the model and the learnt rest that go with it.

    Slips of the stem that are evident, or its hunting, name what makes them where the search has not: then
    its findings in the actuator, which they explain, go, and so does what it left unexplained of the opening.

    Parameters
    ----------
    problem : Problem
    explanation : Explanation
    covariates : Covariates
        What chance depends on, as they were before the search.
    alpha : float
        Level of the test.
    random_state : int
    events : Events, default=None
        Those that are evident, where they may name what makes them.

    Returns
    -------
    judgement : Judgement
    """
    told = {"alpha": alpha, "random_state": random_state}
    told["covariates"] = covariates
    searched = _judged(problem, explanation, explanation.findings, explanation.model, **told)
    if events is None or _names_one_of(events.names, searched):
        return searched
    findings, model = beside_events(explanation.findings), explanation.model
    if len(findings) < len(explanation.findings):
        model = problem.fit(tuple(f.term for f in findings), start=model)
    others = tuple(c for c in problem.channels if c != "opening")
    beside = _judged(problem, explanation, findings, model, channels=others, **told)
    finding, model = with_events(beside.model, events, problem, random_state)
    return replace(
        beside,
        verdict="named",
        p_value=min(searched.p_value, P_VALUE),
        findings=[finding, *beside.findings],
        model=model,
        tried=beside.tried or cross_validated(problem, beside.model),
        suspected=None,
    )


def blocked(problem):
    """Judgement of a recording whose data must be mended first: the calibrated simulation and no more."""
    nominal = calibrated(problem)
    return Judgement("cannot_tell", None, [], None, nominal, nominal)


def _judged(
    problem,
    explanation,
    findings,
    model,
    *,
    alpha,
    covariates,
    random_state,
    channels=None,
):
    asked = {}

    def residual_of_model(model):
        if model not in asked:
            # of the least error itself: orthogonal to all that was fitted and is free to move
            fitted = problem.least_squares(model)
            more = {"random_state": random_state, "channels": channels}
            rest, strong = look_for_residual(problem, fitted, alpha=alpha, **more)
            asked[model] = rest if rest is not None and _stands(problem, fitted, rest) else None, strong
        return asked[model]

    def any_is_rare(findings):
        return any(p_value_of_one(f, problem, covariates) <= alpha for f in findings)

    def weighed(findings, model):
        """What is left, the evidence with its p-value, that of what counts, and whether it is all enough."""
        unknown, rest = residual_of_model(model)
        strengths = effect_strengths(explanation, problem)
        evidence = Evidence(EFFECTS.relative(strengths), rest, covariates, strengths)
        p_value = mismatch_p_value(evidence)
        by_chance = None
        # what was found is larger than what counts: where it is rare among healthy recordings that is enough
        if unknown is None and not any_is_rare(findings):
            by_chance = p_value_of_what_counts(findings, explanation.tried, problem)
        elif unknown is not None and unknown.period is not None:
            # a cycle is told by a law of its own
            p_value = min(p_value, unknown.p_value)
        counts = by_chance is None or by_chance <= alpha
        return unknown, evidence, p_value, by_chance, counts and p_value <= alpha

    nominal = explanation.nominal
    findings, model = _clear_ones(problem, explanation, findings, model, covariates, alpha)
    unknown, evidence, p_value, by_chance, enough = weighed(findings, model)
    if findings and not enough:
        # effects too weak to be told from chance must not hide a rest that is not
        bare = weighed([], nominal)
        # where the mismatch is told anyway, what is rare among healthy recordings may say what it is
        named = bare[-1] and any_is_rare(findings)
        # what decides is what is told beside it
        evidence, p_value, by_chance, enough = bare[1:]
        if not named:
            findings, unknown = [], bare[0]
    asked_in_turn = [rules.rarity(p_value, alpha)]
    if by_chance is not None:
        asked_in_turn.append(rules.relevance(by_chance, alpha))
    share = held_out_share(problem, nominal, model) if findings else 0.0
    upheld = share < HELD_OUT_SHARE
    if findings:
        asked_in_turn.append(rules.held_out(share))
    explained = 0.0
    if unknown is not None and findings:
        # of all recordings together, as the unknown is
        explained = problem.change_in_all(unknown.channel, model, nominal)
    why = [] if upheld else [not_upheld(findings)]
    if not upheld:
        # blocks that the fit had not seen speak against it: no name is better than a wrong one
        findings = []
    if unknown is not None and enough:
        asked_in_turn.append(rules.residual(unknown.size, explained if findings else 0.0))
    verdict, findings = verdict_of(findings, unknown, enough, explained)
    # the noise model took for wander what an imitation leaves: noise that no model has a part in judges it
    left, said = held_against_noise(problem, explanation, model, findings, alpha)
    if left is not None:
        asked_in_turn.append(rules.noise(left.times, said == FINE))
    if said != FINE and left is not None:
        why.append(too_much_left(left, findings, problem))
    of_flow = any("flow" in problem.channels_touched(f.term.effect) for f in findings)
    closest = []
    if said == REFUTED or (said != FINE and of_flow):
        closest, findings = findings, []
    if said != FINE and verdict == "no_mismatch":
        verdict, p_value = "cannot_tell", max(min(p_value, left.p_value), 1e-12)
    if not findings and verdict != "no_mismatch":
        unknown = residual_of_model(nominal)[0] or unknown
        verdict = "none_of_these" if said == REFUTED or unknown is not None else "cannot_tell"
    more: dict = {
        "evidence": evidence,
        "suspects": _suspects(explanation),
        "why": tuple(why),
        "rules": tuple(asked_in_turn),
    }
    if verdict != "no_mismatch" and not findings and unknown is None and explanation.model.terms:
        # what was found and may not be named shows where it is all the same
        more["suspected"] = explanation.model
    if said == REFUTED:
        more |= {"left": left_over(problem, nominal, nominal), "closest": closest, "closest_leaves": left}
    nominal = problem.least_squares(nominal)
    model = _else_as(problem, problem.least_squares(model), nominal) if findings else nominal
    if verdict == "no_mismatch" and channels is None and alpha >= STRAYS_BY_CHANCE:
        strays = stem_residual(problem, nominal)
        if strays is not None and strays.evident:
            verdict, p_value, unknown = "cannot_tell", min(p_value, STRAYS_BY_CHANCE), None
            more["strays"] = strays
    ask = verdict == "no_mismatch" and channels is None
    pulses = find_pulses(problem, nominal, alpha) if ask else None
    if pulses is not None:
        verdict, p_value, unknown = "none_of_these", min(p_value, pulses.p_value), None
        more["pulses"] = pulses
    if verdict == "no_mismatch" or unknown is None:
        return Judgement(verdict, p_value, findings, None, nominal, model, **more)
    tried = cross_validated(problem, model, unknown)
    kept, told = correction_holds_out(problem, tried, unknown.channel)
    return Judgement(verdict, p_value, findings, unknown, nominal, model, tried, kept, told, **more)


def _suspects(explanation):
    """Blocks of what was found, and of what comes near the best of what was tried; no name, but a place."""
    blocks = {f.term.effect.block for f in explanation.findings}
    gains = {key: gain for key, (gain, _) in explanation.tried.items()}
    enough = _COMES_NEAR * max(gains.values(), default=0.0)
    blocks |= {e.block for e in explanation.effects if gains.get(e.key, -1.0) >= enough}
    return tuple(sorted(blocks))


def _clear_ones(problem, explanation, findings, model, covariates, alpha):
    """The strongest finding and those beside it that are clear or needed, with their model.

    One mismatch makes others look likely, for no effect is simulated just as it is. So what is named beside
    a stronger one of the same signals must be as rare among healthy recordings as alpha twice over, unless
    blocks that no fit has seen, or the noise that no model has a part in, speak against what is left without
    it. What shows in another signal is judged as if it were alone: where the opening is recorded no error of
    its simulation reaches the flow.
    """
    rarity = {f: p_value_of_one(f, problem, covariates) for f in findings[1:]}
    asked = {f: alpha if _shows_alone(f, findings, problem) else alpha**2 for f in findings[1:]}
    weak = [f for f in findings[1:] if rarity[f] > asked[f]]
    # for the noise's sake nothing stands that is no rarer than an alarm
    rare = [f for f in weak if rarity[f] <= alpha]
    nominal, held_out = explanation.nominal, []
    for needed in chain.from_iterable(combinations(rare, many) for many in range(len(rare) + 1)):
        if len(needed) == len(weak):
            break
        stand = [f for f in findings if f not in weak or f in needed]
        fewer = problem.fit(tuple(f.term for f in stand), start=model)
        if holds_out(problem, nominal, fewer):
            if is_fine(problem, nominal, fewer, stand, alpha):
                return stand, fewer
            held_out.append((stand, fewer))
    all_needed = len(rare) == len(weak) and is_fine(problem, nominal, model, findings, alpha)
    return held_out[0] if held_out and not all_needed else (findings, model)


def _shows_alone(finding, findings, problem):
    """Whether a finding shows in no signal in which a stronger one does."""
    if problem.coupled:
        return False
    stronger = findings[: findings.index(finding)]
    elsewhere = {c for f in stronger for c in problem.channels_touched(f.term.effect)}
    return elsewhere.isdisjoint(problem.channels_touched(finding.term.effect))


def _stands(problem, model, unknown):
    """Whether a rest is large, or, once learnt, predicts blocks that it was not learnt from.

    What is hardly larger than what counts, and no help elsewhere, may be a slow chance of the noise.
    """
    if unknown.size >= _LARGE * problem.least(unknown.channel):
        return True
    tried = cross_validated(problem, model, unknown)
    return correction_holds_out(problem, tried, unknown.channel)[0]


def _else_as(problem, model, nominal):
    """A model whose channels that no effect touches are simulated as the nominal simulation does."""
    touched = {c for m in model.terms for c in problem.channels_touched(m.effect)}
    rest = [c for c in problem.channels if c not in touched]
    values = {p.name: nominal.values[p.name] for c in rest for p in problem.calibration((c,))}
    predictions = {c: nominal.predictions[c] for c in rest}
    return replace(model, values=model.values | values, predictions=model.predictions | predictions)


def _names_one_of(names, judgement):
    named = judgement.verdict == "named"
    return named and any(names & set(class_of(f)) for f in judgement.findings)
