# SPDX-License-Identifier: BSD-3-Clause
"""What was made of a recording, as one frozen object that later steps add to."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide.compare import EMPTY, Comparison
from sklvalve.mismatch.decide.rules import Rule
from sklvalve.mismatch.proof.held_out import correction_holds_out, cross_validated

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.detect import Evidence
    from sklvalve.mismatch.decide.detection_limits import DetectionLimit
    from sklvalve.mismatch.decide.referee import Referee
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.proof.held_out import CrossValidated
    from sklvalve.mismatch.residual.change import Change
    from sklvalve.mismatch.residual.goodness_of_fit import LeftOver
    from sklvalve.mismatch.residual.pulses import Pulses
    from sklvalve.mismatch.residual.since_history import LeftSince
    from sklvalve.mismatch.residual.smooth_pattern import Pattern
    from sklvalve.mismatch.residual.stem_residual import StemResidual
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.mismatch.search.rivals import Finding


@dataclass(frozen=True, eq=False)
class Judgement:
    """What was made of a recording.

    Attributes
    ----------
    problem : Problem
        What was judged, and the noise that it was judged by.
    verdict : str
    p_value : float or None
        None where nothing was asked, because the data must be mended first.
    findings : list of Finding
    unknown : Unknown or None
    nominal, model : Model
        The simulation calibrated without and with the findings.
    tried : CrossValidated or None
        `model` with the learnt rest, block by block, where there is a rest.
    kept : bool
        Whether the learnt rest lowers the error of rows it was not learnt from, so that it is added.
    errors : tuple of float or None
        Rms of the unknown's channel on such rows, without and with the learnt rest [SI].
    evidence : Evidence or None
        What the p-value was made of.
    left : LeftOver, LeftSince or None
        What the simulation without any effect leaves over of the flow, where that is missing physics, and no
        effect explains it well enough to be named.
    closest : list of Finding
        Those that come closest to it.
    closest_leaves : LeftOver or None
        What they leave over of it.
    strays : StemResidual or None
        Where the stem is further off than any sound one, and nothing that was tried tells why.
    pulses : Pulses or None
        Where the flow breaks out to one side, again and again, and no noise does.
    suspects : tuple of str
        Blocks of the effects that come near, each by itself, to explaining what was found; sorted.
    suspected : Model or None
        The hypothesis of the search, where none of it may be named: it tells in which rows something is.
    referee : Referee or None
        The black box that the verdict was held against; None where nothing was asked.
    change : Change or None
        When a signal changed, whatever made it.
    event : Change or None
        The same where it is one of the last rows, which were judged by themselves.
    why : tuple of str
        Checks that stopped a name, in words.
    also : LeftSince, Pattern or None
        What differs from the history in a signal that no finding of the search changes.
    comparison : Comparison
        All hypotheses that were compared.
    pattern : Pattern or None
        A smooth pattern since the history, for which what was found is no name.
    rules : tuple of Rule
        Those that were asked, in turn.
    limits : tuple of DetectionLimit
        What of each effect might have gone unnoticed, where nothing was found.
    """

    problem: Problem
    verdict: str
    p_value: float | None
    findings: list[Finding]
    unknown: Unknown | None
    nominal: Model
    model: Model
    tried: CrossValidated | None = None
    kept: bool = False
    errors: tuple | None = None
    evidence: Evidence | None = None
    left: LeftOver | LeftSince | None = None
    closest: list[Finding] = field(default_factory=list)
    closest_leaves: LeftOver | None = None
    strays: StemResidual | None = None
    pulses: Pulses | None = None
    suspects: tuple[str, ...] = ()
    suspected: Model | None = None
    referee: Referee | None = None
    change: Change | None = None
    event: Change | None = None
    why: tuple[str, ...] = ()
    also: LeftSince | Pattern | None = None
    comparison: Comparison = EMPTY
    pattern: Pattern | None = None
    rules: tuple[Rule, ...] = ()
    limits: tuple[DetectionLimit, ...] = ()

    def without_names(self, verdict: str) -> Judgement:
        """The same with another verdict and no finding; what was found shows where it is all the same.

        Parameters
        ----------
        verdict : {"none_of_these", "cannot_tell"}
        """
        return replace(
            self, verdict=verdict, findings=[], model=self.nominal, suspected=self.model, kept=False
        )

    @property
    def names_event(self) -> bool:
        """Whether what happened in the last rows has a name."""
        if self.event is None:
            return False
        first = self.model.chain.clock[self.event.within[0]]
        return any(f.term.onset is not None and f.term.onset >= first for f in self.findings)

    @property
    def detected(self) -> bool:
        """Whether anything is missing."""
        return self.verdict != "no_mismatch" and self.p_value is not None

    @property
    def correction(self) -> dict | None:
        """The learnt rest that joins the corrected simulation; None where there is none."""
        return self.unknown.correction if self.kept and self.unknown is not None else None


def with_learnt(judgement: Judgement) -> Judgement:
    """A judgement with what is learnt of its unknown, and whether that holds out.

    Parameters
    ----------
    judgement : Judgement

    Returns
    -------
    judgement : Judgement
        With ``tried, kept, errors``; without them where there is no unknown.
    """
    unknown = judgement.unknown
    if unknown is None:
        return replace(judgement, tried=None)
    tried = cross_validated(judgement.problem, judgement.model, unknown)
    kept, errors = correction_holds_out(judgement.problem, tried, unknown.channel)
    return replace(judgement, tried=tried, kept=kept, errors=errors)
