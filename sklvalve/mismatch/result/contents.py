# SPDX-License-Identifier: BSD-3-Clause
"""What a diagnosis says, laid out as diagnosis.json has it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import sklvalve
from sklvalve.mismatch.decide.dated import change_entry
from sklvalve.mismatch.decide.detect import p_value_of_residual
from sklvalve.mismatch.decide.kinds import kind_of_class
from sklvalve.mismatch.decide.reasons import reasons_of
from sklvalve.mismatch.decide.records import plain_records
from sklvalve.mismatch.describe.describing import described, scales_of
from sklvalve.mismatch.describe.locate import acting_rows, location_of
from sklvalve.mismatch.next_test.suggestions import next_test
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.residual.smooth_pattern import Pattern
from sklvalve.mismatch.result.effect_entry import effect_entry
from sklvalve.mismatch.result.referee_entry import referee_entry
from sklvalve.mismatch.result.since_history import of_history, since_history
from sklvalve.mismatch.search.events import events_of, named_by_events
from sklvalve.mismatch.search.rivals import class_of, leading_term
from sklvalve.recording.calendar_time import begins_of
from sklvalve.simulation.simulation import learnt_rest

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.decision import Decision
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.next_test.plan import TestPlan
    from sklvalve.mismatch.residual.goodness_of_fit import LeftOver
    from sklvalve.mismatch.residual.pulses import Pulses
    from sklvalve.mismatch.residual.stem_residual import StemResidual
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.mismatch.search.rivals import Finding
    from sklvalve.recording import Recording

# what strays within this share of a recording is taken to have been there before
_AT_FIRST = 0.1


def onset_of(judgement: Judgement) -> float | None:
    """Time from the first sample at which all that was found begins [s]; None if it was there before."""
    aside = aside_of(judgement.findings)
    onsets = [leading_term(f).onset for f in judgement.findings if f.term.effect.key not in aside]
    begun = [onset for onset in onsets if onset is not None]
    if not begun or len(begun) < len(onsets):
        return None
    return float(min(begun) - judgement.model.chain.clock[0])


def aside_of(findings: list[Finding]) -> set[str]:
    """Keys of a sound valve's properties where something else was found: a report is about when that acts."""
    properties = [f for f in findings if kind_of_class(f) == "property"]
    return {f.term.effect.key for f in properties} if len(properties) < len(findings) else set()


def flagged_rows(problem: Problem, judgement: Judgement) -> np.ndarray:
    """Rows in which what was found acts."""
    unknown, model = judgement.unknown, judgement.model
    # switched off in the same simulation, not calibrated away: so it shows where it acts itself
    flagged = acting_rows(problem, model, problem.simulate((), model.values))
    if unknown is not None and not judgement.findings:
        learnt = np.abs(learnt_rest(unknown.correction, model.chain, model.values))
        flagged = learnt > 0.25 * np.quantile(learnt, 0.99)
    if judgement.suspected is not None and judgement.detected:
        near = judgement.suspected
        flagged = flagged | acting_rows(problem, near, problem.simulate((), near.values))
    for seen in (judgement.strays, judgement.pulses):
        flagged = flagged if seen is None else flagged | seen.rows
    events = events_of(problem.recording) if named_by_events(judgement.findings) else None
    if events is not None:
        flagged = flagged | events.flagged
    onset = onset_of(judgement)
    if onset is not None:
        flagged &= model.chain.clock - model.chain.clock[0] >= onset
    return flagged


def content_of(
    whole: Recording,
    problem: Problem,
    judgement: Judgement,
    decision: Decision,
    flagged: np.ndarray,
    fit: dict,
    *,
    data: list[dict],
    not_testable: list[dict],
    alpha: float,
    random_state: int,
    mend: str | None,
    plan: TestPlan | None,
) -> dict[str, Any]:
    """The plain data of diagnosis.json, schema ``sklvalve.diagnosis/1``.

    `mend` is what to do to the data, and `plan` the next test, where there is one.
    """
    judgement = replace(judgement, verdict=decision.verdict)
    unexplained = _unexplained(judgement)
    classes = [class_of(f) for f in judgement.findings]
    since = since_history(whole, problem, judgement, alpha)
    return {
        "schema": "sklvalve.diagnosis/1",
        "subject": "valve",
        "verdict": decision.verdict,
        "mismatch": {"detected": judgement.detected, "p_value": judgement.p_value, "alpha": alpha},
        "location": _location(whole, problem, judgement, decision.entries, alpha, random_state),
        "effects": decision.entries,
        "comparison": judgement.comparison.in_order_of(problem, judgement.findings).to_records(),
        "fit": fit,
        "proof": "later_rows" if len(whole) > len(problem.recording) else "forward",
        "not_testable": not_testable,
        "detection_limits": plain_records(judgement.limits if decision.verdict == "no_mismatch" else ()),
        "next_test": mend or next_test(classes, judgement.verdict, unexplained, problem, plan),
        "data": [{k: d[k] for k in ("finding", "role", "detail")} for d in data],
        "provenance": _provenance(whole, problem, random_state),
        "units": {role: whole.unit(role) for role in whole},
        "spans": _spans(whole, problem),
        "rules": plain_records(decision.rules),
        "reasons": [*reasons_of(judgement, mend, problem, decision.doubts), *of_history(since)],
        "details": [plan.details] if plan is not None and plan.details and not mend else [],
        **_of_referee(whole, judgement),
        **_of_unknown(whole, problem, judgement),
        **since,
    }


def _spans(whole: Recording, problem: Problem) -> dict[str, float]:
    """Spans by which a size that is a share of one becomes one in the recording's own unit."""
    return {c: float(f"{problem.spans[c] * abs(whole.per_si(c)):.4g}") for c in problem.channels}


def _unexplained(judgement: Judgement) -> Unknown | LeftOver | LeftSince | Pulses | Pattern | None:
    """What no effect explains, of whatever kind; None where nothing is."""
    kinds = judgement.unknown, judgement.left, judgement.pulses, judgement.pattern
    return next((kind for kind in kinds if kind is not None), None)


def _location(
    whole: Recording,
    problem: Problem,
    judgement: Judgement,
    entries: list[dict],
    alpha: float,
    random_state: int,
) -> dict[str, Any]:
    """Where and when what was found acts."""
    blocks = _blocks(judgement, entries)
    location: dict[str, Any] = {"blocks": blocks, "regions": [], "onset": None, "intervals": []}
    if judgement.strays is not None:
        location |= _when_seen(judgement, judgement.strays, ["actuator"])
    elif judgement.pulses is not None:
        location |= _when_seen(judgement, judgement.pulses, ["line", "measurement", "valve"])
    elif judgement.detected:
        location = location_of(
            problem,
            judgement.suspected or judgement.model,
            judgement.unknown,
            blocks,
            alpha=alpha,
            random_state=random_state,
            aside=aside_of(judgement.findings),
        )
    location["change"] = change_entry(whole, judgement, location)
    joined = _recordings(whole)
    if joined:
        # times are of their common clock, and read by the recording that they fall into
        location["recordings"] = [{k: each[k] for k in ("source", "begins", "assumed")} for each in joined]
    return location


def _blocks(judgement: Judgement, entries: list[dict]) -> list[str]:
    """Parts of the plant in which it may be."""
    blocks = sorted({block for entry in entries for block in entry["blocks"]})
    if not blocks and judgement.detected:
        blocks = list(judgement.suspects)
    unexplained = _unexplained(judgement)
    if not blocks and unexplained is not None:
        blocks = ["valve" if unexplained.channel == "flow" else "actuator"]
    return blocks


def _provenance(whole: Recording, problem: Problem, random_state: int) -> dict[str, Any]:
    joined = _recordings(whole)
    return {
        "sklvalve": sklvalve.__version__,
        "recording_sha256": whole.sha256,
        "rows": len(problem.recording),
        "random_state": random_state,
        **({"recordings": joined} if joined else {}),
        **_of_history(problem),
        **begins_of(whole),
    }


def _of_history(problem: Problem) -> dict[str, Any]:
    """What the recording was held against beside the sheet; nothing where no history was given."""
    history = problem.history
    if history is None:
        return {}
    outside = history.range_.outside(problem.recording)
    return {
        "history": {
            "rows": history.rows,
            "days": round(history.days, 4),
            "recordings": [{"name": each.name, "sha256": each.sha256} for each in history.recordings_],
            "verdict": None if history.by_itself_ is None else history.by_itself_.verdict,
            "effects": [effect.name for effect in history.effects],
            "outside": {name: round(share, 4) for name, share in outside.items()},
        }
    }


def _of_referee(whole: Recording, judgement: Judgement) -> dict[str, Any]:
    return {} if judgement.referee is None else {"referee": referee_entry(judgement.referee, whole)}


def _of_unknown(whole: Recording, problem: Problem, judgement: Judgement) -> dict[str, Any]:
    """The entry of what no effect explains, where there is such."""
    unexplained = _unexplained(judgement)
    if unexplained is None:
        return {}
    unknown = judgement.unknown
    entry = (
        _unlearnt(unexplained, judgement) if unknown is None else _unknown_entry(whole, unknown, judgement)
    )
    if judgement.left is not None:
        entry |= _beyond_noise(whole, problem, judgement, judgement.left)
    if judgement.pulses is not None:
        entry |= _pulses_entry(judgement.pulses)
    return {"unknown": entry}


def _when_seen(judgement: Judgement, seen: StemResidual | Pulses, blocks: list[str]) -> dict[str, Any]:
    """Place and times of a location, where rows speak for themselves [s from the first sample]."""
    clock = judgement.model.chain.clock - judgement.model.chain.clock[0]
    rows, last = seen.intervals, len(clock) - 1
    seconds = [[float(clock[a]), float(clock[min(b, last)])] for a, b in rows]
    onset = seconds[0][0] if rows[0][0] > _AT_FIRST * len(clock) else None
    return {"blocks": blocks, "onset": onset, "intervals": seconds}


def _recordings(whole: Recording) -> list[dict[str, Any]]:
    """The recordings that were joined, as plain data; none where it is one."""
    rows = [high - low for low, high in whole.spans] if whole.pieces else []
    return [
        {
            "source": Path(p.source).name,
            "sha256": p.sha256,
            "rows": many,
            "begins": p.begins - whole.time[0],
            "assumed": p.assumed,
        }
        for p, many in zip(whole.pieces, rows, strict=True)
    ]


def _unlearnt(
    left: Unknown | LeftOver | LeftSince | Pulses | Pattern, judgement: Judgement
) -> dict[str, Any]:
    """The entry of a rest of which nothing is learnt; it follows from nothing recorded but a pattern."""
    signals = []
    if isinstance(left, Pattern):
        p_value, signals = None, list(left.inputs)
    elif isinstance(left, LeftSince):
        # how often chance leaves as much is asked of healthy valves and their histories
        p_value = None if judgement.evidence is None else p_value_of_residual(judgement.evidence)
    else:
        p_value = left.p_value
    return {
        "signal": left.channel,
        "inputs": signals,
        "size": left.size,
        "skill": None,
        "p_value": p_value,
        "correction": {"added": False, "rmse_without": None, "rmse_with": None},
    }


def _beyond_noise(
    whole: Recording, problem: Problem, judgement: Judgement, left: LeftOver | LeftSince
) -> dict[str, Any]:
    """How far a rest is beyond noise, and what comes closest of the known effects and is not named for it."""
    leaves = judgement.closest_leaves
    closest = [effect_entry(f, whole, problem) for f in judgement.closest]
    for entry in closest:
        # they are refuted: none of their names has a probability
        entry["members"] = [candidate | {"probability": None} for candidate in entry["members"]]
    keys = ("members", "size", "sentence")
    return {
        "beyond_noise": left.beyond_noise,
        "closest": [{key: entry[key] for key in keys} for entry in closest],
        "closest_leaves": leaves.size if closest and leaves is not None and leaves.too_much else None,
    }


def _pulses_entry(pulses: Pulses) -> dict[str, Any]:
    """To which side a flow breaks out, and how often to that one and to the other."""
    side = "below" if pulses.falls else "above"
    return {"pulses": {"side": side, "moments": pulses.many, "against": pulses.against}}


def _unknown_entry(whole: Recording, unknown: Unknown, judgement: Judgement) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "signal": unknown.channel,
        "inputs": list(unknown.inputs),
        "size": unknown.size,
        "skill": unknown.skill,
        "p_value": unknown.p_value,
        # learnt without them: what a prediction of rows that are still to come would be like
        "correction": {"added": judgement.kept, "rmse_without": None, "rmse_with": None},
    }
    unit = whole.per_si(unknown.channel)
    entry |= described(unknown.correction, unit, whole.unit(unknown.channel), scales_of(whole))
    if judgement.errors is not None:
        rmse = abs(unit) * np.array(judgement.errors)
        entry["correction"] |= {"rmse_without": float(rmse[0]), "rmse_with": float(rmse[1])}
    return entry
