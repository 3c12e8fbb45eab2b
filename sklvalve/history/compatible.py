# SPDX-License-Identifier: BSD-3-Clause
"""Whether a history and a recording belong together: else what changed would be the valve, or the columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.history.learnable import require_no_loop
from sklvalve.history.sources import Source, shared, sources_of
from sklvalve.recording import InputError, Recording, Valve
from sklvalve.recording.same_valve import sheet_difference
from sklvalve.recording.signal import ROLES

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

# no stage of a simulation asks for these
_BESIDE = ("setpoint", "process_value")
# where a valve is, by the first that is known: a fault of the stem moves only one of the first two, and one
# of the trim, in a closed loop, both of them and not the flow
_WHERE = ("opening", "command", "flow")
_KINDS = {True: "mass", False: "volume"}


def require_compatible(history: ValveHistory, recording: Recording, valve: Valve | None = None) -> None:
    """Refuse a history that says nothing, or something wrong, of a recording.

    Parameters
    ----------
    history : ValveHistory
    recording : Recording
        The rows that a diagnosis is to use.
    valve : Valve, default=None
        The sheet that counts; that of the recording unless given.

    Raises
    ------
    InputError
        If the history is not fitted; if the recording is of a loop without pressures, of another valve, holds
        other signals or another kind of flow; if it holds rows of the history, or lies before it; or if the
        valve is in it where the history has not been at all.
    """
    if not hasattr(history, "prior_"):
        raise InputError(
            "the history given has learnt nothing yet; call its fit with recordings of the valve first"
        )
    require_no_loop(recording)
    require_same_valve(history, valve or recording.valve, recording.source)
    require_same_signals(history, recording)
    require_apart(history.recordings_, recording)
    _require_met(history, recording)


def require_same_valve(history: ValveHistory, valve: Valve, source: str) -> None:
    """Refuse another valve's data sheet.

    Parameters
    ----------
    history : ValveHistory
    valve : Valve
    source : str
        What messages call the recording, or other history.

    Raises
    ------
    InputError
        Naming the field and both values.
    """
    known = history.valve_
    differs = sheet_difference(known, valve)
    told = None if differs is None else tuple(differs)
    if told is None and known.tag is not None and valve.tag is not None and known.tag != valve.tag:
        told = ("tag", known.tag, valve.tag)
    if told is not None:
        raise InputError(
            f"{source}: the data sheet gives {told[0]} as {told[2]!r}, and that of the history as "
            f"{told[1]!r}; a history must be of the same valve: give its own, or the valve.toml that it was "
            "learnt with"
        )


def require_same_signals(history: ValveHistory, recording: Recording) -> None:
    """Refuse a recording that holds other signals, or another kind of flow, than the history.

    Parameters
    ----------
    history : ValveHistory
    recording : Recording

    Raises
    ------
    InputError
        Naming the signal.
    """
    held, known = set(recording) - {*_BESIDE}, set(history.roles_) - {*_BESIDE}
    missing = [role for role in ROLES if role in held - known]
    if missing:
        raise InputError(
            f"{recording.source} holds {missing[0]}, which the history lacks; learn the history with it, or "
            "leave it out of the recording"
        )
    missing = [role for role in ROLES if role in known - held]
    if missing:
        raise InputError(
            f"{recording.source}: there is no {missing[0]}, which the history holds; record it, or learn "
            "the history without it"
        )
    if "flow" in held and recording.mass_flow != history.mass_flow_:
        raise InputError(
            f"{recording.source} holds a flow by {_KINDS[recording.mass_flow]} and the history one by "
            f"{_KINDS[history.mass_flow_]}; give both in the same kind of unit"
        )


def require_apart(known: Sequence[Source], recording: Recording) -> None:
    """Refuse a recording whose rows a history holds, or before or amid which it was recorded.

    Parameters
    ----------
    known : sequence of Source
        Recordings of the history.
    recording : Recording

    Raises
    ------
    InputError
        Naming both.
    """
    mine, source = list(sources_of(recording)), recording.source
    again = shared(mine, known)
    if again is not None:
        raise InputError(
            f"{source}: the history holds rows of this recording, by {again.name}; what is to be diagnosed "
            "must not be in the history: learn it from other recordings"
        )

    # where dates are known, nothing of a history lies in the time of the recording or behind it
    for each in known:
        for own in mine:
            if each.comparable(own) and not own.follows(each):
                raise InputError(
                    f"{source} begins at {own.first}, before {each.name} of the history ends at "
                    f"{each.last}; a history must be older than what is diagnosed: learn it from earlier "
                    "recordings"
                )


def _require_met(history: ValveHistory, recording: Recording) -> None:
    outside = history.range_.outside(recording)
    where = [name for name in _WHERE if name in outside]
    if where and all(outside[name] >= 1.0 for name in where):
        name = where[0]
        been = *history.range_.limits(0.0)[name], float(np.nanmedian(recording[name]))
        low, high, here = (_written(recording, name, value) for value in been)
        raise InputError(
            f"{recording.source}: the {name} is nowhere where the history has been (from {low} to {high}, "
            f"here around {here}), so that the history says nothing of it; give a history of that range"
        )


def _written(recording: Recording, role: str, value: float) -> str:
    unit = recording.unit(role)
    return f"{float(recording.in_recorded_units(role, value)):.4g}" + ("" if unit == "1" else f" {unit}")
