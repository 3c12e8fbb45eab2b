# SPDX-License-Identifier: BSD-3-Clause
"""From a tag, or any name of a column, to the role that its signal most likely plays."""

import re
import unicodedata
from typing import NamedTuple

from sklvalve.recording.tags import words
from sklvalve.recording.tags.unit_text import read_unit, split_unit
from sklvalve.recording.units import quantity_of

_SPECIAL = str.maketrans(
    {"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "ł": "l", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue"}
)
_SIDES = {"p1": words.UPSTREAM, "p2": words.DOWNSTREAM}
_BY_QUANTITY = {
    "pressure": "pressure",
    "temperature": "temperature",
    "volume flow": "flow",
    "mass flow": "flow",
}
_PATH_MARKS = re.compile(r"[\\/|:!;=.]+")
# what stands before a number in the tag of an instrument, or alone where it can only be a controller
_INSTRUMENT = re.compile(r"\s*\d*(?P<code>[A-Za-z]{2,4})(?=[-_ ]?\d|(?<=[ICic])(?![A-Za-z]))")
_SHORT_INSTRUMENT = re.compile(r"\s*\d*(?P<code>[A-Za-z])(?=[-_]?\d)")
_CODES = (
    words.FLOW_LETTERS
    | words.PRESSURE_LETTERS
    | words.TEMPERATURE_LETTERS
    | words.LEVEL_LETTERS
    | words.CONTROLLER_LETTERS
    | words.VALVE_LETTERS
    | words.OPENING_ENDINGS
)


class NameReading(NamedTuple):
    """What a name says.

    `role` is a role of a valve.toml, ``"pressure"`` where the side of the valve stays open, or None; `sure`
    is False where the name may as well mean something else; `why` says it in words; `loop` is the number, or
    short name, that signals of one loop share, empty where there is none.
    """

    role: str | None
    sure: bool
    why: str
    loop: str


def read_name(name: str, unit: str = "") -> NameReading:
    """Role that a column's name points to.

    Parameters
    ----------
    name : str
        Name of a column, or a tag; a unit in it counts.
    unit : str, default=""
        Text of the unit, where it stands elsewhere.

    Returns
    -------
    reading : NameReading

    Examples
    --------
    >>> from sklvalve.recording.tags import read_name
    >>> read_name("FIC-101.PV").role, read_name("Druck vor Ventil").role, read_name("LC74_20CV_pct").role
    ('flow', 'p1', 'command')
    >>> read_name("PT-7 [bar]")[:2]
    ('pressure', False)
    >>> read_name(r"\\\\SRV\\PLANT\\FIC-101.PV")[:2], read_name("FIC-101.MODE").role
    (('flow', True), None)
    """
    rest, inside = split_unit(name)
    if is_documented(name):
        documented = words.DAMADICS[rest.casefold()]
        return NameReading(documented, True, "a name of the DAMADICS benchmark", _loop(rest))
    rest = without_path(rest)
    loop = _loop(rest)
    tokens = _tokens(rest)
    if re.fullmatch(r"[A-Za-z]\d", loop):  # its digit tells no side of the valve
        tokens = [token for token in tokens if token != loop[1]]
    if not tokens:
        return NameReading(None, False, "a name without letters", loop)
    reading = read_unit(unit or inside)
    measures = quantity_of(reading.unit) if reading else None
    role, sure, why = _role(tokens, measures)
    return NameReading(role, sure, why, loop)


def is_documented(name: str) -> bool:
    """Whether a column has a name of the DAMADICS benchmark, whose commands and positions count closing."""
    return split_unit(name)[0].casefold() in words.DAMADICS


def without_path(name: str) -> str:
    """Name without the servers, plants and areas before it, in which words mean no signal.

    Examples
    --------
    >>> from sklvalve.recording.tags.names import without_path
    >>> without_path("Plant/Pressure reduction/FIC101.PV"), without_path("LIC7/MV"), without_path("a/b/Flow")
    ('FIC101.PV', 'LIC7/MV', 'Flow')
    """
    starts = [0, *(mark.end() for mark in _PATH_MARKS.finditer(name))]
    for form in (_INSTRUMENT, _SHORT_INSTRUMENT):
        for start in reversed(starts):
            match = form.match(name, start)
            if match and match["code"].casefold() in _CODES:
                return name[start:].strip()
    if "\\" in name or name.count("/") > 1:
        return re.split(r"[\\/]", name.rstrip("\\/"))[-1].strip() or name
    return name


def _tokens(name: str) -> list[str]:
    """Words and numbers of a name, in small letters, without accents."""
    plain = unicodedata.normalize("NFC", name).translate(_SPECIAL)
    plain = unicodedata.normalize("NFKD", plain).encode("ascii", "ignore").decode()
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", " ", plain)
    found = [token.casefold() for token in re.split(r"[^A-Za-z0-9]+", plain) if token]
    if len(found) > 1 and found[-1] == "n":  # a signal made relative to its range: P1n
        found.pop()
    return found


def _loop(name: str) -> str:
    parts = [part for part in re.split(r"[^A-Za-z0-9]+", name) if part]
    runs = [run for part in parts for run in re.findall(r"\d{3,}[A-Z](?![A-Za-z])|\d{2,}", part)]
    if runs:
        return max(runs, key=len)
    return next((part for part in parts[1:] if re.fullmatch(r"[A-Za-z]\d", part)), "")


def _role(tokens: list[str], measures: str | None) -> tuple[str | None, bool, str]:
    held, letters = set(tokens), [token for token in tokens if token.isalpha()]
    first, last = (letters[0], letters[-1]) if letters else ("", "")
    if held & words.DIFFERENTIAL:
        return None, False, "a pressure difference, which has no role: give the pressures themselves"
    if last in words.STATE_ENDINGS or held & words.STATE_WORDS:
        return None, False, "a state or a setting of the loop, which is no signal"
    if held & words.SIMULATED:
        flow = held & (words.FLOW_WORDS | words.FLOW_LETTERS) or (measures or "").endswith("flow")
        return ("simulated_flow" if flow else "simulated_opening"), False, "a simulation, by its name"
    if {"set", "point"} <= held or held & words.SETPOINT_WORDS:
        if held & words.OPENING_WORDS:
            return "command", True, "a set-point of the position"
        return "setpoint", True, "a set-point, by its name"
    if "signal" in held and held & {"control", "valve"}:
        return "command", True, "a control signal, by its name"
    controller = next((token for token in letters if token in words.CONTROLLER_LETTERS), None)
    if controller and _is_value(last, held):
        return _controlled(controller, False, measures)
    if held & words.PRESSURE_WORDS or _side_by_word(held) == "pressure":
        return _pressure(held, sure=True)
    if measures == "pressure" and last not in words.SETPOINT_ENDINGS | words.COMMAND_ENDINGS:
        return _pressure(held, sure=False)
    for known, role in (
        (words.COMMAND_WORDS, "command"),
        (words.OPENING_WORDS, "opening"),
        (words.FLOW_WORDS, "flow"),
        (words.TEMPERATURE_WORDS, "temperature"),
        (words.LEVEL_WORDS, "process_value"),
    ):
        found = next((token for token in tokens if token in known), None)
        if found is not None:
            return role, True, f"{found!r} in the name"
    return _by_letters(first, last, letters, held, measures)


def _by_letters(
    first: str, last: str, letters: list[str], held: set[str], measures: str | None
) -> tuple[str | None, bool, str]:
    """Letters of a tag, as instrument engineers write them: what is measured, then what of it."""
    alone = len(letters) == 1
    if last in words.SETPOINT_ENDINGS and (last != "w" or alone or first in words.CONTROLLER_LETTERS):
        # W is the set-point of a controller, and a watt elsewhere
        return "setpoint", True, f"the ending {last.upper()}"
    if _is_value(last, held):
        # PT101.PV is what a transmitter measures, FIC101.PV what a loop controls
        if alone or first in words.CONTROLLER_LETTERS or _by_first(first, held, measures)[0] is None:
            return _controlled(first, alone, measures)
        return _by_first(first, held, measures)
    if last in words.COMMAND_ENDINGS:
        return "command", True, f"the ending {last.upper()}"
    if last in words.CONTROLLER_ENDINGS and (alone or first in words.CONTROLLER_LETTERS):
        return "command", not alone, f"the ending {last.upper()}"
    if last in words.OPENING_ENDINGS:
        return "opening", True, f"the letters {last.upper()}"
    return _by_first(first, held, measures)


def _is_value(last: str, held: set[str]) -> bool:
    """Whether a name speaks of the measured value of a loop."""
    spelt = "process" in held and held & {"value", "variable"}
    return last in words.VALUE_ENDINGS or bool(held & words.VALUE_WORDS or spelt)


def _by_first(first: str, held: set[str], measures: str | None) -> tuple[str | None, bool, str]:
    """The first letters of a tag: what is measured."""
    for code, role in (
        (words.OPENING_ENDINGS, "opening"),
        (words.FLOW_LETTERS, "flow"),
        (words.TEMPERATURE_LETTERS, "temperature"),
        (words.LEVEL_LETTERS, "process_value"),
    ):
        if first in code:
            return role, first not in words.CONTROLLER_LETTERS, f"the letters {first.upper()}"
    if first in words.PRESSURE_LETTERS:
        return _pressure(held, sure=first != "ps")
    if first in words.VALVE_LETTERS:
        return "command", False, f"the letters {first.upper()} of a valve"
    if measures in _BY_QUANTITY:
        return _BY_QUANTITY[measures], False, f"its unit measures {measures}"
    return None, False, "a name that tells no role"


def _controlled(first: str, alone: bool, measures: str | None) -> tuple[str | None, bool, str]:
    """Role of a loop's value by the letters of the loop."""
    if first in words.FLOW_LETTERS or (measures or "").endswith("flow"):
        return "flow", True, "the value of a flow loop"
    if alone and measures is None:
        return "flow", False, "PV, taken for the flow that the valve controls"
    if first not in words.CONTROLLER_LETTERS:
        return "process_value", not alone, "the value of a loop whose name tells no flow"
    return "process_value", True, "the value of a loop that controls no flow"


def _side_by_word(held: set[str]) -> str | None:
    return "pressure" if held & {"vordruck", "hinterdruck", "nachdruck"} else None


def _pressure(held: set[str], sure: bool) -> tuple[str, bool, str]:
    if held & words.ACTUATOR:
        return "actuator_pressure", True, "a pressure in the actuator, by its name"
    if held & words.AIR and not held & words.DUCT:
        return "supply_pressure", False, "the actuator's air supply, by its name"
    for role, side in _SIDES.items():
        found = held & side
        if found and not held & _SIDES["p2" if role == "p1" else "p1"]:
            return role, True, f"a pressure with {sorted(found)[0]!r} in its name"
    return "pressure", False, "a pressure on a side of the valve that its name does not tell"
