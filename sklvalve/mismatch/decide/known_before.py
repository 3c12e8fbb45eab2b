# SPDX-License-Identifier: BSD-3-Clause
"""What is found is a change only if the history was free of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.checked_kind import unchecked

if TYPE_CHECKING:
    from sklvalve.history import ByItself
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem

_WHY = (
    "What fits may have been there in the history already: a diagnosis of that by itself could not tell "
    "whether it was sound. A history that can, or a longer one, would settle it."
)

_WHY_OF_KIND = (
    "What is found may be what the explanation of the history left out: the history had a fault of its own, "
    "and how often a name holds was not checked for {kind}. Learn a history without a fault, or give a "
    "fuller data sheet."
)


def known_before(problem: Problem, judged: Judgement) -> Judgement:
    """A judgement without what the history may have had as well.

    A history whose own diagnosis could not tell holds nothing, so that nothing says of what is there
    throughout the recording that it is new. One with a fault of its own says it only as far as the name of
    that holds, and on some kinds of recordings it was not checked how often names do: what looks new, with a
    name or without, may be what that name left out. A property, such as a slow motor, is part of a sound
    valve. What begins within the recording is new in any case.

    Parameters
    ----------
    problem : Problem
    judged : Judgement

    Returns
    -------
    judged : Judgement
        ``cannot_tell`` where something is taken back.
    """
    before = None if problem.history is None else problem.history.by_itself_
    if before is None or any(f.term.onset is not None for f in judged.findings):
        return judged
    if before.verdict == "cannot_tell" and judged.verdict == "named":
        return _taken_back(judged, _WHY)
    kind = unchecked(problem) if before.verdict == "named" and _had_a_fault(problem, before) else ""
    new = judged.verdict == "named" or (judged.verdict == "none_of_these" and judged.change is None)
    if not kind or not new:
        return judged
    nameless = replace(judged, unknown=None, left=None, pulses=None, closest=[], closest_leaves=None)
    return _taken_back(nameless, _WHY_OF_KIND.format(kind=kind))


def _had_a_fault(problem: Problem, before: ByItself) -> bool:
    """Whether more than properties explains the history, as far as it holds what was named."""
    effects = () if problem.history is None else problem.history.effects
    return not before.held or any(e.kind_of(problem.plain, late=False) != "property" for e in effects)


def _taken_back(judged: Judgement, why: str) -> Judgement:
    asked = (*judged.rules, rules.known_before(why))
    return replace(judged.without_names("cannot_tell"), why=(*judged.why, why), rules=asked)
