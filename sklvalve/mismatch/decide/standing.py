# SPDX-License-Identifier: BSD-3-Clause
"""Which findings may be named: what is rare, gains on rows left out, and explains its signals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

from sklvalve.mismatch.constants import HELD_OUT_ERRORS
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.detect import Evidence, p_value_of_residual
from sklvalve.mismatch.decide.reasons import exceeds_noise, leaves_pattern, not_upheld
from sklvalve.mismatch.decide.weighing import leaves_rare
from sklvalve.mismatch.residual.smooth_pattern import Pattern
from sklvalve.simulation.given import ACTUATOR_STAGES

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.case import Case
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.since_history import LeftSince
    from sklvalve.mismatch.search.rivals import Finding

# of the level of an alarm, what is named beside a stronger effect of the same signals
_BESIDE = 0.1


def upheld(case: Case, findings: Sequence[Finding], model: Model) -> tuple[list[Finding], Model]:
    """The strongest finding and those beside it that may be named, and the model with them.

    One mismatch makes others look likely, for no effect is simulated just as it is. What is rarer than an
    alarm and gains on rows left out is named in signals of its own; to be named beside a stronger one of the
    same signals it must be ten times as rare.

    Parameters
    ----------
    case : Case
    findings : sequence of Finding
        The strongest first.
    model : Model
        With all of them.

    Returns
    -------
    stand : list of Finding
    model : Model
        With these.
    """
    if not findings:
        return [], model
    stand = [findings[0]]
    for finding in findings[1:]:
        level = case.alpha if _shows_alone(case.problem, finding, stand) else _BESIDE * case.alpha
        if case.held_out_gain(finding) >= HELD_OUT_ERRORS and case.is_rare(finding, level):
            stand.append(finding)
    return stand, fitted_with(case, stand, findings, model)


def fitted_with(case: Case, stand: Sequence[Finding], findings: Sequence[Finding], model: Model) -> Model:
    """The model of some findings with those of them that stand.

    Parameters
    ----------
    case : Case
    stand, findings : sequence of Finding
        Those that stand, and all.
    model : Model
        With all of them.
    """
    if len(stand) == len(findings):
        return model
    return case.problem.fit(tuple(f.term for f in stand), start=model)


def _shows_alone(problem: Problem, finding: Finding, stronger: Sequence[Finding]) -> bool:
    """Whether a finding shows in no signal in which a stronger one does."""
    if problem.coupled:
        return False
    elsewhere = problem.touched_by(f.term for f in stronger)
    return elsewhere.isdisjoint(problem.touched_by([finding.term]))


@dataclass(frozen=True)
class Fit:
    """What rules on the fit of findings leave of these.

    Attributes
    ----------
    asked : tuple of Rule
    kept : list of Finding
        Those that may be named.
    why : str
        Why none may; empty where some may.
    pattern : Pattern or None
        What none may be named for, where it is a smooth pattern that no effect makes.
    beside : LeftSince, Pattern or None
        What differs from the history in the signals of those that may not.
    """

    asked: tuple[rules.Rule, ...] = ()
    kept: list[Finding] = field(default_factory=list)
    why: str = ""
    pattern: Pattern | None = None
    beside: LeftSince | Pattern | None = None


@dataclass(frozen=True)
class _Held:
    """Findings of the same signals, held against the noise of a history, and what they leave of it."""

    findings: list[Finding]
    asked: tuple[rules.Rule, ...]
    new: LeftSince | None
    pattern: Pattern | None

    @property
    def passed(self) -> bool:
        return all(rule.passed for rule in self.asked)

    def imitates(self, problem: Problem) -> bool:
        """Whether a smooth pattern that no effect makes is left."""
        if self.pattern is None or self.asked[-1].passed:
            return False
        # a stem that hunts is not simulated in phase: what an effect on it leaves need not be of no catalogue
        of_stem = problem.touched_by(f.term for f in self.findings if f.stage in ACTUATOR_STAGES)
        return self.pattern.channel not in of_stem

    @property
    def too_much(self) -> LeftSince | Pattern | None:
        """What is left of which there may not be so much."""
        if self.passed:
            return None
        return self.new if self.new is not None and not self.asked[0].passed else self.pattern

    def why(self, problem: Problem) -> str:
        """Why they may not be named, in a sentence."""
        left = self.too_much
        if isinstance(left, Pattern):
            return leaves_pattern(left, self.findings, problem)
        return exceeds_noise(cast("LeftSince", left), self.findings, problem)


def fit_of(case: Case, findings: Sequence[Finding], model: Model, evidence: Evidence) -> Fit:
    """Rules on the fit of findings: what they leave since a history, and what rows left out gain by them.

    An imitation leaves over what healthy valves do not, in the signals that it is to explain. What explains
    signals of its own is none for that.

    Parameters
    ----------
    case : Case
    findings : sequence of Finding
        The strongest first, one at least.
    model : Model
        With all of them.
    evidence : Evidence
    """
    groups = [_held_to_history(case, some, model, evidence) for some in _by_signals(case.problem, findings)]
    refused = [group for group in groups if not group.passed]
    kept = [f for f in findings if not any(f in group.findings for group in refused)]
    held_out = rules.held_out(case.held_out_gain((kept or findings)[0]))
    if not held_out.passed:
        # blocks that the fit had not seen speak against it: no name is better than a wrong one
        return Fit((held_out,), why=not_upheld(kept or findings))
    if kept:
        passed = next((group.asked for group in groups if group.passed and group.asked), ())
        return Fit((held_out, *passed), kept, beside=refused[0].too_much if refused else None)
    imitating = [group for group in refused if group.imitates(case.problem)]
    group = (imitating or refused)[0]
    pattern = group.pattern if imitating else None
    return Fit((held_out, *group.asked), why=group.why(case.problem), pattern=pattern)


def _held_to_history(case: Case, findings: list[Finding], model: Model, evidence: Evidence) -> _Held:
    """What findings leave since the history, quick or slow and as a smooth pattern; nothing where unknown."""
    new, pattern = case.left_where_they_act(findings, model)
    asked = []
    if new is not None:
        asked.append(rules.history_noise(p_value_of_residual(replace(evidence, residual=new.effect_size))))
    if pattern is not None:
        asked.append(rules.pattern(pattern.posterior, pattern.over))
    return _Held(findings, tuple(asked), new, pattern)


def _by_signals(problem: Problem, findings: Sequence[Finding]) -> list[list[Finding]]:
    """Findings in groups of which each has signals of its own; one group where any two share some."""
    groups: dict[frozenset[str], list[Finding]] = {}
    for finding in findings:
        groups.setdefault(frozenset(problem.touched_by([finding.term])), []).append(finding)
    alone = sum(map(len, groups)) == len(frozenset().union(*groups))
    return list(groups.values()) if alone else [list(findings)]


def elsewhere(case: Case, findings: Sequence[Finding], model: Model, evidence: Evidence) -> LeftSince | None:
    """What differs from the history in a signal that no finding changes.

    Parameters
    ----------
    case : Case
    findings : sequence of Finding
    model : Model
        With them.
    evidence : Evidence

    Returns
    -------
    new : LeftSince or None
        None where nothing rare does.
    """
    new = case.residual_of(model).new
    if new is None or new.channel in case.problem.touched_by(f.term for f in findings):
        return None
    return new if leaves_rare(case, replace(evidence, residual=new.effect_size)) else None
