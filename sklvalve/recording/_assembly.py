# SPDX-License-Identifier: BSD-3-Clause
"""Columns and a valve's roles to signals in SI, and the checks that need the signals."""

from collections.abc import Mapping
from datetime import datetime, timedelta
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._agreement import require_liquid_at_inlet
from sklvalve.recording._layout import read_role
from sklvalve.recording.columns import to_numbers
from sklvalve.recording.errors import InputError, hint, listed, shown
from sklvalve.recording.signal import OPENING_ROLES, ROLES, Signal, si_signal
from sklvalve.recording.valve import Valve

Signals = dict[str, NDArray[np.float64]]


class Parts(NamedTuple):
    """What a recording is made of, but for the clock."""

    time: object
    signals: Signals
    constants: frozenset[str]
    mass_flow: bool


def assemble(columns: Mapping[str, object], valve: Valve, source: str) -> Parts:
    """Take each role's column, or constant, to SI and check it.

    Raises
    ------
    InputError
        Naming the column, and the row where there is one.
    """
    time = _column(columns, valve.time, "the time", source, "time in [recording]")
    length = len(np.asarray(time))
    signals: Signals = {}
    for role, signal in valve.roles.items():
        if signal.column is None:
            values = np.full(length, signal.constant, dtype=np.float64)
            where = f"{valve.source}: [recording.{role}]"
        else:
            where = f"{source}: column {signal.column!r} ({role})"
            values = to_numbers(
                _column(columns, signal.column, role, source, f"column in [recording.{role}]"), where
            )
            if len(values) != length:
                raise InputError(f"{where}: {len(values)} values, but {length} times; give one for each time")
            _require_finite(values, where)
        with np.errstate(over="ignore"):
            signals[role] = signal.to_si(values)
        _require_finite_in_si(signals[role], values, signal, where)
        _require_likely(signals[role], values, role, signal, where)
    _require_pressure_drop(signals, source)
    if "p1" in signals:
        require_liquid_at_inlet(valve.fluid, signals["p1"], valve.source)
    constants = frozenset(role for role, signal in valve.roles.items() if signal.column is None)
    return Parts(time, signals, constants, _flows_by_mass(valve))


def _column(columns: Mapping[str, object], name: str, role: str, source: str, key: str) -> object:
    if name in columns:
        return columns[name]
    known = listed(columns)
    near = hint(name, columns)
    more = f"{near} (columns: {known})" if near.startswith("did") else f"the columns are {known}"
    raise InputError(f"{source}: there is no column {shown(name)} for {role}; correct {key}: {more}")


def _require_finite(values: NDArray[np.float64], where: str) -> None:
    infinite = np.flatnonzero(np.isinf(values))
    if len(infinite):
        raise InputError(
            f"{where}, row {infinite[0] + 1}: the value is infinite; correct it, or leave the cell empty"
        )
    if not np.isfinite(values).any():
        raise InputError(
            f"{where}: there is no value in it, only gaps; name another column or leave the role out"
        )


def _require_finite_in_si(
    si: NDArray[np.float64], recorded: NDArray[np.float64], signal: Signal, where: str
) -> None:
    """A number may be finite in its own unit and not in SI."""
    infinite = np.flatnonzero(np.isinf(si))
    if len(infinite):
        place = where if signal.column is None else f"{where}, row {infinite[0] + 1}"
        raise InputError(
            f"{place}: {recorded[infinite[0]]:g} {signal.unit} is beyond all numbers in {signal.si_unit}; "
            "correct the value or the unit"
        )


def _require_likely(
    si: NDArray[np.float64], recorded: NDArray[np.float64], role: str, signal: Signal, where: str
) -> None:
    """Refuse what no sensor error explains; what may be one is left to the screening."""
    middle = float(np.nanmedian(recorded))
    if role in OPENING_ROLES:
        low, high = np.nanquantile(si, [0.01, 0.99])
        if low < -0.25 or high > 1.25:
            likely = "is the unit '%'" if signal.unit == "1" else "is it scaled to another range"
            raise InputError(
                f"{where}: values from {np.nanmin(recorded):g} to {np.nanmax(recorded):g} are no {role} in "
                f"unit {signal.unit!r}; {likely}, or the column another one?"
            )
    elif signal.quantity == "pressure" and np.nanmedian(si) < 0.0:
        raise InputError(
            f"{where}: values around {middle:g} {signal.unit} lie below vacuum; "
            "say gauge = true if they are above the atmosphere, or correct the unit"
        )
    elif signal.quantity == "temperature" and np.nanmedian(si) < 0.0:
        raise InputError(
            f"{where}: values around {middle:g} {signal.unit} lie below absolute zero; correct the unit"
        )


def _require_pressure_drop(signals: Signals, source: str) -> None:
    if not {"p1", "p2"} <= signals.keys():
        return
    drop = signals["p1"] - signals["p2"]
    drop = drop[np.isfinite(drop)]
    if len(drop) and (drop < 0.0).all():
        raise InputError(
            f"{source}: p2 lies above p1 in every row, by {-np.median(drop) / 1e3:.4g} kPa in the middle; "
            "swap [recording.p1] and [recording.p2], or check their units and gauge"
        )


def _flows_by_mass(valve: Valve) -> bool:
    by_mass = {
        role: valve.roles[role].mass_flow for role in ("flow", "simulated_flow") if role in valve.roles
    }
    if len(set(by_mass.values())) > 1:
        raise InputError(
            f"{valve.source}: of flow and simulated_flow one is by mass, one by volume; give both of one kind"
        )
    return any(by_mass.values())


def frame_columns(frame: object, time: str) -> dict[str, object]:
    """Columns of a data frame or mapping by name, its index among them where that is the time."""
    if isinstance(frame, Mapping):
        return dict(frame)
    if not hasattr(frame, "columns"):
        raise InputError(f"expected a data frame or a mapping of columns; got {type(frame).__name__}")
    columns = {str(name): frame[name] for name in frame.columns}  # type: ignore[index]
    index = getattr(frame, "index", None)
    if time not in columns and index is not None:
        values = np.asarray(index)
        dates = values.dtype.kind in "Mm" or (len(values) > 0 and isinstance(values[0], datetime | timedelta))
        if getattr(index, "name", None) == time or dates:
            columns[time] = values
    return columns


def named_roles(columns: Mapping[str, object], where: str) -> dict[str, Signal]:
    """Signals in SI of the columns that are named after a role."""
    roles = {name: si_signal(name) for name in columns if name in ROLES}
    if not roles:
        raise InputError(
            f"{where}: no column is named after a role ({', '.join(ROLES)}); rename some, or give a Valve"
        )
    return roles


def roles_in_units(
    columns: Mapping[str, object], units: Mapping[str, object], valve: Valve, where: str
) -> dict[str, Signal]:
    """Signals of the columns that are named after a role, in units given by role; in SI where none is."""
    if valve.roles:
        raise InputError(
            f"units are given beside {valve.source}, which says the units of its roles; leave one of them out"
        )
    given = f"{where}: units"
    if not isinstance(units, Mapping):
        raise InputError(f"units must name one for each role, like {{'flow': 'm3/h'}}; got {shown(units)}")
    told: dict[str, Signal] = {}
    for role, value in units.items():
        entry = {"unit": value} if isinstance(value, str) else value
        if not isinstance(entry, Mapping):
            raise InputError(f"{given}: that of {role} must be a text like 'm3/h'; got {shown(value)}")
        if isinstance(entry, Mapping) and "constant" not in entry:
            entry = {"column": role, **entry}
        told[str(role)] = read_role(str(role), entry, valve.travel, given)
    named = {role: si_signal(role) for role in columns if role in ROLES and role not in told}
    # in the order of the columns, as without units
    order = {name: place for place, name in enumerate(columns)}
    return dict(sorted((told | named).items(), key=lambda item: order.get(item[1].column or "", len(order))))
