# SPDX-License-Identifier: BSD-3-Clause
"""The calibration about which a history keeps what its windows say: trim, signals, parameters and values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from sklvalve.history.learning import Group
from sklvalve.recording.signal import ROLES
from sklvalve.simulation.parameters import Parameter
from sklvalve.simulation.state import (
    mapping,
    number,
    parameter_name,
    require_names,
    require_sound_trim,
    require_sound_values,
)
from sklvalve.simulation.trim_state import state_of_trim, trim_of_state

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_CHANNELS = ("opening", "flow")
_MOST_PARAMETERS = 2_000
_BOUNDS = ("low", "high", "start")


def told(history: ValveHistory) -> dict[str, Any]:
    """Trim, roles, spans [SI], kind of flow, groups of channels with their parameters, and values [SI]."""
    return {
        "trim": state_of_trim(history.trim_),
        "roles": list(history.roles_),
        "mass_flow": bool(history.mass_flow_),
        "spans": {role: float(span) for role, span in history.spans_.items()},
        "values": {name: float(value) for name, value in history.values_.items()},
        "groups": [
            {"channels": list(group.channels), "parameters": [_told(p) for p in group.parameters]}
            for group in history._groups_
        ],
    }


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set trim, roles, spans, groups and values again."""
    assert history.valve_ is not None, "a history is made with its valve"
    history.trim_ = trim_of_state(history.valve_, part["trim"], history.tolerance)
    history.roles_, history.mass_flow_ = tuple(part["roles"]), part["mass_flow"]
    history.spans_, history.values_ = dict(part["spans"]), dict(part["values"])
    history._groups_ = tuple(
        Group(tuple(group["channels"]), tuple(Parameter(**p) for p in group["parameters"]))
        for group in part["groups"]
    )


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse a calibration that no history has; ``ValueError``."""
    values, roles = mapping(part, "values"), part.get("roles")
    require_sound_values(values, effects)
    require_sound_trim(mapping(part, "trim"), values)
    if not isinstance(roles, list | tuple) or not roles or any(role not in ROLES for role in roles):
        raise ValueError("its signals are none")
    if not isinstance(part.get("mass_flow"), bool):
        raise ValueError("its kind of flow is neither mass nor volume")
    spans = mapping(part, "spans")
    require_names(spans, roles)
    for role, span in spans.items():
        number(span, f"the span of {str(role)[:20]}", 0.0)
    _require_sound_groups(part.get("groups"), roles, values)


def _require_sound_groups(groups: Any, roles: Sequence[str], values: dict[str, float]) -> None:
    if not isinstance(groups, list | tuple) or not 0 < len(groups) <= len(_CHANNELS):
        raise ValueError("it has no groups of signals")
    channels = [channel for group in groups for channel in _channels_of(group)]
    if len(set(channels)) < len(channels) or not set(channels) <= set(_CHANNELS) & set(roles):
        raise ValueError("its groups are of signals that it lacks")
    names: list[str] = []
    for group in groups:
        several = group.get("parameters")
        if not isinstance(several, list | tuple) or not 0 < len(several) <= _MOST_PARAMETERS:
            raise ValueError("a group has no parameters")
        for parameter in several:
            _require_sound_parameter(parameter)
            names.append(parameter["name"])
    if len(set(names)) < len(names):
        raise ValueError("a parameter stands twice")
    require_names(values, names)


def _channels_of(group: Any) -> Sequence[str]:
    channels = group.get("channels") if isinstance(group, dict) else None
    if not isinstance(channels, list | tuple) or not channels:
        raise ValueError("a group has no signal")
    return channels


def _require_sound_parameter(parameter: Any) -> None:
    if not isinstance(parameter, dict) or set(parameter) != {*_BOUNDS, "name", "unit", "spread", "log"}:
        raise ValueError("a parameter is none")
    name = parameter_name(parameter["name"])
    low, high, start = (number(parameter[key], f"{key} of {name}") for key in _BOUNDS)
    if not low <= start <= high or low == high or (parameter["log"] and low <= 0.0):
        raise ValueError(f"the bounds of {name} are none")
    if parameter["spread"] is not None:
        number(parameter["spread"], f"the spread of {name}", 1e-300)
    if not isinstance(parameter["log"], bool) or not isinstance(parameter["unit"], str):
        raise ValueError(f"unit or kind of {name} is none")


def _told(p: Parameter) -> dict[str, Any]:
    """One parameter; of a fit before any history, so that it has no joint prior."""
    return {
        "name": p.name,
        "unit": p.unit,
        "low": float(p.low),
        "high": float(p.high),
        "start": float(p.start),
        "spread": None if p.spread is None else float(p.spread),
        "log": bool(p.log),
    }
