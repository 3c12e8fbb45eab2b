# SPDX-License-Identifier: BSD-3-Clause
"""What diagnosis.json says of one thing that was found: its class, size, time, parameters with intervals."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.decide.probability import vanishing, without_interval
from sklvalve.mismatch.describe.intervals import interval_of
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.inference.hypothesis import Model, Term, parameter_values
from sklvalve.mismatch.search.rivals import class_of
from sklvalve.recording import Recording

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Finding

# so near to a bound, share of what is possible, a parameter lies at it
_NEAR_BOUND = 0.02


def effect_entry(finding: Finding, recording: Recording, problem: Problem) -> dict[str, Any]:
    """The entry of diagnosis.json for one finding, but for how sure it is (`assessed`).

    Its probabilities are those among the explanations at hand.
    """
    explanations = class_of(finding)
    _, term, fitted = next(iter(explanations.values()))
    total = sum(p for p, _, _ in explanations.values())
    values = parameter_values(term, fitted)
    entry: dict[str, Any] = {
        "members": [{"name": n, "probability": float(p)} for n, (p, _, _) in explanations.items()],
        "probability": float(total),
        "blocks": sorted({w.effect.block for _, w, _ in explanations.values()}),
        "size": {c: float(f"{size:.4g}") for c, size in finding.sizes.items() if size > 0.0},
        "onset": None if term.onset is None else float(term.onset - fitted.chain.clock[0]),
        **({"spells": _episodes(term, fitted)} if term.switches else {}),
        "parameters": {},
        "sentence": _sentence(term, values, term.effect.quantities(fitted.chain), recording)
        + _at_another_time(term, [(t, m) for _, t, m in explanations.values()]),
        "separated_by": term.effect.separated_by,
    }
    for q in term.effect.quantities(fitted.chain):
        value = fitted.values[f"{term.effect.key}.{q.name}"]
        interval = interval_of(problem, term, fitted, q)
        entry["parameters"][q.name] = _in_units(q, value, interval, recording) | {
            "unknown_ends": _unknown_ends(q, interval)
        }
    entry["evidence"] = {
        "gain": float(f"{finding.gain:.4g}"),
        "runner_up": _runner_up(finding, explanations),
        "vanishes": vanishing(term.effect, entry["parameters"]),
        "no_interval": without_interval(term.effect, entry["parameters"]),
        "at_bound": [q.name for q in term.effect.quantities(fitted.chain) if _at_bound(term, fitted, q)],
    }
    return entry


def _runner_up(finding: Finding, in_class: Collection[str]) -> float | None:
    """Distance of the likeliest explanation that is not in the class; None without one."""
    others = [r.distance for r in finding.rivals if r.term.effect.name not in in_class]
    return float(f"{min(others):.4g}") if others else None


def _at_bound(term: Term, fitted: Model, quantity: Quantity) -> bool:
    """Whether the size of an effect ends where physics ends, other than where the effect vanishes."""
    value, low, high = fitted.values[f"{term.effect.key}.{quantity.name}"], quantity.low, quantity.high
    if quantity.null is None:
        return False
    if quantity.log:
        value, low, high = np.log([value, low, high])
    near = _NEAR_BOUND * (high - low)
    return bool(value >= high - near or (value <= low + near and quantity.low != quantity.null))


def _unknown_ends(quantity: Quantity, ends: Sequence[float] | None) -> list[str]:
    """Ends of an interval that are only the bound of what is tried; no effect, and nothing left, are ends."""
    if not ends:
        return []
    names = ("lower", ends[0], quantity.low), ("upper", ends[1], quantity.high)
    near = _NEAR_BOUND * (quantity.high - quantity.low)
    return [
        name
        for name, end, bound in names
        if bound not in (quantity.null, 0.0) and (end == bound or (name == "upper" and end >= bound - near))
    ]


def _episodes(term: Term, fitted: Model) -> list[list[float]]:
    """From when to when an effect acts that comes and goes [s from the first sample]."""
    clock = fitted.chain.clock
    times = [*term.times, *([clock[-1]] if len(term.times) % 2 else [])]
    return [[float(a - clock[0]), float(b - clock[0])] for a, b in zip(times[::2], times[1::2], strict=True)]


def _sentence(
    term: Term, values: dict[str, float], quantities: Sequence[Quantity], recording: Recording
) -> str:
    """The effect's own words; pressures in the recording's own unit."""
    unit, shown = "Pa", dict(values)
    if "p1" in recording:
        unit, scale = recording.unit("p1"), abs(recording.per_si("p1"))
        shown |= {q.name: scale * values[q.name] for q in quantities if q.unit == "Pa"}
    effect = term.effect
    said = effect.phrase.format(pressure_unit=unit, **shown)
    said = said or effect.clause or f"there is {effect.spoken}"
    text = re.sub(r"(?<=\d)%", " %", said)
    return text[0].upper() + text[1:] + "."


def _at_another_time(term: Term, explanations: Sequence[tuple[Term, Model]]) -> str:
    """When those of a class began that act from another time on than its first; empty where all do as it."""
    others = [(t, m) for t, m in explanations if (t.onset is None) != (term.onset is None)]
    if not others:
        return ""
    *names, last = [t.effect.spoken for t, _ in others]
    either = f"{', '.join(names)} or {last}" if names else last
    begun = [t.onset - m.chain.clock[0] for t, m in others if t.onset is not None]
    if not begun:
        return f" If it is {either}, it acts from the start."
    first, last_of_all = f"{min(begun):.0f}", f"{max(begun):.0f}"
    when = first if first == last_of_all else f"{first} to {last_of_all}"
    return f" If it is {either}, it began {when} s after the first row."


def _in_units(
    quantity: Quantity, value: float, interval: Sequence[float] | None, recording: Recording
) -> dict[str, Any]:
    """A parameter with its interval; a flow or a pressure in the recording's own unit."""
    unit, (value, *ends) = in_recorded_unit(quantity.unit, [value, *(interval or ())], recording)
    return {"value": value, "unit": unit, "ci95": sorted(ends) if ends else None}


def in_recorded_unit(unit: str, numbers: Sequence[float], recording: Recording) -> tuple[str, list[float]]:
    """Differences in SI, and their unit; a flow or a pressure in the recording's own unit.

    Parameters
    ----------
    unit : str
        Of the numbers, in SI.
    numbers : sequence of float
    recording : Recording

    Returns
    -------
    unit : str
    numbers : list of float
    """
    if unit == "Pa" and "p1" in recording:
        numbers = [v * abs(recording.per_si("p1")) for v in numbers]
        unit = recording.unit("p1")
    if unit.startswith(("m3/s", "kg/s")):
        zero = recording.in_recorded_units("flow", np.zeros(1))[0]
        numbers = [float(recording.in_recorded_units("flow", np.array([v]))[0] - zero) for v in numbers]
        unit = recording.unit("flow") + ("/h" if unit.endswith("/s/h") else "")
    return unit, [float(v) for v in numbers]
