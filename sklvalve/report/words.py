# SPDX-License-Identifier: BSD-3-Clause
"""Names and numbers as a plant engineer says them."""

import re
from collections.abc import Iterable, Sequence
from math import isfinite

from sklvalve._telling import changed_before, lacking, since_history

# what effects need that only a data sheet can give, as `not_testable` has it
_SHEET = "a data sheet that gives the trim's characteristic"

BLOCKS = {
    "actuator": "in the actuator",
    "valve": "in the valve",
    "line": "in the line",
    "measurement": "in the measurement",
}

ROLES = {"p1": "inlet pressure", "p2": "outlet pressure", None: "times"}

VERDICTS = {
    "no_mismatch": "nothing is missing",
    "named": "likely cause found",
    "none_of_these": "missing physics that no known effect explains",
    "cannot_tell": "something is missing; the recording does not identify what",
}

#: The same where the recording was held against a history.
SINCE = {
    "no_mismatch": "nothing has changed since the history",
    "none_of_these": "a change since the history that no known effect explains",
    "cannot_tell": "something has changed since the history; the recording does not identify what",
}


def verdict_words(d: dict) -> str:
    """Words for the verdict of a diagnosis."""
    if d["verdict"] == "cannot_tell" and not d["mismatch"].get("detected", True):
        if d.get("subject") == "loop":
            return "this recording cannot show whether the valve sticks"
        return f"this recording cannot show whether anything {lacking(d)}"
    if d["verdict"] == "no_mismatch" and changed_before(d):
        return "what the history had already has changed, and nothing else"
    if since_history(d) and d["verdict"] in SINCE:
        return SINCE[d["verdict"]]
    levels = {(effect.get("grade") or {}).get("level") for effect in d.get("effects") or []}
    if d["verdict"] == "named" and levels == {"weak"}:
        return "possible cause, weak evidence"
    return VERDICTS[d["verdict"]]


def spoken(name: str) -> str:
    """Words for an effect, or its name without underscores where it has none."""
    return _own(name, "words") or name.replace("_", " ")


def role_words(role: str | None) -> str:
    """Words for a role."""
    return ROLES.get(role, str(role).replace("_", " "))


def either(items: Sequence[str], last: str = "or") -> str:
    """Words joined as a list is spoken: a, b or c."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def class_words(members: Iterable[dict], limit: int = 3) -> str:
    """Words for a class of effects that cannot be distinguished, most probable first."""
    return _shortened([spoken(member["name"]) for member in members], limit)


def class_clause(members: Iterable[dict], limit: int = 3) -> str:
    """The same as clauses: ``the seat leaks or a bypass is open``."""
    names = [member["name"] for member in members]
    return _shortened([_own(name, "clause") or f"there is {spoken(name)}" for name in names], limit)


def _own(name: str, told: str) -> str:
    """What an effect says of itself; empty where it says nothing."""
    # commands that speak of signals alone do without the simulation, which takes a second to import
    from sklvalve.mismatch.result.known_effects import forms_of

    return next((words for form in forms_of(name) if (words := getattr(form, told))), "")


def _shortened(names: list[str], limit: int) -> str:
    if len(names) > limit:
        names = [*names[: limit - 1], f"one of {len(names) - limit + 1} others"]
    return either(names)


def block_words(blocks: Sequence[str], last: str = "or") -> str:
    """Words for the places where an effect may sit: in the actuator or in the valve."""
    return either([BLOCKS.get(block, f"in the {block}") for block in blocks], last)


def unsaid(words: str, blocks: Sequence[str]) -> list[str]:
    """Blocks to be named after these words: none where the words name them all ("a slow actuator")."""
    said = all(re.search(rf"\b{re.escape(block)}\b", words) for block in blocks)
    return [] if said else list(blocks)


def class_in_block(effect: dict, limit: int = 3) -> str:
    """Words for a class of effects and where it sits."""
    words = class_words(effect["members"], limit)
    return f"{words} {block_words(unsaid(words, effect['blocks']))}".rstrip()


def number(value: float | None, digits: int = 3) -> str:
    """A few significant digits without an exponent where a person would write none."""
    if value is None or not isfinite(value):
        return "unknown"
    short = f"{value:.{digits}g}"
    if "e" in short and 1e-4 <= abs(value) < 1e7:
        short = f"{float(short):.7f}".rstrip("0").rstrip(".")
    return short


def with_units(words: str) -> str:
    """Words whose numbers stay on one line with their units."""
    return re.sub(
        r"(?<=\d) (?=(?:%|s|h|m3/h|kPa|bar|nats)(?!\w))|(?<=\bp) (?=[<=])|(?<=\bp [<=]) (?=\d)",
        "\N{NO-BREAK SPACE}",
        words,
    )


def with_unit(value: float | None, unit: str | None) -> str:
    """Value and unit as they are written; a pure number has none."""
    return number(value) + (f" {unit}" if unit and unit != "1" else "")


def in_recorded(d: dict, role: str, share: float) -> str:
    """A share of a signal's span in its recorded unit, where the diagnosis has the span."""
    span, unit = (d.get("spans") or {}).get(role), (d.get("units") or {}).get(role)
    if role == "opening" or not span or not unit:
        return f"{percent(share)} of {'travel' if role == 'opening' else 'span'}"
    return with_unit(float(f"{span * share:.2g}"), unit)


def percent(share: float | None) -> str:
    """A share of one as percent: whole numbers where that is fine enough."""
    if share is None or not isfinite(share):
        return "unknown"
    value = 100.0 * share
    if value < 1.0 or 99.0 < value < 100.0:
        return f"{value:.1f} %"
    return f"{value:.0f} %"


def chance(probability: float | None) -> str:
    """A probability as percent; certainty is never claimed, and none where it was not checked."""
    if probability is None:
        return "not known"
    return "> 99 %" if probability > 0.99 else percent(probability)


def right(probability: float) -> str:
    """A checked frequency as a share of cases; certainty is never claimed."""
    return "more than 99 %" if probability > 0.99 else f"{100.0 * probability:.0f} %"


def sure(effect: dict) -> str:
    """How sure a finding is: how often such a one was right, else its grade."""
    probability = effect.get("probability")
    if probability is None:
        return f"{(effect.get('grade') or {}).get('level') or 'unknown'} evidence"
    return f"right in {right(probability)} of blind tests"


def likeliest_first(members: Iterable[dict]) -> list[dict]:
    """Members of one or several classes, most probable first; as given where no probability is known."""
    return sorted(members, key=lambda member: -(member.get("probability") or 0.0))


def named_effects(d: dict) -> list[dict]:
    """Findings to speak of first: all but the weak ones, where others are stronger."""
    effects = d.get("effects") or []
    sure = [each for each in effects if (each.get("grade") or {}).get("level") != "weak"]
    return sure or effects


def p_words(p_value: float | None) -> str:
    """P-value as it is usually printed."""
    if p_value is None:
        return "p unknown"
    return "p < 0.001" if p_value < 0.001 else f"p = {number(p_value)}"


def lacks_sheet(d: dict) -> bool:
    """Whether effects could not be asked for want of a data sheet: capacity and trim were learnt, then."""
    return any(each.get("needs") == _SHEET for each in d.get("not_testable") or [])
