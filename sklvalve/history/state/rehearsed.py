# SPDX-License-Identifier: BSD-3-Clause
"""How far parts of the recordings of a history lie from each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sklvalve.history.rehearsal import Rehearsal
from sklvalve.simulation.state import number

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_STRENGTHS = ("throughout", "stem", "within")


def told(history: ValveHistory) -> dict[str, Any]:
    """Strengths of each rehearsal [1]."""
    return {"each": [asdict(rehearsal) for rehearsal in history.rehearsals_]}


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set them again."""
    history.rehearsals_ = [Rehearsal.from_dict(each) for each in part["each"]]


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse strengths that are none; ``ValueError``."""
    several = part.get("each")
    if not isinstance(several, list | tuple):
        raise ValueError("its rehearsals are none")
    for each in several:
        try:
            looks = asdict(Rehearsal.from_dict(each))
        except (AttributeError, TypeError):
            raise ValueError("a rehearsal of it is none") from None
        if len(each) < len(looks):
            raise ValueError("a rehearsal of it lacks looks")
        for look in _STRENGTHS:
            number(looks[look], "the strength of a rehearsal", 0.0)
        if looks["residual"] is not None:
            number(looks["residual"], "what a rehearsal left over", 0.0)
