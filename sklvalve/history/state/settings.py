# SPDX-License-Identifier: BSD-3-Clause
"""What a history was told before it learnt: tolerance, allowance, effects and their onsets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from sklvalve.history.allowance import Allowance
from sklvalve.simulation.state import mapping, number, require_sound_onsets
from sklvalve.simulation.tolerance import Tolerance
from sklvalve.simulation.trim_state import onsets_of_state

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_KINDS: dict[str, type] = {"tolerance": Tolerance, "allowance": Allowance}
_SMALLEST, _LARGEST = 1e-9, 1e6


def told(history: ValveHistory) -> dict[str, Any]:
    """Numbers of tolerance and allowance, None where the defaults hold, keys of effects, and onsets [s]."""
    given = {name: getattr(history, name) for name in _KINDS}
    return {name: None if each is None else asdict(each) for name, each in given.items()} | {
        "effects": [effect.key for effect in history.effects],
        "onsets": dict(history.onsets or {}),
    }


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse settings that no history has; ``ValueError``."""
    for name, kind in _KINDS.items():
        if part.get(name) is None:
            continue
        known = {each.name for each in fields(kind)}
        for key, value in mapping(part, name).items():
            if key not in known:
                raise ValueError(f"the {name} holds what is none")
            number(value, f"{key} of the {name}", _SMALLEST, _LARGEST)
    if part.get("effects") != [effect.key for effect in effects]:
        raise ValueError("its effects are others than given")
    require_sound_onsets(mapping(part, "onsets"), effects)


def settings_of(part: dict[str, Any]) -> dict[str, Any]:
    """Arguments with which a history of these settings is made, but for valve and effects."""
    made = {name: None if part[name] is None else kind(**part[name]) for name, kind in _KINDS.items()}
    return made | {"onsets": onsets_of_state(part["onsets"]) or None}


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Nothing: a history is made with its settings."""
