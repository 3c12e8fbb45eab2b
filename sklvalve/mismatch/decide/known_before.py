# SPDX-License-Identifier: BSD-3-Clause
"""A name is a change only if the history was free of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

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
    throughout the recording that it is new. What begins within the recording is new in any case.

    Parameters
    ----------
    problem : Problem
    judged : Judgement

    Returns
    -------
    judged : Judgement
        ``cannot_tell`` where the names are taken back.
    """
    before = None if problem.history is None else problem.history.by_itself_
    unsure = before is not None and before.verdict == "cannot_tell"
    if not unsure or judged.verdict != "named" or any(f.term.onset is not None for f in judged.findings):
        return judged
    return replace(judged.without_names("cannot_tell"), why=(*judged.why, _WHY))
