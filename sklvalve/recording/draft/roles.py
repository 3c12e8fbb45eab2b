# SPDX-License-Identifier: BSD-3-Clause
"""Which column plays which role, when several could: by name, by loop, and pressures by their values."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sklvalve.recording.draft.columns import Column, RecordingColumns
from sklvalve.recording.signal import ROLES
from sklvalve.recording.tags import is_documented, split_unit

# roles that belong to one loop, not to a part of the plant
_OF_LOOP = ("command", "opening", "flow", "setpoint", "process_value")
# share of the rows in which a pressure must lie above another to be the inlet's
_NEARLY_ALL = 0.95


@dataclass(frozen=True)
class Assignment:
    """Column of a role, why, and whether that is beyond doubt."""

    column: Column
    why: str
    sure: bool


def assign_roles(
    told: RecordingColumns, *, tag: str | None = None, chosen: Mapping[str, str | None] | None = None
) -> dict[str, Assignment]:
    """Give each role at most one column.

    Parameters
    ----------
    told : RecordingColumns
    tag : str or None, default=None
        Part of the names that the columns of the valve share, where there are several valves.
    chosen : mapping of str to str or None, default=None
        Column -> role that a person chose; None keeps the column out.

    Returns
    -------
    roles : dict
        Role -> `Assignment`, in the order of a valve.toml.
    """
    chosen = chosen or {}
    free = [column for column in told.columns if column.name not in chosen]
    loop = _loop(free, tag)
    found = {
        role: Assignment(told.column(name), "as answered", True)
        for name, role in chosen.items()
        if role is not None
    }
    for role in ROLES:
        if role not in found:
            candidates = _candidates(role, free, loop, tag)
            if candidates:
                found[role] = _best(candidates)
    _sides(found, [column for column in free if column.reading.role == "pressure"], loop)
    if "flow" in found and "process_value" not in chosen.values():
        found.pop("process_value", None)  # with a flow there is a better loop to look at
    return {role: found[role] for role in ROLES if role in found}


def _loop(columns: list[Column], tag: str | None) -> str:
    """The loop with most of a valve's signals; with a command if any has one, and the first of equals."""
    if tag is not None:
        matching = [column for column in columns if tag.casefold() in column.name.casefold()]
        columns = matching or columns
    roles: dict[str, set[str]] = {}
    for column in columns:
        if column.reading.role in _OF_LOOP:
            roles.setdefault(column.reading.loop, set()).add(str(column.reading.role))
    return max(roles, key=lambda loop: ("command" in roles[loop], len(roles[loop])), default="")


def _candidates(role: str, columns: list[Column], loop: str, tag: str | None) -> list[Column]:
    """Columns that may play a role, the likeliest first; those of another valve's loop may not."""
    owned = {column.reading.loop for column in columns if column.reading.role == "command"} - {loop, ""}
    found = [column for column in columns if column.reading.role == role]
    if role in _OF_LOOP:
        found = [column for column in found if column.reading.loop not in owned]

    def rank(column: Column) -> tuple[bool, bool, bool]:
        tagged = tag is not None and tag.casefold() in column.name.casefold()
        return not tagged, column.reading.loop != loop, not column.reading.sure

    return sorted(found, key=rank)


def _best(candidates: list[Column]) -> Assignment:
    best, *others = candidates
    if is_documented(best.name):
        return Assignment(best, best.reading.why, True)
    alike = [other for other in others if other.reading.loop == best.reading.loop]
    why = best.reading.why
    if others:
        why += f"; could be meant as well: {', '.join(repr(other.name) for other in others[:3])}"
    return Assignment(best, why, best.reading.sure and not alike)


def _sides(found: dict[str, Assignment], open_sided: list[Column], loop: str) -> None:
    """Pressures whose names tell no side of the valve, by which of two is the higher one."""
    taken = {assignment.column.name for assignment in found.values()}
    left = [column for column in open_sided if column.name not in taken]
    own = [column for column in left if loop and column.reading.loop == loop]
    left = own if len(own) == 2 else left
    if len(left) == 2 and not {"p1", "p2"} & found.keys():
        share = _share_above(left[0], left[1])
        high, low = left if share >= 0.5 else reversed(left)
        clear = max(share, 1.0 - share) >= _NEARLY_ALL
        words = f"the higher of two pressures in {100.0 * max(share, 1.0 - share):.0f} % of the rows"
        found["p1"] = Assignment(high, words, clear)
        found["p2"] = Assignment(low, words.replace("higher", "lower"), clear)
    elif len(left) == 1 and len({"p1", "p2"} & found.keys()) == 1:
        known, other = ("p1", "p2") if "p1" in found else ("p2", "p1")
        share = _share_above(found[known].column, left[0])
        if (share if known == "p1" else 1.0 - share) >= _NEARLY_ALL:
            where = "below" if known == "p1" else "above"
            found[other] = Assignment(left[0], f"the only other pressure, {where} {known}", False)


def _share_above(one: Column, other: Column) -> float:
    both = np.isfinite(one.values) & np.isfinite(other.values)
    return float((one.values[both] > other.values[both]).mean()) if both.any() else 0.5


def tag_of(column: Column) -> str | None:
    """Tag of a loop out of the name of one of its columns: FIC101 of FIC101.OP; None where there is none."""
    name = split_unit(column.name)[0]
    stem = name.rsplit(".", 1)[0] if "." in name else name
    return stem if column.reading.loop and column.reading.loop in stem else None
