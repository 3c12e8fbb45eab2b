# SPDX-License-Identifier: BSD-3-Clause
"""The ``since_history`` part of diagnosis.json: then and now, what may change, what a history cannot say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history import Allowance
from sklvalve.history.operating_range import OperatingRange, limits_in_recorded_units
from sklvalve.history.then import expected_of, simulation_then
from sklvalve.mismatch.decide.detect import mismatch_p_value
from sklvalve.mismatch.decide.null_reference import AGAINST_HISTORY
from sklvalve.mismatch.decide.rules import percent
from sklvalve.mismatch.describe.intervals import interval_of
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.result.effect_entry import in_recorded_unit
from sklvalve.mismatch.result.held import held_entries
from sklvalve.mismatch.search.rivals import class_of

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Finding
    from sklvalve.recording import Recording

# where fewer rows are outside, the history says enough of the recording
_OUTSIDE = 0.01
_ALLOWED = {
    "capacity": "capacity together with the gain of the flow meter, relative",
    "trim": "capacity at each opening beside that at full travel, relative",
    "unseen_drop": "the same where no pressure drop is recorded, share of what is open before any data",
    "recovery": "pressure recovery factor F_L, relative",
    "response": "stem and flow by time constants, speeds, gains and friction, rms, share of the span",
    "position_zero": "zero of the position sensor and of the stem, share of travel",
    "play": "play of the linkage and of the plug, share of travel",
    "flow_zero": "zero of the flow meter, share of its span",
    "pressure_zero": "zero of a pressure sensor, share of its span",
}


def since_history(whole: Recording, problem: Problem, judgement: Judgement, alpha: float) -> dict[str, Any]:
    """The part of a diagnosis that a history makes.

    Parameters
    ----------
    whole : Recording
        For the units.
    problem : Problem
    judgement : Judgement
    alpha : float
        Level of the test.

    Returns
    -------
    part : dict
        ``since_history``: ``rows``, ``days``, ``recordings``, ``first`` and ``last`` stamp of the history;
        ``allowances``; ``by_itself``, what the history lacked by itself, None where that was not asked;
        ``rehearsals``, how far its second half lies from its first, and ``rehearsed``, a sentence where that
        is why nothing is told; ``held``, what it had already, then and now; ``changes``, one for each entry
        of ``effects``; ``calibration``, then and now; ``residuals`` by channel; ``cannot_say``. Empty
        where no history was given.
    """
    history = problem.history
    if history is None:
        return {}
    return {
        "since_history": {
            "rows": history.rows,
            "days": round(history.days, 4),
            "recordings": len(history.recordings_),
            "first": history.recordings_[0].first,
            "last": history.recordings_[-1].last,
            "allowances": _allowances(history),
            "by_itself": _by_itself(history),
            "rehearsals": [asdict(each) for each in history.rehearsals_],
            "rehearsed": _rehearsed(judgement, alpha),
            "held": held_entries(whole, problem, history, judgement.model),
            "changes": [_change(whole, problem, finding) for finding in judgement.findings],
            "calibration": _calibration(history, judgement.model, whole),
            "residuals": _residuals(history, problem, judgement.model, whole),
            "cannot_say": _cannot_say(history, problem, whole),
        }
    }


def of_history(part: dict[str, Any]) -> list[str]:
    """Sentences on a history that was not sound, and on what of it has changed since.

    Parameters
    ----------
    part : dict
        Of `since_history`.
    """
    since = part.get("since_history") or {}
    by_itself = since.get("by_itself") or {}
    sentences = [by_itself["sentence"]] if by_itself.get("sentence") else []
    sentences += [since["rehearsed"]] if since.get("rehearsed") else []
    return sentences + [each["sentence"] for each in since.get("held") or [] if each["change"] != "none"]


def _by_itself(history: ValveHistory) -> dict[str, Any] | None:
    """What a diagnosis of the history itself said."""
    by_itself = history.by_itself_
    return None if by_itself is None else asdict(by_itself) | {"sentence": by_itself.sentence}


def _rehearsed(judgement: Judgement, alpha: float) -> str | None:
    """Why nothing is told where the reference alone would have found something rare."""
    evidence = judgement.evidence
    if evidence is None or judgement.verdict != "no_mismatch":
        return None
    by_reference = mismatch_p_value(replace(evidence, law=AGAINST_HISTORY))
    if by_reference > alpha or mismatch_p_value(evidence) <= alpha:
        return None
    return (
        f"A difference this large occurs in {percent(by_reference)} of healthy simulated recordings, but the "
        "second half of this valve's history differs from the first as well, by more than in other valves. "
        "So it is not told as a change."
    )


def _allowances(history: ValveHistory) -> list[dict[str, Any]]:
    """What may change without a fault, each a standard deviation."""
    allowance = history.allowed
    return [
        {
            "name": field.name,
            "value": float(getattr(allowance, field.name)),
            "unit": "1",
            "words": _ALLOWED.get(field.name, field.name.replace("_", " ")),
        }
        for field in fields(Allowance)
    ]


def _change(whole: Recording, problem: Problem, finding: Finding) -> dict[str, Any]:
    """Size of one finding in the unit of its first parameter and in flow, with intervals."""
    _, term, fitted = next(iter(class_of(finding).values()))
    first = term.effect.quantities(fitted.chain)[0]
    key = f"{term.effect.key}.{first.name}"
    ends = interval_of(problem, term, fitted, first) or ()
    sizes = [fitted.values[key], *ends]
    unit, (value, *within) = in_recorded_unit(first.unit, sizes, whole)
    return {
        "name": term.effect.name,
        "parameter": first.name,
        "value": value,
        "unit": unit,
        "ci95": sorted(within) or None,
        "flow": _flow_entry(whole, problem, term, [_in_flow(problem, term, fitted, key, v) for v in sizes]),
    }


def _flow_entry(
    whole: Recording, problem: Problem, term: Term, sizes: Sequence[float | None]
) -> dict[str, Any] | None:
    """A change of the flow, and the same at both ends of the interval; None without a simulated flow."""
    known = [float(f"{size * abs(whole.per_si('flow')):.4g}") for size in sizes if size is not None]
    if not known:
        return None
    return {
        "value": known[0],
        "unit": whole.unit("flow"),
        "ci95": [min(known), max(known)] if len(known) > 1 else None,
        "at_the_same": "command" if problem.coupled or _moves_stem_only(problem, term) else "opening",
    }


def _moves_stem_only(problem: Problem, term: Term) -> bool:
    """Whether an effect changes the flow by the opening alone, which is recorded."""
    return not problem.coupled and "flow" not in problem.channels_touched(term.effect)


def _in_flow(problem: Problem, term: Term, fitted: Model, key: str, value: float) -> float | None:
    """Rms change of the flow where an effect of some size acts [SI]; None without a simulated flow.

    Of an effect that moves the stem alone it is the flow at the same command.
    """
    if "flow" not in problem.channels:
        return None
    others = tuple(m for m in fitted.terms if m.effect.key != term.effect.key)
    values = fitted.values | {key: value}
    acting, without = problem.simulate(fitted.terms, values), problem.simulate(others, values)
    if _moves_stem_only(problem, term):
        acting, without = _by_command(acting), _by_command(without)
    return problem.change(acting, without)["flow"] * problem.spans["flow"]


def _by_command(model: Model) -> Model:
    """The same simulation whose flow follows the command instead of the recorded opening."""
    flow = model.chain.flow(model.values, model.chain.drive_of_free_run(model.values))
    return replace(model, predictions=model.predictions | {"flow": flow})


def _calibration(history: ValveHistory, model: Model, whole: Recording) -> list[dict[str, Any]]:
    """Each parameter then, with what is expected of it now, and now; in recorded units."""
    rows = []
    for each in expected_of(history):
        now = model.values.get(each.name)
        if now is None:
            continue
        unit, numbers = in_recorded_unit(each.unit, [each.value, each.low, each.high, now], whole)
        rows.append(
            {
                "name": each.name,
                "unit": unit,
                "then": numbers[0],
                "ci95": sorted(numbers[1:3]),
                "now": numbers[3],
                "deviations": float(f"{each.deviations(now):.3g}"),
                "informed": each.informed,
            }
        )
    return rows


def _residuals(
    history: ValveHistory, problem: Problem, model: Model, whole: Recording
) -> dict[str, dict[str, Any]]:
    """Rms by channel: left in the history, left now by the simulation of then, and by that of now."""
    made = simulation_then(history).simulate(problem.recording)
    now, rows = problem.residuals(model), {}
    for channel in problem.channels:
        if channel not in made or channel not in history.channels:
            continue
        unit, left = abs(whole.per_si(channel)), problem.recording[channel] - made[channel]
        rows[channel] = {
            "unit": whole.unit(channel),
            "history": history.left(channel) * unit,
            "by_then": _rms(left * unit),
            "by_now": _rms(now[channel] * unit),
        }
    return rows


def _cannot_say(history: ValveHistory, problem: Problem, whole: Recording) -> dict[str, Any]:
    """Ranges and parameters that the history does not know."""
    limits = limits_in_recorded_units(history.range_, whole)
    here = limits_in_recorded_units(OperatingRange.of(problem.recording), whole)
    outside = history.range_.outside(problem.recording)
    return {
        "outside": [
            {"signal": name, "share": round(share, 4), "history": limits[name], "here": here[name]}
            for name, share in outside.items()
            if share >= _OUTSIDE
        ],
        "not_informed": [each.name for each in expected_of(history) if not each.informed],
    }


def _rms(values: np.ndarray) -> float | None:
    return float(np.sqrt(np.nanmean(values**2))) if np.isfinite(values).any() else None
