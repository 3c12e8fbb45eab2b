# SPDX-License-Identifier: BSD-3-Clause
"""A name is a change only if the history was free of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide.checked_kind import unchecked

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem

_WHY = (
    "What fits may have been there in the history already: a diagnosis of that by itself could not tell "
    "whether it was sound. A history that can, or a longer one, would settle it."
)


def known_before(problem: Problem, judged: Judgement) -> Judgement:
    """A judgement without names that the history may have had as well.

    A history whose own diagnosis could not tell holds nothing, so that nothing says of what is there
    throughout the recording that it is new. One that was explained by a name says it only as far as such
    names hold, and on some kinds of recordings that was not checked: what looks new may be what the name
    left out. What begins within the recording is new in any case.

    Parameters
    ----------
    problem : Problem
    judged : Judgement

    Returns
    -------
    judged : Judgement
        ``cannot_tell`` where the names are taken back.
    """
    why = _doubt(problem)
    if not why or judged.verdict != "named" or any(f.term.onset is not None for f in judged.findings):
        return judged
    return replace(judged.without_names("cannot_tell"), why=(*judged.why, why))


def _doubt(problem: Problem) -> str:
    """Why the history does not tell what is new, for people; empty where it does."""
    before = None if problem.history is None else problem.history.by_itself_
    if before is None or before.clean:
        return ""
    if before.verdict == "cannot_tell":
        return _WHY
    kind = unchecked(problem)
    if before.verdict != "named" or not kind:
        return ""
    return (
        "What fits may be what the explanation of the history left out: the history was not sound, and how "
        f"often a name holds was not checked for {kind}. Declare in valve.toml what the valve has had all "
        "along, or give a history in which nothing is missing."
    )
