# SPDX-License-Identifier: BSD-3-Clause
"""What a judgement is made on: the search, its table, and what each of its hypotheses leaves over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.decide.detect import p_value_of_one
from sklvalve.mismatch.proof.held_out import correction_holds_out, cross_validated
from sklvalve.mismatch.residual.change import Change, find_changes, stands_out
from sklvalve.mismatch.residual.since_history import LeftSince, left_since
from sklvalve.mismatch.residual.smooth_pattern import Pattern, pattern_left
from sklvalve.mismatch.residual.unknown import Unknown, look_for_residual
from sklvalve.mismatch.search.rivals import leading_term

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.compare import Comparison
    from sklvalve.mismatch.decide.null_reference import Covariates
    from sklvalve.mismatch.inference.hypothesis import Model, Term
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.explain import Explanation
    from sklvalve.mismatch.search.rivals import Finding

# a residual of so many times what counts needs no further proof
_LARGE = 2.0


@dataclass(frozen=True, eq=False)
class Residual:
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

    def residual_of(self, model: Model) -> Residual:
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
            self._residuals[model] = Residual(fitted, unknown if stands else None, strong, new)
        return self._residuals[model]

    def left_where_they_act(
        self, findings: Sequence[Finding], model: Model
    ) -> tuple[LeftSince | None, Pattern | None]:
        """What is left since the history in the signals that some findings change, in blocks and smoothly.

        What is left of another signal is something else that is missing.
        """
        touched = self.problem.touched_by(f.term for f in findings)
        asked = self.problem.channels if self.channels is None else self.channels
        asked = tuple(c for c in asked if c in touched)
        fitted = self.residual_of(model).fitted
        return left_since(self.problem, fitted, asked), pattern_left(self.problem, fitted, asked)

    def change_by(self, findings: Sequence[Finding]) -> Change | None:
        """The clearest change at one time that stands out and that one of some findings makes.

        That one begins or ends with the change, and changes its signal by what counts.
        """
        terms = [(f, leading_term(f)) for f in findings]
        begun = [(f, t) for f, t in terms if t.onset is not None and not t.effect.grows]
        made = [c for f, t in begun for c in self._changes if self._makes(c, f, t)]
        return min(made, key=lambda change: change.p_value, default=None)

    def _makes(self, change: Change, finding: Finding, term: Term) -> bool:
        rows = np.searchsorted(self.explanation.nominal.chain.clock, np.atleast_1d(term.times))
        # either tells the row to one at best
        then = np.any((change.within[0] - 1 <= rows) & (rows <= change.within[1] + 1))
        return bool(then) and finding.sizes.get(change.channel, 0.0) >= self.problem.least(change.channel)

    @cached_property
    def _changes(self) -> tuple[Change, ...]:
        """Changes that the simulation without effects leaves over, where they stand out."""
        changes = find_changes(self.problem, self.explanation.nominal)
        asked = self.problem.channels if self.channels is None else self.channels
        return tuple(c for c in changes if c.channel in asked and stands_out(self.problem, c, self.alpha))

    def is_rare(self, finding: Finding, level: float | None = None) -> bool:
        """Whether few healthy recordings, alpha of them unless told, show any effect as strong."""
        level = self.alpha if level is None else level
        return p_value_of_one(finding, self.problem, self.covariates) <= level

    def held_out_gain(self, finding: Finding) -> float:
        """Gain of a finding on rows left out of its fit, in standard errors."""
        return self.comparison.held_out_errors(1 + self.explanation.findings.index(finding))


def _stands(problem: Problem, model: Model, unknown: Unknown) -> bool:
    """Whether a residual is large, or, once learnt, predicts blocks that it was not learnt from.

    What is hardly larger than what counts, and no help elsewhere, may be a slow chance of the noise.
    """
    if unknown.size >= _LARGE * problem.least(unknown.channel):
        return True
    tried = cross_validated(problem, model, unknown)
    return correction_holds_out(problem, tried, unknown.channel)[0]
