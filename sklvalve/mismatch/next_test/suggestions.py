# SPDX-License-Identifier: BSD-3-Clause
"""What to do at the valve to learn more."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.next_test.planning import planned
from sklvalve.mismatch.residual.goodness_of_fit import LeftOver
from sklvalve.mismatch.residual.pulses import Pulses
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.residual.smooth_pattern import Pattern
from sklvalve.mismatch.residual.unknown import Unknown

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.next_test.plan import TestPlan
    from sklvalve.mismatch.search.rivals import Finding

# of what comes and goes in a channel and follows from nothing recorded
_CAUSES = {
    "opening": "the air supply, the positioner or what shakes the valve",
    "flow": "pumps, gas, deposits or the meter",
}


def next_test(
    classes: Sequence[dict[str, tuple[float, Term, Model]]],
    verdict: str,
    unknown: Unknown | LeftOver | LeftSince | Pulses | Pattern | None,
    problem: Problem,
    plan: TestPlan | None = None,
) -> str | None:
    """The test that separates what is left open, or that confirms what was found, as plain text.

    Parameters
    ----------
    classes : list of dict
        Classes as `class_of` gives them.
    verdict : str
    unknown : Unknown, LeftOver, LeftSince, Pulses, Pattern or None
    problem : Problem
    plan : TestPlan or None, default=None
        The one that simulations have shown to tell most (`plan_of`); its words go before the catalogue's.

    Returns
    -------
    sentence : str or None
    """
    if plan is not None:
        return plan.sentence
    open_ones = [c for c in classes if len(c) > 1]
    for explanations in open_ones or classes:
        term = next(iter(explanations.values()))[1]
        return term.effect.separated_by
    if isinstance(unknown, LeftOver | LeftSince | Pulses) or (
        isinstance(unknown, Pattern) and not unknown.inputs
    ):
        return _held(_CAUSES[unknown.channel])
    if isinstance(unknown, Unknown) and unknown.period is not None:
        return (
            f"Look for something that repeats every {unknown.period:.3g} s, such as a pump, another loop or "
            "a batch. Record it, or record the valve while it is off."
        )
    if unknown is not None:
        inputs = " and ".join(f"the {name.replace('_', ' ')}" for name in unknown.inputs)
        return f"Sweep {inputs} slowly up and down, at three levels of the other signals."
    if verdict == "no_mismatch" and "opening" not in problem.recording:
        return (
            "Record the stem position too: without it a fault of the actuator cannot be distinguished from "
            "one of the trim."
        )
    return None


def plan_of(problem: Problem, findings: Sequence[Finding]) -> TestPlan | None:
    """The test that is expected to tell most of what these findings leave open.

    Parameters
    ----------
    problem : Problem
    findings : sequence of Finding

    Returns
    -------
    plan : TestPlan or None
        None where none can be planned.
    """
    try:
        return planned(problem, findings)
    except Exception:  # advice on the next recording must not cost the diagnosis of this one
        return None


def _held(causes: str) -> str:
    return (
        "Hold the command for half an hour and keep recording: what still varies depends on something "
        f"not recorded. Record what may cause it, such as {causes}."
    )
