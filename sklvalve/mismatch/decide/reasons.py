# SPDX-License-Identifier: BSD-3-Clause
"""Why a diagnosis names nothing: which check stopped it, how far off it was, and what would change it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sklvalve.mismatch.residual.smooth_pattern import Pattern
from sklvalve.mismatch.search.rivals import class_of

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.goodness_of_fit import LeftOver
    from sklvalve.mismatch.residual.since_history import LeftSince
    from sklvalve.mismatch.search.rivals import Finding

# of a larger class the likeliest are named
_MANY = 4
_NAMELESS = ("cannot_tell", "none_of_these")


def not_upheld(findings: Sequence[Finding]) -> str:
    """The reason where rows that a fit had not seen speak against all that was found."""
    return (
        f"{_begun(_names(findings))} fits all rows, but does not predict rows left out of the fit: it "
        "gains too little there, or in one event only. A longer recording with more movement would settle it."
    )


def too_much_left(left: LeftOver, findings: Sequence[Finding], problem: Problem) -> str:
    """The reason where the flow is further off than noise allows, in the recording's own unit."""
    what = f"With {_names(findings)} the simulation" if findings else "The simulation"
    size, allowed = (in_recorded(problem, left.channel, share) for share in (left.size, left.allowed))
    return (
        f"{what} is off by {size} where the {left.channel} is steady, {left.times:.2g} times the {allowed} "
        "that noise and tolerances allow. A fuller data sheet, or a signal that is not recorded, may "
        "show why."
    )


def exceeds_noise(left: LeftSince, findings: Sequence[Finding], problem: Problem) -> str:
    """The reason where findings leave over what the noise of the history cannot be."""
    size, allowed = (in_recorded(problem, left.channel, share) for share in (left.size, left.allowed))
    return (
        f"With {_names(findings)} the simulation's {left.channel} is still off by {size} within about "
        f"{left.rows} rows, where the history's noise and the errors of such a simulation come to {allowed}. "
        "Something else has changed, or more than that."
    )


def leaves_pattern(pattern: Pattern, findings: Sequence[Finding], problem: Problem) -> str:
    """The reason where findings leave a smooth pattern that no effect makes."""
    size = in_recorded(problem, pattern.channel, pattern.size)
    return (
        f"With {_names(findings)} the simulation's {pattern.channel} is still off by {size}, smoothly over "
        f"{pattern.over}, by more than the history's noise and the errors of such a simulation. No effect "
        "that was tried makes it."
    )


def differs_too(judgement: Judgement, problem: Problem) -> list[str]:
    """The sentence on a signal that nothing named changes, and that differs from the history; else none."""
    left = judgement.also
    if left is None or left.channel in problem.touched_by(f.term for f in judgement.findings):
        return []
    size = in_recorded(problem, left.channel, left.size)
    if isinstance(left, Pattern):
        shown = f"as a smooth pattern over {left.over}"
    else:
        allowed = in_recorded(problem, left.channel, left.allowed)
        shown = f"within about {left.rows} rows, where its noise comes to {allowed}"
    return [
        f"The {left.channel} differs from the history too, by {size} {shown}: something else has changed, "
        "and nothing that is named explains it."
    ]


def in_recorded(problem: Problem, channel: str, share: float) -> str:
    """A share of a channel's span in words, in the unit in which it was recorded."""
    recording = problem.recording
    size = share * problem.spans[channel] * abs(recording.per_si(channel))
    unit = recording.unit(channel)
    return f"{100.0 * size:.2g} % of travel" if unit == "1" else f"{size:.2g} {unit}"


def reasons_of(
    judgement: Judgement, data_to_correct: str | None, problem: Problem, doubts: Sequence[str] = ()
) -> list[str]:
    """Reasons of a verdict, in plain sentences.

    Parameters
    ----------
    judgement : Judgement
    data_to_correct : str or None
        What must be done to the data first.
    problem : Problem
    doubts : sequence of str
        Why what was found is too weak for a name.

    Returns
    -------
    reasons : list of str
    """
    if data_to_correct:
        return [data_to_correct]
    compared = [] if judgement.referee is None else list(judgement.referee.reasons)
    if judgement.verdict not in _NAMELESS:
        return [*doubts, *differs_too(judgement, problem), *compared]
    reasons = [*judgement.why, *doubts]
    if judgement.strays is not None:
        reasons.append(judgement.strays.reason)
    if judgement.event is not None and not judgement.names_event:
        reasons.append(
            "The last rows were compared with a simulation fitted to the rows before them: no effect that "
            "was tried explains half of the difference. A longer recording would tell more."
        )
    elif judgement.change is not None:
        reasons.append(
            f"The {judgement.change.channel} changed at one time, and no effect that was tried can be named "
            "for it."
        )
    if judgement.pulses is not None:
        reasons.append(judgement.pulses.reason)
    unknown = judgement.unknown
    if unknown is not None:
        size = in_recorded(problem, unknown.channel, unknown.size)
        reasons.append(
            # what an effect leaves of it is told already
            f"The {unknown.channel} deviates predictably by {size}."
            if judgement.pattern is not None
            else f"No effect that was tried accounts for a predictable deviation of the {unknown.channel} by "
            f"{size}."
        )
    reasons += compared
    return reasons or [
        "Simulation and recording differ by more than chance, but no single effect that was tried explains "
        "enough to be named."
    ]


def _names(findings: Sequence[Finding]) -> str:
    """Names of what was found; of a large class the likeliest."""
    parts = []
    for finding in findings:
        names = [name.replace("_", " ") for name in class_of(finding)]
        if len(names) > _MANY:
            names = [*names[: _MANY - 1], f"one of {len(names) - _MANY + 1} others"]
        parts.append(" or ".join(names))
    return " and ".join(parts) or "the explanation"


def _begun(words: str) -> str:
    return words[:1].upper() + words[1:]
