# SPDX-License-Identifier: BSD-3-Clause
"""From columns, and what a person answered, to a valve.toml that says of each line why it stands there."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sklvalve.recording.draft.columns import RecordingColumns
from sklvalve.recording.draft.roles import Assignment, assign_roles, tag_of
from sklvalve.recording.draft.sheet import Sheet, Stated
from sklvalve.recording.draft.signals import (
    drafted_gauges,
    drafted_units,
    write_missing_outlet,
    write_open_pressure,
    write_signals,
)
from sklvalve.recording.signal import OPENING_ROLES

_HEADING = (
    "Each line says why it stands here. A commented key is what the columns cannot tell: take its # away and",
    "correct it, or leave it, and it is estimated or done without. All keys: docs/valve_toml.md",
)
# keys of the data sheet: an example, what it is, and, of those to look up in any case, why
_SHEET: tuple[tuple[str, object, str, str], ...] = (
    (
        "kv_rated",
        40.0,
        "m3/h; estimated where it is missing",
        "without it a loss of capacity cannot be detected",
    ),
    (
        "characteristic",
        "equal_percentage",
        "or linear, quick_opening, parabolic; estimated if missing",
        "without it, wear or a leak cannot be told from the trim's shape",
    ),
    ("rangeability", 50.0, "largest over smallest controllable capacity, for equal_percentage", ""),
    ("travel", 38.1, "mm, of the stem; needed where a position is recorded as a length", ""),
)


@dataclass(frozen=True)
class Answers:
    """What a person knows; all may be left out.

    Parameters
    ----------
    roles : mapping of str to str or None
        Column -> role; None keeps the column out.
    units : mapping of str to str
        Column -> unit.
    gauges : mapping of str to bool
        Column of a pressure -> whether it is above the atmosphere.
    tag : str or None
        Name of the valve; where several share a recording, columns with it in their names go first.
    kv_rated, rangeability, travel : float or None
        [m3/h], [1], [mm].
    characteristic : str or None
    fluid : str or None
        Its name; None is water.
    density : float or None
        [kg/m3], of a fluid other than water.
    """

    roles: Mapping[str, str | None] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    gauges: Mapping[str, bool] = field(default_factory=dict)
    tag: str | None = None
    kv_rated: float | None = None
    characteristic: str | None = None
    rangeability: float | None = None
    travel: float | None = None
    fluid: str | None = None
    density: float | None = None


@dataclass(frozen=True)
class Draft:
    """Text of a valve.toml, the roles in it, its lines with their reasons, what to fill in or to check."""

    text: str
    roles: dict[str, Assignment]
    stated: tuple[Stated, ...]
    to_fill_in: tuple[str, ...]


def draft_valve(told: RecordingColumns, answers: Answers = Answers()) -> Draft:
    """Draft a valve.toml for a recording.

    Parameters
    ----------
    told : RecordingColumns
    answers : Answers

    Returns
    -------
    draft : Draft

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording.draft import draft_valve, read_recording_columns
    >>> course = 50.0 + 30.0 * np.sin(np.arange(200.0) / 9.0)
    >>> columns = {"time": np.arange(200.0), "FIC1.OP": course, "FIC1.PV [m3/h]": 0.2 * course}
    >>> draft = draft_valve(read_recording_columns(columns, "recording.csv"))
    >>> print(draft.text[draft.text.index("[recording.command]") :])
    [recording.command]
    column = "FIC1.OP"                          # the ending OP
    unit = "%"                                  # values from 20 to 80
    sense = "opening"                           # correlation 1.00 with the flow
    <BLANKLINE>
    [recording.flow]
    column = "FIC1.PV [m3/h]"                   # the value of a flow loop
    unit = "m3/h"                               # in the name
    <BLANKLINE>
    """
    roles = assign_roles(told, tag=answers.tag, chosen=answers.roles)
    sheet = Sheet(f"Draft by sklvalve init from {Path(told.source).name}, {told.rows} rows.", *_HEADING)
    _write_valve(sheet, roles, answers)
    sheet.section("recording", "how the recording is laid out")
    sheet.known("time", told.time, "the column of the times")
    units = drafted_units(roles, answers.units)
    write_signals(sheet, roles, units, drafted_gauges(roles, units, answers.gauges), answers.travel)
    _write_missing(sheet, told, roles, answers)
    return Draft(sheet.text(), roles, tuple(sheet.stated), tuple(sheet.to_fill_in))


def _write_valve(sheet: Sheet, roles: Mapping[str, Assignment], answers: Answers) -> None:
    sheet.section("valve", "the data sheet")
    named = [roles[role].column for role in ("command", "flow") if role in roles]
    guess = next(filter(None, map(tag_of, named)), None)
    if answers.tag is None and guess is not None:
        sheet.known("tag", guess, "from the names of the columns; for the report only")
    elif answers.tag is None:
        sheet.open("tag", "FV-101", "name of the valve in the plant; for the report only")
    else:
        sheet.known("tag", answers.tag, "as given")
    for key, example, what, needed in _SHEET:
        answer = getattr(answers, key)
        if answer is not None:
            sheet.known(key, answer, f"as answered; {what}")
        else:
            sheet.open(key, example, what, fill=f"data sheet; {needed}" if needed else "")
    _write_fluid(sheet, answers)
    _write_actuator(sheet)


def _write_actuator(sheet: Sheet) -> None:
    sheet.section("actuator", "what moves the stem; what is declared is no mismatch")
    sheet.open("kind", "electric", "or pneumatic, hydraulic, unknown")
    sheet.open("stroke_time", 60.0, "s, over the whole travel")
    sheet.open("dead_time", 1.0, "s, from the command to the first movement")
    sheet.open("dead_band", 0.5, "% of travel that the command may change without the stem following")


def _write_fluid(sheet: Sheet, answers: Answers) -> None:
    sheet.section("fluid", "water, unless said otherwise")
    if answers.fluid is None:
        sheet.open("name", "water", "or density = ... [kg/m3] and vapour_pressure = ... [kPa, absolute]")
        return
    sheet.known("name", answers.fluid, "as answered")
    if answers.density is not None:
        sheet.known("density", answers.density, "as answered; kg/m3")
    sheet.open("vapour_pressure", 10.0, "kPa, absolute, at the inlet")


def _write_missing(
    sheet: Sheet, told: RecordingColumns, roles: Mapping[str, Assignment], answers: Answers
) -> None:
    """What a diagnosis would use and no column gives, and the columns that play no role."""
    used = {assignment.column.name for assignment in roles.values()}
    left = [column for column in told.columns if column.name not in used and column.name not in answers.roles]
    open_sided = [column for column in left if column.reading.role == "pressure"]
    if not {"p1", "p2"} & roles.keys():
        for column in open_sided[:1]:
            write_open_pressure(sheet, column)
    if "p2" not in roles and ("p1" in roles or open_sided):
        write_missing_outlet(sheet)
    if not {*OPENING_ROLES} & roles.keys():
        sheet.section("recording.command", open_question="which column is the command to the valve?")
        sheet.known("column", left[0].name if left else "OP", "no name tells it")
        sheet.known("unit", "%", "% or 1")
    if not {"flow", "process_value", "opening"} & roles.keys():
        sheet.section("recording.flow", open_question="which column is the flow, or the opening?")
        sheet.known("column", left[-1].name if left else "PV", "no name tells it")
        sheet.known("unit", "m3/h", "m3/h, l/min, t/h, ...")
    unused = [repr(column.name) for column in left] + [repr(name) for name in told.others]
    if unused:
        more = ", ..." if len(unused) > 20 else ""
        sheet.remark(f"Columns without a role here: {', '.join(unused[:20])}{more}")
