# SPDX-License-Identifier: BSD-3-Clause
"""What is found is a change only if the history was free of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.checked_kind import unchecked

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem

_WHY = (
    "What fits may have been there in the history already: a diagnosis of that by itself could not tell "
    "whether it was sound. A history that can, or a longer one, would settle it."
)

_WHY_OF_KIND = (
    "What is found may be what the explanation of the history left out: the history was not sound, and how "
    "often a name holds was not checked for {kind}. Declare in valve.toml what the valve has had all along, "
    "or give a history in which nothing is missing."
)


def known_before(problem: Problem, judged: Judgement) -> Judgement:
    """A judgement without what the history may have had as well.

    A history whose own diagnosis could not tell holds nothing, so that nothing says of what is there
    throughout the recording that it is new. One that was explained by a name says it only as far as such
    names hold, and on some kinds of recordings that was not checked: what looks new, with a name or without,
    may be what the name left out. What begins within the recording is new in any case.

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
    kind = unchecked(problem) if before.verdict == "named" else ""
    new = judged.verdict == "named" or (judged.verdict == "none_of_these" and judged.change is None)
    if not kind or not new:
        return judged
    nameless = replace(judged, unknown=None, left=None, pulses=None, closest=[], closest_leaves=None)
    return _taken_back(nameless, _WHY_OF_KIND.format(kind=kind))


def _taken_back(judged: Judgement, why: str) -> Judgement:
    asked = (*judged.rules, rules.known_before(why))
    return replace(judged.without_names("cannot_tell"), why=(*judged.why, why), rules=asked)
