# SPDX-License-Identifier: BSD-3-Clause
"""Two histories of one valve, learnt apart, made one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history.compatible import require_same_valve
from sklvalve.history.learning import Group, Window
from sklvalve.history.posterior import Information
from sklvalve.history.sources import shared
from sklvalve.recording import InputError
from sklvalve.recording.errors import shown
from sklvalve.simulation.parameters import ParameterVector
from sklvalve.simulation.trim_state import state_of_trim

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_APART = "histories that are merged must be learnt alike: learn one from the recordings of both"


def require_mergeable(history: ValveHistory, other: Any) -> None:
    """Refuse a history that cannot be added to another.

    Parameters
    ----------
    history : ValveHistory
    other : object

    Raises
    ------
    InputError
        If it is none or has learnt nothing; is of another valve, other signals, another kind of flow, another
        trim, other effects or parameters; or was learnt from a recording that the first holds.
    """
    if not isinstance(other, type(history)) or not hasattr(other, "prior_"):
        what = "one that has learnt nothing" if isinstance(other, type(history)) else shown(other)
        raise InputError(f"a history is merged with another, and got {what}; give a fitted ValveHistory")
    again = shared(history.recordings_, other.recordings_)
    if again is not None:
        raise InputError(f"{again.name}: both histories hold these rows; give each history once")
    name = other.recordings_[0].name
    require_same_valve(history, other.valve_, name)
    for what, one, two in _alike(history, other):
        if not _equal(one, two):
            raise InputError(
                f"{name}: the {what} of its history differs from that of the other one; {_APART}"
            )


def moved(history: ValveHistory, other: ValveHistory) -> list[Window]:
    """Windows of another history, as they stand about the calibration of this one.

    A window says of a calibration :math:`z`, in scaled parameters counted from its own history's point,
    :math:`\\tfrac12 z^T H z - b^T z`. With :math:`z = D z' + e`, D the ratio of the scales and e where this
    history's point stands seen from the other's, the same reads :math:`H' = D H D`,
    :math:`b' = D (b - H e)`.

    Parameters
    ----------
    history : ValveHistory
    other : ValveHistory
        One that can be merged (`require_mergeable`).

    Returns
    -------
    windows : list of Window
    """
    ways = [
        _way(mine, theirs, history.values_, other.values_)
        for mine, theirs in zip(history._groups_, other._groups_, strict=True)
    ]
    return [
        replace(
            window,
            information=tuple(
                Information(
                    information.hessian * np.outer(ratio, ratio),
                    ratio * (information.pull - information.hessian @ away),
                    information.moves * np.outer(ratio, ratio),
                )
                for information, (ratio, away) in zip(window.information, ways, strict=True)
            ),
        )
        for window in other.windows_
    ]


def _way(
    mine: Group, theirs: Group, here: dict[str, float], there: dict[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Ratio of scales, and where this point stands seen from the other's, in the other's scale."""
    one, two = ParameterVector(mine.parameters), ParameterVector(theirs.parameters)
    # each by its own bounds: those of a zero grow with the span that a history has seen
    return one.scale / two.scale, (one.pack(here) - two.pack(there)) / two.scale


def _alike(history: ValveHistory, other: ValveHistory) -> Iterator[tuple[str, Any, Any]]:
    """What two histories must have in common, in words, and what each has."""
    yield "list of signals", sorted(history.roles_), sorted(other.roles_)
    yield "kind of flow", history.mass_flow_, other.mass_flow_
    yield "list of known effects", [e.key for e in history.effects], [e.key for e in other.effects]
    yield "onset of a known effect", history.onsets or {}, other.onsets or {}
    one, two = (state_of_trim(each.trim_) for each in (history, other))
    for key in ("given", "knots", "curve"):
        yield "trim", one[key], two[key]
    yield "list of parameters", _named(history._groups_), _named(other._groups_)


def _named(groups: Sequence[Group]) -> list[Any]:
    return [(g.channels, [(p.name, p.unit, p.log) for p in g.parameters]) for g in groups]


def _equal(one: Any, two: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(two, np.ndarray):
        return one is not None and two is not None and np.array_equal(one, two)
    return bool(one == two)
