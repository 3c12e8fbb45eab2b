# SPDX-License-Identifier: BSD-3-Clause
"""A history as plain numbers, texts and arrays, and back: a part a file.

Every part of `PARTS` is a module with three functions: ``told(history)`` gives the part's plain data,
``require_sound(part, whole, effects)`` refuses what no history has, and ``put_back(history, part)`` sets the
attributes again, in the order of the parts. One more part is one more file and one more line.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from sklvalve.history.state import calibration, clean, recordings, rehearsed, settings, visited, windows
from sklvalve.simulation.state import mapping

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

PARTS: dict[str, Any] = {
    "settings": settings,
    "calibration": calibration,
    "windows": windows,
    "recordings": recordings,
    "range": visited,
    "clean": clean,
    "rehearsals": rehearsed,
}


def told(history: ValveHistory) -> dict[str, Any]:
    """Everything of a fitted history but its valve.

    Parameters
    ----------
    history : ValveHistory

    Returns
    -------
    state : dict
        Part -> dict of plain numbers, texts, lists and arrays.
    """
    return {name: part.told(history) for name, part in PARTS.items()}


def put_back(history: ValveHistory, state: dict[str, Any]) -> None:
    """Give a history without a fit the attributes of one.

    Parameters
    ----------
    history : ValveHistory
        With `valve_`, settings and effects.
    state : dict
        Of `told`.
    """
    for name, part in PARTS.items():
        part.put_back(history, state[name])


def require_sound_history(state: Any, effects: Sequence[Any]) -> None:
    """Refuse a state whose numbers, shapes or names no history has.

    Parameters
    ----------
    state : object
        What `ValveHistory.to_state` gave, as it was read back.
    effects : sequence of Effect
        Those that its keys name.

    Raises
    ------
    ValueError
        With a few words that name the part.
    """
    for name, part in PARTS.items():
        part.require_sound(mapping(state, name), state, effects)
