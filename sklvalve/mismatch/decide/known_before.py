# SPDX-License-Identifier: BSD-3-Clause
"""A name is a change only if the history was free of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.search.rivals import leading_term

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.simulation.chain import Chain

_WHY = (
    "What fits may have been there in the history already: a diagnosis of that by itself could not tell "
    "whether it was sound. A history that can, or a longer one, would settle it."
)

_WHY_OF_A_NAME = (
    "What is found may be what the explanation of the history left out: the history had a fault of its own, "
    "and how often such a name holds was not checked. Learn a history without a fault, or give a fuller data "
    "sheet."
)


def known_before(problem: Problem, judged: Judgement) -> Judgement:
    """A judgement without names that the history may have had as well.

    A history whose own diagnosis could not tell holds nothing, so that nothing says of what is there
    throughout the recording that it is new. One with a fault of its own says it only as far as the name of
    that holds. Where that name has no probability, as nobody has checked how often such names hold, what
    looks new may be what it left out. A property, such as a slow motor, is part of a sound valve. Where
    anything named begins within the recording, names stand.

    Parameters
    ----------
    problem : Problem
    judged : Judgement

    Returns
    -------
    judged : Judgement
        ``cannot_tell`` where the names are taken back.
    """
    history = problem.history
    begun = any(leading_term(f).onset is not None for f in judged.findings)
    if history is None or history.by_itself_ is None or begun or judged.verdict != "named":
        return judged
    before = history.by_itself_
    if before.verdict == "cannot_tell":
        return _taken_back(judged, _WHY)
    if before.checked or before.verdict != "named":
        return judged
    sound = before.held and _is_of_properties(history, problem.plain)
    return judged if sound else _taken_back(judged, _WHY_OF_A_NAME)


def _is_of_properties(history: ValveHistory, chain: Chain) -> bool:
    """Whether all that a history holds are properties, which a sound valve may have."""
    return all(effect.kind_of(chain, late=False) == "property" for effect in history.effects)


def _taken_back(judged: Judgement, why: str) -> Judgement:
    asked = (*judged.rules, rules.known_before(why))
    # what was proven on rows left out is of the names that go
    nameless = replace(judged.without_names("cannot_tell"), tried=None, errors=None)
    return replace(nameless, why=(*judged.why, why), rules=asked)
