# SPDX-License-Identifier: BSD-3-Clause
"""Questions on a terminal about what columns do not tell; Enter takes what is proposed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from sklvalve.cli.terminal import safe, show

if TYPE_CHECKING:
    from sklvalve.recording.draft import Answers, Assignment, RecordingColumns

Answer = TypeVar("Answer", str, float)

_NONE = "-"
_WATER = "water"
_GAUGES = ("gauge", "absolute")
_TRIMS = ("linear", "equal_percentage", "quick_opening", "parabolic")


def ask(told: "RecordingColumns", answers: "Answers") -> "Answers":
    """Ask for the roles that are in doubt, for units that no name gives, and for the data sheet.

    Parameters
    ----------
    told : RecordingColumns
    answers : Answers
        What is known already.

    Returns
    -------
    answers : Answers
    """
    from sklvalve.recording.draft import assign_roles

    show("Enter accepts the value in [brackets]; - leaves it out.\n")
    answers = replace(answers, roles=_ask_roles(told, assign_roles(told, tag=answers.tag)))
    roles = assign_roles(told, tag=answers.tag, chosen=answers.roles)
    answers = replace(answers, units=_ask_units(roles))
    answers = replace(answers, gauges=_ask_gauges(roles, answers.units))
    if answers.tag is None:
        answers = replace(answers, tag=_word("Tag of the valve", None))
    answers = replace(answers, kv_rated=_number("Rated capacity kv [m3/h]", 0.0))
    trim = _choice("Characteristic of the trim", _TRIMS, None)
    if trim == "equal_percentage":
        rangeability = _number("Rangeability, such as 50", 1.0)
        # an equal-percentage trim of unknown rangeability is no trim that a valve.toml takes
        trim = trim if rangeability is not None else None
        answers = replace(answers, rangeability=rangeability)
    answers = replace(answers, characteristic=trim)
    lengths = [each for each in roles.values() if each.column.unit and each.column.unit.unit in ("mm", "m")]
    if lengths:
        answers = replace(answers, travel=_number("Rated travel of the stem [mm]", 0.0))
    return _with_fluid(answers)


def _ask_roles(told: "RecordingColumns", roles: dict[str, "Assignment"]) -> dict[str, str | None]:
    """Column -> role, of columns whose role is in doubt."""
    from sklvalve.recording.signal import ROLES

    chosen: dict[str, str | None] = {}
    proposed = {each.column.name: role for role, each in roles.items()}
    core = {"command", "opening", "flow", "process_value"}
    short = "command" not in roles or len(core & roles.keys()) < 2
    for column in told.columns:
        role = proposed.get(column.name)
        doubtful = role is not None and not roles[role].sure
        open_sided = role is None and column.reading.role == "pressure"
        # of columns whose names say nothing only where a role is missing that a diagnosis needs
        if not (doubtful or open_sided or (short and column.reading.role is None)):
            continue
        taken = {other for name, other in chosen.items() if other}
        free = [each for each in ROLES if each not in taken]
        answer = _choice(f"{column.shown}: which signal", free, role)
        chosen[column.name] = answer
    return chosen


def _ask_units(roles: dict[str, "Assignment"]) -> dict[str, str]:
    """Column -> unit, of signals whose names give none and whose numbers do not tell it."""
    from sklvalve.recording.draft.signals import drafted_units
    from sklvalve.recording.signal import ROLES
    from sklvalve.recording.units import UNITS

    units: dict[str, str] = {}
    for role, told in drafted_units(roles, units).items():
        if told.sure or told.value is None:
            continue
        allowed = [unit for quantity in ROLES[role] for unit in UNITS[quantity]]
        answer = _choice(f"Unit of {roles[role].column.shown}, the {role}", allowed, told.value)
        if answer is not None:
            units[roles[role].column.name] = answer
    return units


def _ask_gauges(roles: dict[str, "Assignment"], units: Mapping[str, str]) -> dict[str, bool]:
    """Column -> whether it is above the atmosphere, of pressures where neither name nor values tell it."""
    from sklvalve.recording.draft.signals import drafted_gauges, drafted_units

    gauges: dict[str, bool] = {}
    for role, told in drafted_gauges(roles, drafted_units(roles, units), gauges).items():
        if told.value is not None:
            continue
        # nothing is proposed: what nobody answers stays to be filled in
        answer = _choice(f"{roles[role].column.shown}, the {role}: which pressure", _GAUGES, None)
        if answer is not None:
            gauges[roles[role].column.name] = answer == "gauge"
    return gauges


def _with_fluid(answers: "Answers") -> "Answers":
    """Ask for the fluid; of one other than water the density must be known."""
    fluid = _word("Fluid, a liquid", _WATER)
    if fluid in (None, _WATER):
        return answers
    density = _number("Density [kg/m3]; without it water is taken", 0.0)
    return answers if density is None else replace(answers, fluid=fluid, density=density)


def _read(question: str) -> str:
    try:
        return input(safe(question)).strip()
    except EOFError:  # the end of input takes what is proposed, as Enter does
        show()
        return ""


def _asked(
    question: str, proposed: Answer | None, understand: Callable[[str], Answer], expected: str
) -> Answer | None:
    while True:
        text = _read(f"{question} [{_NONE if proposed is None else proposed}]: ")
        if not text:
            return proposed
        if text == _NONE:
            return None
        try:
            return understand(text)
        except ValueError:
            show(f"  expected {expected}; got {text!r}")


def _word(question: str, proposed: str | None) -> str | None:
    return _asked(question, proposed, str, "a word")


def _number(question: str, above: float) -> float | None:
    def understand(text: str) -> float:
        value = float(text.replace(",", "."))
        if not above < value < float("inf"):
            raise ValueError
        return value

    return _asked(question, None, understand, f"a number above {above:g}")


def _choice(question: str, known: Sequence[str], proposed: str | None) -> str | None:
    """One of a list of words; the beginning of a word does where it is that of one only."""

    def understand(text: str) -> str:
        found = [word for word in known if word == text] or [
            word for word in known if word.casefold().startswith(text.casefold())
        ]
        if len(found) != 1:
            raise ValueError
        return found[0]

    listed = ", ".join(known)
    return _asked(f"{question}? {listed}\n ", proposed, understand, f"one of {listed}")
