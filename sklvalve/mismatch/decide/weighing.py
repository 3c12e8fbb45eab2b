# SPDX-License-Identifier: BSD-3-Clause
"""How much speaks for a mismatch: what is left over, p-values, and what they leave of the findings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide.detect import (
    Evidence,
    effect_sizes,
    law_for,
    mismatch_p_value,
    p_value_of_residual,
    p_value_of_what_counts,
)
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.residual.unknown import Unknown

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.case import Case
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.search.rivals import Finding


@dataclass(frozen=True)
class Weighed:
    """Evidence for a mismatch: what is left, p-values, whether it is enough, and what is new in it."""

    unknown: Unknown | None
    evidence: Evidence
    p_value: float
    by_chance: float | None
    enough: bool
    new: LeftSince | None


def weigh(case: Case, findings: Sequence[Finding], model: Model) -> Weighed:
    """What is left beside findings, and the evidence for a mismatch with its p-values.

    Parameters
    ----------
    case : Case
    findings : sequence of Finding
    model : Model
        With them.

    Returns
    -------
    weighed : Weighed
    """
    left = case.residual_of(model)
    strengths = effect_sizes(case.explanation, case.problem)
    evidence = Evidence.of(strengths, left.strong, case.covariates, law_for(case.problem))
    p_value = mismatch_p_value(evidence)
    rare = leaves_rare(case, evidence)
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
    # so is a change at one time, where a finding is what changed
    change = case.change_by(findings)
    if change is not None:
        p_value = min(p_value, change.p_value)
    counts = by_chance is None or by_chance <= case.alpha
    enough = counts and p_value <= case.alpha
    return Weighed(unknown, evidence, p_value, by_chance, enough, new if enough else None)


def what_evidence_leaves(
    case: Case, findings: list[Finding], model: Model
) -> tuple[list[Finding], Unknown | None, Weighed]:
    """What the evidence leaves of the findings.

    Parameters
    ----------
    case : Case
    findings : list of Finding
    model : Model
        With them.

    Returns
    -------
    findings : list of Finding
    unknown : Unknown or None
        Beside them.
    weighed : Weighed
        The evidence.
    """
    weighed = weigh(case, findings, model)
    if weighed.enough or not findings:
        return findings, weighed.unknown, weighed
    # effects too weak to be told from chance must not hide a residual that is not; what decides is what is
    # told beside it
    alone = weigh(case, [], case.explanation.nominal)
    # where the mismatch is told anyway, what is rare among healthy recordings may say what it is, and so may
    # what leaves nothing rare where too much was left over since the history
    known = case.problem.history is not None and weighed.evidence.residual is not None
    explains = known and leaves_rare(case, alone.evidence) and not leaves_rare(case, weighed.evidence)
    if alone.enough and (explains or any(map(case.is_rare, findings))):
        return findings, weighed.unknown, alone
    return [], alone.unknown, alone


def evidence_of(case: Case) -> Evidence:
    """Evidence for a mismatch, with all that is left over where no effect is taken for true.

    Parameters
    ----------
    case : Case
    """
    return weigh(case, [], case.explanation.nominal).evidence


def leaves_rare(case: Case, evidence: Evidence) -> bool:
    """Whether few healthy recordings, alpha of them, leave over as much that can be learnt.

    Parameters
    ----------
    case : Case
    evidence : Evidence
    """
    return p_value_of_residual(evidence) <= case.alpha


def _beside(findings: Sequence[Finding], unknown: Unknown | None, rare: bool) -> Unknown | None:
    """An unknown, where it is rare among healthy recordings or no finding stands beside it."""
    cycle = unknown is not None and unknown.period is not None
    return unknown if rare or cycle or not findings else None
