# SPDX-License-Identifier: BSD-3-Clause
"""What was there in the history already: what it was then and what it is now."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history.then import Expected, expected_of
from sklvalve.mismatch.constants import DISTINGUISHABLE
from sklvalve.mismatch.describe.intervals import SHARE_OFF, WITHIN_95, interval_of
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.result.effect_entry import in_recorded_unit
from sklvalve.mismatch.result.known_effects import forms_of, quantity_named

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.effects.base import Quantity
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.recording import Recording

# share of an effect's size that a simulation gets wrong, standard deviation [1]
_OFF = SHARE_OFF / WITHIN_95


def held_entries(
    whole: Recording, problem: Problem, history: ValveHistory, model: Model
) -> list[dict[str, Any]]:
    """Effects of the history, then and now.

    It has changed where the effect as it may have been then explains this recording worse by a distance that
    tells two explanations apart, and its change moves a signal by as much as counts. It is gone where what
    is left of it moves none by as much, or is not told from nothing. Where neither what it was then nor
    nothing is worse, the recording tells nothing. An interval would not do: it comes from slopes, and of an
    effect that is gone these are none.

    Parameters
    ----------
    whole : Recording
        For the units.
    problem : Problem
    history : ValveHistory
    model : Model
        Of the diagnosis.

    Returns
    -------
    entries : list of dict
        ``name``; ``parameter``, the first one, with its ``unit``; ``then`` and ``now``, each with ``value``
        and ``ci95``, None where the recording tells none; ``change``, "none", "changed" or "gone", and
        None where the recording does not tell; ``sentence``.
    """
    expected = {each.name: each for each in expected_of(history)}
    keys = {effect.key for effect in history.effects}
    rivals = history.by_itself_.rivals if history.by_itself_ is not None else {}
    return [
        _entry(whole, problem, term, model, expected, rivals.get(term.effect.name, []))
        for term in problem.held
        if term.effect.key in keys
    ]


def _entry(
    whole: Recording,
    problem: Problem,
    term: Term,
    model: Model,
    expected: dict[str, Expected],
    rivals: list[str],
) -> dict[str, Any]:
    first = term.effect.quantities(model.chain)[0]
    key = f"{term.effect.key}.{first.name}"
    was, now = expected[key], model.values[key]
    apart, fitted = _held_as_term(problem, term, model)
    ends = interval_of(apart, term, fitted, first)
    change = _change(problem, apart, term, model, expected)
    if change == "gone":
        # from slopes that are none
        ends = None
    sizes = [was.value, was.low, was.high, now, *(ends or ())]
    unit, converted = in_recorded_unit(first.unit, sizes, whole)
    entry = {
        "name": term.effect.name,
        "parameter": first.name,
        "unit": unit,
        "then": {"value": converted[0], "ci95": sorted(converted[1:3])},
        "now": {"value": converted[3], "ci95": sorted(converted[4:]) or None},
        "change": change,
    }
    return entry | {"sentence": _sentence(entry, term, first, rivals)}


def _held_as_term(problem: Problem, term: Term, model: Model) -> tuple[Problem, Model]:
    """Problem and model in which a held effect is one of the hypothesis, as intervals ask for it."""
    spreads = model.spreads
    if not any(name.startswith(f"{term.effect.key}.") for name in spreads):
        # a model that was simulated and not fitted knows none
        spreads = problem.fit(model.terms, start=model).spreads
    return problem.without_held(term), replace(model, terms=(*model.terms, term), spreads=spreads)


def _change(
    problem: Problem, apart: Problem, term: Term, model: Model, expected: dict[str, Expected]
) -> str | None:
    """How an effect has changed, which `apart` does not hold; None where the recording does not tell."""
    prefix = f"{term.effect.key}."
    now = problem.fit(model.terms, start=model)
    # of all that it may have been then what is nearest to now
    before = {
        name: float(np.clip(now.values[name], each.low, each.high))
        for name, each in expected.items()
        if name.startswith(prefix)
    }
    as_then = problem.fit(model.terms, start=replace(now, values=now.values | before), hold=prefix)
    none = apart.fit(model.terms, start=model)
    best = max(now.log_likelihood, as_then.log_likelihood, none.log_likelihood)
    # what a simulation gets wrong of one effect it gets wrong then and now: of its size alone it is less
    unlike_then, unlike_none = (
        distance(best, m.log_likelihood, best - none.log_likelihood, _OFF) >= DISTINGUISHABLE
        for m in (as_then, none)
    )
    if not unlike_then and not unlike_none:
        return None
    moved = problem.change(now, problem.simulate(model.terms, now.values | before))
    if not unlike_then or not problem.counts(moved):
        return "none"
    left = problem.change(now, apart.simulate(model.terms, now.values))
    return "changed" if unlike_none and problem.counts(left) else "gone"


def _sentence(entry: dict[str, Any], term: Term, quantity: Quantity, rivals: list[str]) -> str:
    words, (then, now) = _shown(entry, quantity)
    name = term.effect.spoken
    others = [next((form.words for form in forms_of(each)), "") or each.replace("_", " ") for each in rivals]
    # said of one name, it would be surer than the history is
    beside = f" (or {', '.join(others)}: the history does not tell which)" if others else ""
    began = f"{name[:1].upper()}{name[1:]}{beside} was there in the history already"
    if entry["change"] is None:
        return f"{began} ({words} {then}); this recording does not tell what it is now."
    if entry["change"] == "none":
        return f"{began}, and no change of it counts: {words} {then} then, {now} now."
    if entry["change"] == "gone":
        return f"{began}; it went from {words} {then} to none, or too little to count."
    return f"{began}; it went from {words} {then} to {now}."


def _shown(entry: dict[str, Any], quantity: Quantity) -> tuple[str, list[str]]:
    """Words for the parameter, and what it was and is, as a plant engineer writes them."""
    known = quantity_named(entry["name"], quantity.name, quantity.unit) or quantity
    display, unit = known.shown, "" if entry["unit"] == "1" else entry["unit"]
    words = " ".join({"kv": "Kv"}.get(word, word) for word in quantity.name.split("_"))
    if display is not None:
        words, unit = display.words, display.unit

    def turned(value: float) -> float:
        if display is None:
            return value
        return display.turn(value) if callable(display.turn) else display.turn * value

    return words, [" ".join(_written(entry[when], unit, turned)) for when in ("then", "now")]


def _written(size: dict[str, Any], unit: str, turned: Any) -> Iterator[str]:
    yield f"{turned(size['value']):.3g}"
    if unit:
        yield unit
    if size["ci95"]:
        low, high = sorted(turned(end) for end in size["ci95"])
        yield f"[{low:.3g} to {high:.3g}]"
