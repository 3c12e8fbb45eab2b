# SPDX-License-Identifier: BSD-3-Clause
"""Is there any mismatch at all: one p-value for the whole search, by rank among healthy recordings.

At thousands of rows any simulation is found to be a little wrong, and the best of fifty effects is the best
of fifty. So no textbook law says how strong evidence gets by chance. Healthy recordings do: each went
through the whole search, and the p-value is the share of them that looked as far from their simulation
(quantiles of theirs, and beyond these a fitted tail: `null_reference`).

`mismatch_p_value` is the main one. A diagnosis reports the smallest of it and of those that have laws of
their own: a cycle, slow error that noise does not allow, a straying stem, pulses, events (`judging`), the
last rows (`late`), a change without a name (`dated`), what lies behind a property (`behind`), a black box
(`referee`). It reports none where the data may have made the difference (`suppression`).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import chi2

from sklvalve.mismatch.constants import LEAST_P_VALUE
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.null_reference import (
    AGAINST_HISTORY,
    AGAINST_SHEET,
    LOOKS,
    OF_EFFECTS,
    Covariates,
    NullLaw,
    survival,
)
from sklvalve.mismatch.residual.since_history import left_since
from sklvalve.mismatch.search.relevance import standardized_effect_size
from sklvalve.recording.dead_bands import flow_moved_by
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.given import ACTUATOR_STAGES

if TYPE_CHECKING:
    from sklvalve.history.rehearsal import Rehearsal
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.explain import Explanation
    from sklvalve.mismatch.search.rivals import Finding
    from sklvalve.mismatch.search.taking_up import Tried

# shares of the level that each look at a recording gets; the residual seldom sees what the effects do not
_SHARES = {"throughout": 0.225, "stem": 0.225, "within": 0.3, "residual": 0.25}


@dataclass(frozen=True)
class Evidence:
    """How far a recording lies from the healthy simulation.

    Parameters
    ----------
    throughout : float
        The strongest of the effects on valve and meters that act throughout, as `standardized_effect_size`
        has them; zero where none was tried.
    within : float
        The same of effects that begin within the recording, by what they gain over those that act throughout.
        A valve is never quite as it was known, so a difference from its beginning on is more usual.
    residual : float or None
        How predictable the residual is, as an effect size; beside a history, how far it is beyond the
        noise of the history. None where neither is known.
    covariates : Covariates
        What chance depends on.
    effect_sizes : dict, default={}
        ``"throughout"``, ``"stem"`` and ``"within"`` -> effect key -> effect size, of the effects tried
        beyond their tolerance and of those found.
    law : NullLaw, default=AGAINST_SHEET
        What chance makes of recordings like it.
    stem : float, default=0
        The strongest of effects that act throughout on positioner and actuator.
    """

    throughout: float
    within: float
    residual: float | None
    covariates: Covariates
    effect_sizes: dict[str, dict[str, float]] = field(default_factory=dict, compare=False, repr=False)
    law: NullLaw = field(default=AGAINST_SHEET, repr=False)
    stem: float = 0.0

    @classmethod
    def of(
        cls,
        effect_sizes: dict[str, dict[str, float]],
        residual: float | None,
        covariates: Covariates,
        law: NullLaw,
    ) -> Evidence:
        """Evidence by what `effect_sizes` gives."""
        best = dict.fromkeys(OF_EFFECTS, 0.0)
        best |= {look: max(of_look.values(), default=0.0) for look, of_look in effect_sizes.items()}
        return cls(**best, residual=residual, covariates=covariates, effect_sizes=effect_sizes, law=law)

    @property
    def chances(self) -> dict[str, float]:
        """Share of healthy recordings in which each look saw as much, or more; of those that are known."""
        known = {look: seen for look, seen in self.looks.items() if seen is not None}
        return {look: survival(self.law.tables[look], known[look], self.covariates) for look in known}

    @property
    def looks(self) -> dict[str, float | None]:
        """What each look at the recording saw."""
        return {look: getattr(self, look) for look in LOOKS}


def law_for(problem: Problem) -> NullLaw:
    """Law of recordings that are held against the same thing: a data sheet, or a history of the valve."""
    if problem.history is None:
        return AGAINST_SHEET
    return _law_beside(tuple(problem.history.rehearsals_))


@lru_cache(maxsize=8)
def _law_beside(rehearsals: tuple[Rehearsal, ...]) -> NullLaw:
    """Law of one valve; a diagnosis asks for it again and again."""
    return AGAINST_HISTORY.with_rehearsals(rehearsals)


def effect_sizes(explanation: Explanation, problem: Problem) -> dict[str, dict[str, float]]:
    """Strength of each effect beyond tolerance, of those found and those tried at the first step, by key.

    The deviations of an effect are those of the log likelihood that it gains, by how stretches agree on it
    (`OverTime`): over the calibrated simulation where it acts throughout, by beginning where it begins within
    the recording.
    """
    by_look: dict[str, dict[str, float]] = {look: {} for look in OF_EFFECTS}
    seen: list[tuple[str, Tried | Finding]] = [*explanation.tried.items(), *explanation.acting.items()]
    seen += [(f.term.effect.key, f) for f in explanation.findings]
    for key, each in seen:
        look, size = _look_and_effect_size(each, problem)
        by_look[look][key] = max(by_look[look].get(key, 0.0), size)
    return by_look


def p_value_of_one(finding: Finding, problem: Problem, covariates: Covariates) -> float:
    """Share of healthy recordings in which the strongest effect is as strong as this one, or stronger.

    Parameters
    ----------
    finding : Finding
    problem : Problem
    covariates : Covariates

    Returns
    -------
    p_value : float
    """
    look, size = _look_and_effect_size(finding, problem)
    alone = {look: {finding.term.effect.key: size}}
    return mismatch_p_value(Evidence.of(alone, None, covariates, law_for(problem)))


def _look_and_effect_size(each: Tried | Finding, problem: Problem) -> tuple[str, float]:
    look, gain = ("throughout", each.gain) if each.by_beginning is None else ("within", each.by_beginning)
    if look == "throughout" and each.stage in ACTUATOR_STAGES:
        look = "stem"
    return look, standardized_effect_size(each.over_time.deviations(gain), in_counts(each.sizes, problem))


def in_counts(sizes: dict[str, float], problem: Problem) -> float:
    """Sizes of a change by channel as one: the largest, in multiples of what counts in its channel [1]."""
    return max((size / problem.least(c) for c, size in sizes.items()), default=0.0)


def covariates_of(problem: Problem, data: Sequence[dict[str, Any]] = ()) -> Covariates:
    """What chance depends on, known before the search: its noise and how the valve moved.

    Parameters
    ----------
    problem : Problem
        With the noise that the calibrated simulation leaves.
    data : list of dict, default=()
        Findings of `screen_recording` of its recording.
    """
    recording = problem.recording
    # without a flow nothing waits for its drop
    no_drop = "flow" in problem.channels and drop_is_unknown(recording)
    moved = next(recording[r] for r in ("opening", "command", "flow") if r in recording)
    low, high = np.nanquantile(moved, [0.05, 0.95])
    span = 1.0 if "opening" in recording or "command" in recording else np.nanmax(np.abs(moved))
    noise = max(problem.noise[c].floor / (problem.least(c) * problem.spans[c]) for c in problem.channels)
    return Covariates(
        noise=float(np.log(noise)),
        travel=float((high - low) / span),
        no_opening=float("opening" not in recording),
        no_drop=float(no_drop),
        one_pressure=float(no_drop and ("p1" in recording or "p2" in recording)),
        held_opening=_held(problem, data, ("opening",)),
        held_flow=_held(problem, data, ("flow", "p1", "p2")),
    )


def _held(problem: Problem, data: Sequence[dict[str, Any]], roles: tuple[str, ...]) -> float:
    """Logarithm of one plus the widest dead band of some signals, in multiples of what counts."""
    bands = [_dead_band_in_counts(problem, each) for each in data if each["role"] in roles]
    return float(np.log1p(max(bands, default=0.0)))


def _dead_band_in_counts(problem: Problem, finding: dict[str, Any]) -> float:
    """Dead band of a historian, in multiples of what counts in the channel that it changes most [1]."""
    role, band, recording = finding["role"], finding.get("size"), problem.recording
    # of lines and slower scans, which have no size, no healthy recording of the reference tells
    if finding["finding"] != "compressed" or not band:
        return 0.0
    if role in problem.channels:
        return band / (problem.spans[role] * problem.tolerated(role))
    # where nothing tells the drop no flow is simulated from a pressure
    moved = flow_moved_by(recording, band) if role in ("p1", "p2") and "flow" in problem.channels else 0.0
    return moved / problem.tolerated("flow") if np.isfinite(moved) else 0.0


def mismatch_p_value(evidence: Evidence) -> float:
    """Share of healthy recordings that look as far from their simulation as this one, or further.

    The strongest effect that acts throughout, the strongest that begins within the recording, and the learnt
    residual are each held against their own among healthy recordings in the same covariates. Any of these
    looks at one recording may raise the alarm: each has a share of the level (Sidak, with weights 0.225 for
    what drives the stem, 0.225 for the valve and its meters, 0.3, 0.25).

    Parameters
    ----------
    evidence : Evidence

    Returns
    -------
    p_value : float
        Uniform between 0 and 1 among healthy recordings like those of the reference; the stronger any look,
        the smaller. Never below 1e-12.
    """
    return p_value_of_looks(evidence.chances)


def p_value_of_looks(beyond: dict[str, float]) -> float:
    """One p-value of several looks at a recording.

    Parameters
    ----------
    beyond : dict
        Look -> share of healthy recordings in which it saw as much, or more; absent what saw nothing at all.

    Returns
    -------
    p_value : float
        Never below 1e-12.
    """
    # the share of an absent look goes to the others
    of_all = sum(_SHARES[look] for look in beyond)
    # 1 - (1 - p)^(1 / share), exact for a small p as well
    p_values = [
        -np.expm1(np.log1p(-min(share, 1.0 - 1e-16)) * of_all / _SHARES[look])
        for look, share in beyond.items()
    ]
    return float(np.clip(min(p_values), LEAST_P_VALUE, 1.0))


def p_value_of_effects(evidence: Evidence) -> float:
    """Share of healthy recordings whose strongest effect is as strong as that of this one, or stronger."""
    return mismatch_p_value(replace(evidence, residual=None))


def p_value_of_residual(evidence: Evidence) -> float:
    """Share of healthy recordings of which as much is left over as of this one, or more.

    Parameters
    ----------
    evidence : Evidence

    Returns
    -------
    p_value : float
        1 where that is not known.
    """
    return (
        1.0
        if evidence.residual is None
        else survival(evidence.law.residual, evidence.residual, evidence.covariates)
    )


def leaves_much(covariates: Covariates, problem: Problem, model: Model, channels: Collection[str]) -> bool:
    """Whether a hypothesis leaves over more since the history than may be left for a name.

    Parameters
    ----------
    covariates : Covariates
    problem : Problem
    model : Model
    channels : collection of str
        Those that are looked at.

    Returns
    -------
    much : bool
        False where it is not known what a healthy valve leaves.
    """
    if problem.history is None:
        return False
    asked = tuple(c for c in problem.channels if c in channels)
    new = left_since(problem, problem.least_squares(model), asked)
    if new is None:
        return False
    p_value = survival(law_for(problem).residual, new.effect_size, covariates)
    return not rules.history_noise(p_value).passed


def p_value_of_what_counts(findings: Sequence[Finding], tried: dict[str, Tried], problem: Problem) -> float:
    """Probability that chance lifts an effect that does not count as far above what counts.

    The hypothesis is that no effect is larger than what counts in practice: the likelihood ratio of each
    effect is taken from there on, in standard deviations of its size, and the least of the p-values is told.
    It is asked beside `mismatch_p_value`, never instead: what was selected, and of how many, is in that one.

    Parameters
    ----------
    findings : list of Finding
    tried : dict
        Effect key -> its best single fit, where nothing was found.
    problem : Problem

    Returns
    -------
    p_value : float
        Never below 1e-12: no noise model is that good.
    """
    least = problem.least
    seen = [(f.gain, f.sizes, len(f.term.effect.parameters)) for f in findings]
    if not seen:
        seen = [(each.gain, each.sizes, 2) for each in tried.values()]
    p_values = [1.0]
    for gain, sizes, parameters in seen:
        beyond = max(max(1.0 - least(c) / size, 0.0) if size > 0.0 else 0.0 for c, size in sizes.items())
        p_values.append(float(chi2.sf(2.0 * max(gain, 0.0) * beyond**2, parameters + 1)))
    return max(min(p_values), LEAST_P_VALUE)
