# SPDX-License-Identifier: BSD-3-Clause
"""Fault or property, in words: what is to be mended, and what belongs into the sheet or the simulation."""

from sklvalve._telling import BEGINS, UNKNOWN
from sklvalve.report.words import class_clause, class_words, either, number

# a class of several kinds is likely of the one that holds this share of its probability
_LIKELY = 0.8


def kind_of(effect: dict) -> str:
    """Kind of an entry of ``effects``; empty where an older diagnosis does not say it."""
    return effect.get("kind") or ""


def likely(effect: dict) -> str:
    """Kind of what is likely: where members of a class differ, that of most of its probability."""
    shares: dict[str, float] = {}
    for member in effect["members"]:
        kind = member.get("kind") or kind_of(effect)
        # where no probability is known every member counts alike
        probability = member.get("probability")
        shares[kind] = shares.get(kind, 0.0) + (1.0 if probability is None else probability)
    best = max(shares, key=shares.__getitem__)
    return best if shares[best] >= _LIKELY * sum(shares.values()) else kind_of(effect)


def begins(effect: dict) -> str:
    """How a sentence on an effect begins."""
    return BEGINS.get(likely(effect), UNKNOWN)


def what_is_it(effect: dict, limit: int = 3) -> str:
    """What was found, as it follows `begins`: what has happened where it is a fault, else a name."""
    words = class_clause if likely(effect) == "fault" else class_words
    return words(effect["members"], limit)


def is_what(effect: dict) -> str:
    """What an effect is, in brackets; empty where the beginning names it."""
    return " (a property of a sound valve)" if likely(effect) == "property" else ""


def faults_first(effects: list[dict]) -> list[dict]:
    """Effects in the order in which they are reported: faults first, each kind in the order that it had."""
    order = ("fault", "either", "property", "")
    return sorted(effects, key=lambda effect: order.index(likely(effect)))


def by_beginning(effects: list[dict]) -> list[tuple[str, list[tuple[int, dict]]]]:
    """Numbered effects by how a sentence on them begins, faults first."""
    order = [*BEGINS.values(), UNKNOWN]
    groups: dict[str, list[tuple[int, dict]]] = {}
    for count, effect in enumerate(effects, start=1):
        groups.setdefault(begins(effect), []).append((count, effect))
    found = sorted(groups.items(), key=lambda item: order.index(item[0]))
    lacks = BEGINS["property"]
    return [
        ("The simulation also lacks" if place and first == lacks else first, group)
        for place, (first, group) in enumerate(found)
    ]


def to_be_declared(effects: list[dict]) -> str:
    """What to do about properties: put them into the sheet; empty where there are none."""
    lacking = [effect for effect in effects if likely(effect) in ("property", "either")]
    if not lacking:
        return ""
    names = either([class_words(effect["members"]) for effect in lacking], "and")
    keys = [words for words in map(_declaration, lacking) if words]
    sheet = f": {either(keys, 'and')} in the [actuator] section of valve.toml" if keys else ""
    told = f"If this is normal for the valve, add {names} to the simulation{sheet}."
    if all(likely(effect) == "property" for effect in effects):
        told += " No maintenance is needed."
    elif any(likely(effect) == "either" for effect in lacking):
        told += " If it is not, look for the fault at the valve."
    return told


def _declaration(effect: dict) -> str:
    """The line that declares an effect; empty where valve.toml has no key for it."""
    from sklvalve.mismatch.result.known_effects import forms_of

    values = effect.get("parameters") or {}
    for form in forms_of(effect["members"][0]["name"]):
        for quantity in form.parameters:
            value = (values.get(quantity.name) or {}).get("value")
            if quantity.declared is not None and value:
                return f"{form.declared_as} = {number(quantity.declared(value), 2)}"
    return ""
