# SPDX-License-Identifier: BSD-3-Clause
"""Which valves are watched, where their rows are, and when they were sound: plant.toml."""

import datetime as dt
import re
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from sklvalve.recording.errors import InputError, hint, shown
from sklvalve.recording.toml_file import read_toml
from sklvalve.recording.valve import Valve, read_valve

#: Days with rows that a valve is learnt from, unless plant.toml says which.
COMMISSIONED = 14
#: False calls a valve-year, unless plant.toml says how many.
FALSE_CALLS = 0.05
_TAG = re.compile(r"[A-Za-z0-9][A-Za-z0-9._ +-]{0,63}")
_KEYS = ("name", "false_calls", "commissioning", "valve")
_VALVE_KEYS = ("sheet", "data", "commissioning")
_COMMISSIONING_KEYS = ("days", "from", "until")
_LARGEST = 16 << 20  # bytes; ten thousand valves take two


@dataclass(frozen=True)
class Commissioning:
    """Days in which a valve was sound.

    Parameters
    ----------
    days : int, default=14
        Number of days with rows that it is learnt from.
    first : date or None, default=None
        Day before which nothing counts; the first one with rows unless given.
    last : date or None, default=None
        Last of these days; `days` of them unless given.
    """

    days: int = COMMISSIONED
    first: dt.date | None = None
    last: dt.date | None = None

    def of(self, days: list[dt.date]) -> list[dt.date]:
        """Days of commissioning among those that have rows, in their order."""
        from_here = [d for d in days if self.first is None or d >= self.first]
        return from_here[: self.days] if self.last is None else [d for d in from_here if d <= self.last]


@dataclass(frozen=True)
class Watched:
    """One valve that is watched.

    Parameters
    ----------
    tag : str
    valve : Valve
        Data sheet and columns.
    folder : str
        Where its rows are, within the folder of the data.
    commissioning : Commissioning
    """

    tag: str
    valve: Valve
    folder: str
    commissioning: Commissioning


@dataclass(frozen=True)
class Plant:
    """Valves that are watched together.

    Parameters
    ----------
    name : str
    valves : tuple of Watched
    false_calls : float, default=0.05
        Most calls without a reason a valve-year.
    """

    name: str
    valves: tuple[Watched, ...]
    false_calls: float = FALSE_CALLS


def read_plant(path: str | PathLike[str]) -> Plant:
    """Read which valves are watched.

    Parameters
    ----------
    path : str or path-like
        A plant.toml; paths in it are relative to its folder.

    Returns
    -------
    plant : Plant

    Raises
    ------
    InputError
        If the file is missing, is no TOML, names no valve or one twice, or holds a section, key or value that
        cannot be used; and if a valve's own file cannot be read.
    """
    file = Path(path)
    data = read_toml(file, missing="give the path of the plant.toml", most=_LARGEST)
    _require_known(data, _KEYS, str(file))
    entries = data.get("valve", {})
    if not isinstance(entries, Mapping) or not entries:
        raise InputError(f"{file}: no valve is named; add a section such as [valve.FV-101] with its sheet")
    default = _commissioning(data.get("commissioning", {}), f"{file}: [commissioning]", Commissioning())
    sheets: dict[Path, Valve] = {}
    valves = tuple(_watched(file, tag, entry, default, sheets) for tag, entry in entries.items())
    _require_own_rows(file, valves)
    name = data.get("name", file.resolve().parent.name)
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{file}: name must be a text in quotes; got {shown(name)}")
    return Plant(name.strip(), valves, _false_calls(data.get("false_calls", FALSE_CALLS), file))


def _watched(
    file: Path, tag: str, entry: object, default: Commissioning, sheets: dict[Path, Valve]
) -> Watched:
    where = f"{file}: [valve.{shown(tag)[1:-1]}]"
    if not _TAG.fullmatch(tag) or tag.endswith((".", " ")):
        raise InputError(
            f"{where} is no tag that a folder can be named by; use letters, digits, blank, . _ + and -"
        )
    if not isinstance(entry, Mapping):
        raise InputError(f"{where} must be a section with the valve's sheet; got {shown(entry)}")
    _require_known(entry, _VALVE_KEYS, where)
    sheet, folder = entry.get("sheet"), entry.get("data", tag)
    if not isinstance(sheet, str) or not sheet.strip():
        found = "has no sheet" if sheet is None else f"sheet must be a path in quotes; got {shown(sheet)}"
        raise InputError(f'{where} {found}; add the path of its valve.toml, such as sheet = "{tag}.toml"')
    if not isinstance(folder, str) or not folder.strip():
        raise InputError(f"{where} data must be the name of a folder in quotes; got {shown(folder)}")
    if Path(folder).is_absolute() or ".." in Path(folder).parts:
        raise InputError(f"{where} data must lie within the folder of the data; got {shown(folder)}")
    at = file.parent / sheet
    if at not in sheets:
        sheets[at] = read_valve(at)
    made = _commissioning(entry.get("commissioning", {}), f"{where} commissioning", default)
    return Watched(tag, sheets[at], folder, made)


def _commissioning(entry: object, where: str, default: Commissioning) -> Commissioning:
    if not isinstance(entry, Mapping):
        raise InputError(f"{where} must hold days, or from and until; got {shown(entry)}")
    _require_known(entry, _COMMISSIONING_KEYS, where)
    days = entry.get("days", default.days)
    if isinstance(days, bool) or not isinstance(days, int) or not 10 <= days <= 3650:
        raise InputError(f"{where} days must be a whole number from 10 to 3650; got {shown(days)}")
    first, last = (_date(entry.get(key), f"{where} {key}") for key in ("from", "until"))
    if first and last and first > last:
        raise InputError(f"{where} ends on {last}, before it begins on {first}; exchange the two")
    return Commissioning(days, first or default.first, last or default.last)


def _date(value: object, where: str) -> dt.date | None:
    if value is None:
        return None
    if isinstance(value, dt.datetime) or not isinstance(value, dt.date):
        raise InputError(f"{where} must be a date without quotes, such as 2026-01-31; got {shown(value)}")
    return value


def _false_calls(value: object, file: Path) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 1e-4 <= value <= 10.0:
        raise InputError(
            f"{file}: false_calls must be a number from 0.0001 to 10, calls a valve-year; got {shown(value)}"
        )
    return float(value)


def _require_own_rows(file: Path, valves: tuple[Watched, ...]) -> None:
    owner: dict[str, str] = {}
    for each in valves:
        place = Path(each.folder).as_posix().casefold()
        if place in owner:
            raise InputError(
                f"{file}: {owner[place]} and {each.tag} have their rows in one folder, {each.folder}; give "
                "each its own data"
            )
        owner[place] = each.tag


def _require_known(entry: Mapping[str, object], keys: tuple[str, ...], where: str) -> None:
    for key in entry:
        if key not in keys:
            raise InputError(f"{where} knows no key {shown(key)}; {hint(key, keys)}")
