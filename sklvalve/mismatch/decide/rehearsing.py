# SPDX-License-Identifier: BSD-3-Clause
"""One part of a history held against another, as far as evidence goes: what a valve does by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sklvalve.history.rehearsal import Rehearsal
from sklvalve.mismatch.decide.case import Case
from sklvalve.mismatch.decide.compare import EMPTY
from sklvalve.mismatch.decide.detect import covariates_of, p_value_of_looks
from sklvalve.mismatch.decide.null_reference import AGAINST_HISTORY, share_beyond
from sklvalve.mismatch.decide.weighing import evidence_of
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.search.explain import explain

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.detect import Evidence
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.problem import Problem


def rehearsed(
    problem: Problem,
    effects: Sequence[Effect],
    data: Sequence[dict[str, Any]],
    *,
    threshold: float,
    alpha: float,
    random_state: int,
) -> Rehearsal:
    """How far a part of a history lies from the history of another part of it.

    Only the first effect is searched: the strongest is what evidence is made of, and nothing is named.

    Parameters
    ----------
    problem : Problem
        Of the part, with the other part as its history.
    effects : sequence of Effect
        Candidates.
    data : list of dict
        Findings of `screen_recording` of the part.
    threshold : float
        As `explain` takes it.
    alpha : float
        Level of the test.
    random_state : int

    Returns
    -------
    rehearsal : Rehearsal
    """
    problem, nominal = calibrated(problem)
    covariates = covariates_of(problem, data)
    explanation = explain(problem, nominal, effects, threshold=threshold, most=1)
    return rehearsal_of(evidence_of(Case(explanation, covariates, EMPTY, alpha, random_state)))


def rehearsal_of(evidence: Evidence) -> Rehearsal:
    """Evidence relative to what is typical of healthy valves.

    Parameters
    ----------
    evidence : Evidence
        Of a recording that was held against a history.
    """
    tables, covariates = evidence.law.tables, evidence.covariates
    seen = {look: value for look, value in evidence.looks.items() if value is not None}
    return Rehearsal(**{look: value / tables[look].typical(covariates) for look, value in seen.items()})


def p_value_of_rehearsal(rehearsal: Rehearsal) -> float:
    """Share of healthy recordings of the null reference that lie as far from their history, or further.

    Parameters
    ----------
    rehearsal : Rehearsal

    Returns
    -------
    p_value : float
    """
    tables = AGAINST_HISTORY.tables
    seen = {look: value for look, value in asdict(rehearsal).items() if value is not None and look in tables}
    beyond = {look: share_beyond(tables[look], value) for look, value in seen.items()}
    return p_value_of_looks(beyond)
