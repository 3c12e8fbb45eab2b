# SPDX-License-Identifier: BSD-3-Clause
"""Sections [recording.<role>] of a drafted valve.toml."""

from collections.abc import Mapping

import numpy as np

from sklvalve.recording._assembly import assemble
from sklvalve.recording.draft import evidence
from sklvalve.recording.draft.columns import Column
from sklvalve.recording.draft.evidence import Told
from sklvalve.recording.draft.roles import Assignment
from sklvalve.recording.draft.sheet import Sheet
from sklvalve.recording.errors import InputError
from sklvalve.recording.signal import OPENING_ROLES, ROLES
from sklvalve.recording.units import UNITS, quantity_of, to_si
from sklvalve.recording.valve import Valve

_FLOW_ROLES = ("flow", "simulated_flow")
_FLOW_UNIT = "m3/h"
Roles = Mapping[str, Assignment]


def drafted_units(roles: Roles, answered: Mapping[str, str]) -> dict[str, Told]:
    """Unit of each role, by `answered` (column -> unit), by name or by the size of the numbers."""
    return {role: _unit(role, roles, answered) for role in roles}


def drafted_gauges(roles: Roles, units: Mapping[str, Told], answered: Mapping[str, bool]) -> dict[str, Told]:
    """Whether each pressure is above the atmosphere, by `answered` (column -> bool), by name or by values."""
    told = {}
    for role, assignment in roles.items():
        unit, column = str(units[role].value), assignment.column
        if ROLES[role] != ("pressure",) or quantity_of(unit) != "pressure":
            continue
        if column.name in answered:
            told[role] = Told("true" if answered[column.name] else "false", "as answered")
        else:
            told[role] = evidence.gauge(column, unit)
    return told


def write_signals(
    sheet: Sheet,
    roles: Roles,
    drafted: Mapping[str, Told],
    gauges: Mapping[str, Told],
    travel: float | None,
) -> None:
    """Write the section of each role.

    Parameters
    ----------
    sheet : Sheet
    roles : mapping of str to Assignment
    drafted : mapping of str to Told
        Role -> unit.
    gauges : mapping of str to Told
        Role of a pressure -> whether it is above the atmosphere.
    travel : float or None
        Rated travel [mm], where it is known.
    """
    senses = _senses(roles)
    backwards = _pressures_backwards(roles, drafted, gauges)
    accepted: dict[str, dict[str, object]] = {}
    for role, assignment in roles.items():
        unit = drafted[role]
        question = _question(role, unit, travel) or (backwards if role in ("p1", "p2") else "")
        column = assignment.column.name
        if not question:
            section: dict[str, object] = {"column": column, "unit": unit.value}
            if role in OPENING_ROLES and senses[role].value is not None:
                section["sense"] = senses[role].value
            if role in gauges and gauges[role].value is not None:
                section["gauge"] = gauges[role].value == "true"
            question = _refusal(roles, {**accepted, role: section}, travel)
            if not question:
                accepted[role] = section
        sheet.section(f"recording.{role}", open_question=question)
        doubt = "" if assignment.sure else f"[recording.{role}] column {column!r}: {assignment.why}"
        sheet.known("column", column, assignment.why, check=doubt)
        shown = unit.value or "%"
        doubt = "" if unit.sure else f"[recording.{role}] unit of {assignment.column.shown}: {unit.why}"
        sheet.known("unit", shown, unit.why, check=doubt)
        if role in OPENING_ROLES:
            _write_sense(sheet, senses[role])
        elif role in gauges:
            _write_gauge(sheet, gauges[role])


def write_open_pressure(sheet: Sheet, column: Column) -> None:
    """A pressure whose side of the valve neither names nor values tell."""
    unit = evidence.pressure_unit(column, float(np.nanmedian(column.values)), None)
    question = f"does {column.shown} stand before the valve (p1) or behind it (p2)?"
    sheet.section("recording.p1", open_question=question)
    sheet.known("column", column.name, column.reading.why)
    sheet.known("unit", unit.value or "kPa", unit.why)
    sheet.open("gauge", True, "is it above the atmosphere?")


def write_missing_outlet(sheet: Sheet) -> None:
    """Without a pressure behind the valve a constant may stand for it."""
    sheet.section("recording.p2", open_question="no pressure behind the valve: a constant, or the open air?")
    sheet.known("constant", 0.0, "the pressure behind the valve, in unit")
    sheet.known("unit", "kPa", "unit of the constant")
    sheet.known("gauge", True, "0 above the atmosphere is the open air")


def _unit(role: str, roles: Roles, answered: Mapping[str, str]) -> Told:
    column = roles[role].column
    if column.name in answered:
        return Told(answered[column.name], "as answered")
    if role in OPENING_ROLES:
        return evidence.fraction_unit(column)
    allowed = {unit for quantity in ROLES[role] for unit in UNITS[quantity]}
    if column.unit is not None and column.unit.unit in allowed:
        return Told(column.unit.unit, "in the name")
    if ROLES[role] == ("pressure",):
        pair = [roles[each].column for each in ("p1", "p2") if each in roles] or [column]
        largest = max(float(np.nanmedian(each.values)) for each in pair)
        other = next((each for each in pair if each is not column), None)
        return evidence.pressure_unit(column, largest, other)
    if role == "temperature":
        return evidence.temperature_unit(column)
    if role in _FLOW_ROLES:
        return Told(_FLOW_UNIT, "no unit in the name, and numbers do not tell it: correct it", False)
    for controlled in ("flow", "process_value"):
        if role == "setpoint" and controlled in roles:
            unit = _unit(controlled, roles, answered).value
            return Told(unit, f"as that of the {controlled.replace('_', ' ')}")
    return Told("%", "no unit in the name: correct it", False)


def _question(role: str, unit: Told, travel: float | None) -> str:
    if unit.value is None:
        return unit.why
    if role in OPENING_ROLES and unit.value in ("mm", "m"):
        if role == "command":
            return "a command in a length: is this the opening?"
        if travel is None:
            return f"it is recorded in {unit.value}: give the rated travel in [valve] travel, in mm"
    return ""


def _refusal(roles: Roles, sections: Mapping[str, Mapping[str, object]], travel: float | None) -> str:
    """What the reader says against the last of some sections; empty where it takes them all."""
    columns: dict[str, object] = {roles[role].column.name: roles[role].column.values for role in sections}
    time = "time" + "_" * max(map(len, columns))  # no column is called so
    rows = len(next(iter(roles.values())).column.values)
    sheet = {"recording": {"time": time, **sections}}
    try:
        valve = Valve.from_dict(sheet if travel is None else sheet | {"valve": {"travel": travel}})
        assemble(columns | {time: np.arange(float(rows))}, valve, "")
    except InputError as error:
        return str(error).removeprefix(": ")
    return ""


def _senses(roles: Roles) -> dict[str, Told]:
    """Sense of each opening: of a position by the flow, of a command by the position or else by the flow."""
    known: dict[str, Told] = {}
    columns = {role: assignment.column for role, assignment in roles.items()}
    flow = columns.get("flow")
    freed = None if flow is None else evidence.freed_flow(flow, columns.get("p1"), columns.get("p2"))
    for role in ("opening", "command", "simulated_opening"):
        if role not in columns:
            continue
        told = Told(None, "there is nothing to compare it with", False)
        if freed is not None:
            told = evidence.sense(columns[role], freed, "the flow")
        if role != "opening" and "opening" in known and known["opening"].value:
            turn = 1.0 if known["opening"].value == "opening" else -1.0
            beside = evidence.sense(columns[role], turn * columns["opening"].values, "the opening")
            told = beside if beside.value else told
        known[role] = told
    return known


def _pressures_backwards(roles: Roles, units: Mapping[str, Told], gauges: Mapping[str, Told]) -> str:
    if not {"p1", "p2"} <= gauges.keys():  # one of them is missing, or in no unit of a pressure
        return ""
    si = []
    for role in ("p1", "p2"):
        column, unit = roles[role].column, str(units[role].value)
        over = gauges[role].value == "true"
        si.append(to_si(column.values, unit, "pressure", gauge=over))
    drop = si[0] - si[1]
    drop = drop[np.isfinite(drop)]
    if len(drop) and (drop < 0.0).all():
        return "p2 lies above p1 in every row: are the two exchanged, or in different units?"
    return ""


def _write_sense(sheet: Sheet, told: Told) -> None:
    if told.value is not None:
        sheet.known("sense", told.value, told.why)
    else:
        question = "does a larger number shut the valve?"
        why = f"{question} ({told.why}; without an answer it opens it)"
        sheet.open("sense", "closing", why, fill=question)


def _write_gauge(sheet: Sheet, told: Told) -> None:
    if told.value is not None:
        sheet.known("gauge", told.value == "true", told.why)
    else:
        question = "is it above the atmosphere?"
        sheet.open("gauge", True, f"{question} (absolute without an answer)", fill=question)
