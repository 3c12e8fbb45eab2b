# SPDX-License-Identifier: BSD-3-Clause
"""What the forecasts allow a diagnosis to say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.proof.comparison import Compared, compare, pooled, rise, share_explained
from sklvalve.mismatch.proof.forward import Forward, forward_in_time
from sklvalve.mismatch.search.events import simulated

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem

#: Share of healthy recordings in which the black box is clearly better: none of 30 (docs/method.md).
BY_CHANCE = 1.0 / 31.0
# a name that accounts for less of what can be forecast may be an imitation of what is missing
_LEAST_SHARE = 0.5
_BLOCK = {"flow": "valve", "opening": "actuator"}


@dataclass(frozen=True, eq=False)
class Referee:
    """The comparison that a verdict was held against.

    Parameters
    ----------
    compared : tuple of Compared
    share : float or None
        Of what can be forecast beyond the nominal simulation, what the correction accounts for [1].
    reasons : tuple of str
        What it changed, or adds to, in plain sentences.
    """

    compared: tuple[Compared, ...]
    share: float | None
    reasons: tuple[str, ...] = ()


def refereed(problem: Problem, judged: Judgement) -> tuple[Judgement, Forward]:
    """A judgement that the forecasts bear out, and the forecasts.

    A correction that makes rows ahead worse is not applied, and what it was made of is not named. Where the
    black box is clearly better than the simulation that a judgement ends with, something is missing, or,
    where signals that drive the channel were not recorded, nothing can be said.

    Parameters
    ----------
    problem : Problem
    judged : Judgement

    Returns
    -------
    judged : Judgement
        With its `referee`.
    forward : Forward
    """
    unknown = judged.unknown if judged.kept else None
    forward = forward_in_time(problem, judged.nominal, simulated(judged.model), unknown)
    compared = compare(problem, forward)
    reasons = []
    corrected = bool(judged.findings or judged.kept)
    rises = rise(problem, compared, forward.held)
    ahead = rules.forecast(rises, pooled(compared, "corrected"), pooled(compared, "nominal"))
    if not ahead.passed:
        judged, sentence = _taken_back(problem, judged, compared)
        reasons.append(sentence)
        made = forward.predictions
        forward = Forward(made | {"corrected": made["nominal"]}, forward.spans, forward.closed)
        compared = compare(problem, forward)
    share = share_explained(compared) if judged.findings else None
    clear = [each for each in compared if each.clearly_better]
    if clear:
        judged, sentence = _beaten(problem, judged, max(clear, key=lambda each: each.ratio))
        reasons.append(sentence)
    elif judged.verdict == "no_mismatch" and compared:
        reasons.append(_as_good(problem, compared))
    asked = [_black_box(compared, judged.verdict == "named")] if compared else []
    if compared and corrected:
        asked.append(ahead)
    judged = replace(judged, rules=(*judged.rules, *asked))
    return replace(judged, referee=Referee(compared, share, tuple(reasons))), forward


def _black_box(compared: Sequence[Compared], named: bool) -> rules.Rule:
    """The rule that the black box answers, by the channel in which it does best."""
    beaten = [each for each in compared if each.clearly_better]
    best = max(beaten or compared, key=lambda each: each.ratio / each.margin)
    return rules.black_box(float(best.ratio), best.margin, named or not beaten, beside=named and bool(beaten))


def _taken_back(problem: Problem, judged: Judgement, compared: Sequence[Compared]) -> tuple[Judgement, str]:
    """A judgement without a correction that makes rows ahead worse."""
    worst = max(compared, key=lambda each: each.losses["corrected"] - each.losses["nominal"])
    before, after = (_in_units(problem, worst, kind) for kind in ("nominal", "corrected"))
    rises = f"the {worst.channel} error on forecast rows rises from {before} to {after}"
    if not judged.findings:
        return replace(judged, kept=False), (
            f"The unexplained part is not added to the simulation: with it {rises}."
        )
    nameless = judged.without_names("none_of_these" if judged.unknown is not None else "cannot_tell")
    return nameless, f"The best explanation is not named: with it {rises}."


def _beaten(problem: Problem, judged: Judgement, worst: Compared) -> tuple[Judgement, str]:
    """A judgement that a black box is clearly better than, and the sentence that says so."""
    box, ours = (_in_units(problem, worst, kind) for kind in ("black_box", "corrected"))
    better = (
        f"A black box forecasts the {worst.channel} {worst.ratio:.1f} times better (error {box} against "
        f"{ours})"
    )
    if judged.findings:
        share = share_explained([worst])
        touched = problem.touched_by(f.term for f in judged.findings)
        # what shows in another signal is no imitation of what is missing in this one
        if worst.channel in touched and share is not None and share < _LEAST_SHARE:
            return replace(judged, verdict="cannot_tell"), (
                f"{better}, and what was found accounts for only {100.0 * share:.0f} % of what can be "
                "predicted."
            )
        return judged, f"{better}: something else is missing too."
    if judged.verdict != "no_mismatch":
        return judged, f"{better}."
    if not worst.exogenous:
        return replace(judged, verdict="cannot_tell", p_value=None), (
            f"{better}. Without recorded pressures the cause may be the pressure drop or the valve: record "
            "p1 and p2."
        )
    suspects = judged.suspects or (_BLOCK[worst.channel],)
    p_value = BY_CHANCE if judged.p_value is None else min(judged.p_value, BY_CHANCE)
    return replace(judged, verdict="cannot_tell", p_value=p_value, suspects=suspects), (
        f"{better}, so something predictable is missing; no effect that was tried explains it."
    )


def _as_good(problem: Problem, compared: Sequence[Compared]) -> str:
    """The sentence that says how far nothing is missing, by the channel in which the black box does best."""
    near = max(compared, key=lambda each: each.ratio)
    box, ours = (_in_units(problem, near, kind) for kind in ("black_box", "corrected"))
    return (
        f"On forecast rows the simulation's {near.channel} error is {ours}; that of a black box on the same "
        f"signals is {box}."
    )


def _in_units(problem: Problem, compared: Compared, kind: str) -> str:
    recording, channel = problem.recording, compared.channel
    value = compared.rmse[kind] * abs(recording.per_si(channel))
    unit = recording.unit(channel)
    return f"{100.0 * value:.3g} %" if unit == "1" else f"{value:.3g} {unit}"
