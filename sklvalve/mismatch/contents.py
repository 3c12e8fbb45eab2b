# SPDX-License-Identifier: BSD-3-Clause
"""What a diagnosis says, laid out as diagnosis.json has it, and the traces that pictures are drawn from."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import sklvalve
from sklvalve.mismatch.assessing import assessed
from sklvalve.mismatch.dated import change_entry
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.compare import EMPTY, Comparison
from sklvalve.mismatch.describing import described, scales_of
from sklvalve.mismatch.events import events_of, named_by_events
from sklvalve.mismatch.kinds import kind_of_class, with_kinds
from sklvalve.mismatch.locate import acting_rows, location_of
from sklvalve.mismatch.next_test import next_test
from sklvalve.mismatch.reasons import reasons_of
from sklvalve.mismatch.referee import referee_entry, skills_ahead
from sklvalve.mismatch.verdict import class_of, effect_entry
from sklvalve.recording.calendar_time import begins_of, first_stamp
from sklvalve.simulation.simulation import learnt_rest

if TYPE_CHECKING:
    from sklvalve.mismatch.change import Change
    from sklvalve.mismatch.detect import Evidence
    from sklvalve.mismatch.goodness_of_fit import LeftOver
    from sklvalve.mismatch.hypothesis import Model
    from sklvalve.mismatch.prove import CrossValidated
    from sklvalve.mismatch.pulses import Pulses
    from sklvalve.mismatch.referee.decision import Referee
    from sklvalve.mismatch.rivals import Finding
    from sklvalve.mismatch.stem_residual import StemResidual
    from sklvalve.mismatch.unknown import Unknown

# what strays within this share of a recording is taken to have been there before
_AT_FIRST = 0.1


@dataclass(frozen=True, eq=False)
class Judgement:
    """What was made of a recording.

    Attributes
    ----------
    verdict : str
    p_value : float or None
        None where nothing was asked, because the data must be mended first.
    findings : list of Finding
    unknown : Unknown or None
    nominal, model : Model
        The simulation calibrated without and with the findings.
    tried : CrossValidated or None
        `model` with the learnt rest, block by block, where there is a rest.
    kept : bool
        Whether the learnt rest lowers the error of rows it was not learnt from, so that it is added.
    errors : tuple of float or None
        Rms of the unknown's channel on such rows, without and with the learnt rest [SI].
    evidence : Evidence or None
        What the p-value was made of.
    left : LeftOver or None
        What the simulation without any effect leaves over of the flow, where that is missing physics, and no
        effect explains it well enough to be named.
    closest : list of Finding
        Those that come closest to it.
    closest_leaves : LeftOver or None
        What they leave over of it.
    strays : StemResidual or None
        Where the stem is further off than any sound one, and nothing that was tried tells why.
    pulses : Pulses or None
        Where the flow breaks out to one side, again and again, and no noise does.
    suspects : tuple of str
        Blocks of the effects that come near, each by itself, to explaining what was found; sorted.
    suspected : Model or None
        The hypothesis of the search, where none of it may be named: it tells in which rows something is.
    referee : Referee or None
        The black box that the verdict was held against; None where nothing was asked.
    change : Change or None
        When a signal changed, whatever made it.
    event : Change or None
        The same where it is one of the last rows, which were judged by themselves.
    why : tuple of str
        Checks that stopped a name, in words.
    comparison : Comparison
        All hypotheses that were compared.
    rules : tuple of Rule
        Those that were asked, in turn.
    """

    verdict: str
    p_value: float | None
    findings: list[Finding]
    unknown: Unknown | None
    nominal: Model
    model: Model
    tried: CrossValidated | None = None
    kept: bool = False
    errors: tuple | None = None
    evidence: Evidence | None = None
    left: LeftOver | None = None
    closest: list[Finding] = field(default_factory=list)
    closest_leaves: LeftOver | None = None
    strays: StemResidual | None = None
    pulses: Pulses | None = None
    suspects: tuple = ()
    suspected: Model | None = None
    referee: Referee | None = None
    change: Change | None = None
    event: Change | None = None
    why: tuple = ()
    comparison: Comparison = EMPTY
    rules: tuple = ()

    @property
    def names_event(self):
        """Whether what happened in the last rows has a name."""
        onsets = [f.term.onset for f in self.findings if f.term.onset is not None]
        clock = self.model.chain.clock
        return self.event is not None and any(t >= clock[self.event.within[0]] for t in onsets)

    @property
    def found(self):
        """Whether anything is missing."""
        return self.verdict != "no_mismatch" and self.p_value is not None

    @property
    def correction(self):
        """The learnt rest that joins the corrected simulation; None where there is none."""
        return self.unknown.correction if self.kept else None


def onset_of(judgement):
    """Time from the first sample at which all that was found begins [s]; None if it was there before."""
    aside = aside_of(judgement.findings)
    onsets = [f.term.onset for f in judgement.findings if f.term.effect.key not in aside]
    if not onsets or None in onsets:
        return None
    return float(min(onsets) - judgement.model.chain.clock[0])


def aside_of(findings):
    """Keys of a sound valve's properties where something else was found: a report is about when that acts."""
    properties = [f for f in findings if kind_of_class(f) == "property"]
    return {f.term.effect.key for f in properties} if len(properties) < len(findings) else set()


def flagged_rows(problem, judgement):
    """Rows in which what was found acts."""
    unknown, model = judgement.unknown, judgement.model
    # switched off in the same simulation, not calibrated away: so it shows where it acts itself
    flagged = acting_rows(problem, model, problem.simulate((), model.values))
    if unknown is not None and not judgement.findings:
        rest = np.abs(learnt_rest(unknown.correction, model.chain, model.values))
        flagged = rest > 0.25 * np.quantile(rest, 0.99)
    if judgement.suspected is not None and judgement.found:
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
    whole, problem, judgement, flagged, fit, *, data, not_testable, alpha, random_state, mend, plan
):
    """The plain data of diagnosis.json, schema ``sklvalve.diagnosis/1``.

    `mend` is what to do to the data, and `plan` the next test, where there is one.
    """
    unknown, found = judgement.unknown, judgement.found
    entries = [with_kinds(effect_entry(f, whole, problem), f) for f in judgement.findings]
    # forecasts of the rows used: those kept for the final figures must decide nothing
    seen = () if judgement.referee is None else judgement.referee.compared
    ahead = skills_ahead(problem, seen)
    entries, verdict, doubts = assessed(entries, judgement.verdict, judgement.p_value, ahead, data, problem)
    asked = _asked(judgement, entries, verdict, alpha)
    judgement = replace(judgement, verdict=verdict)
    blocks = sorted({b for e in entries for b in e["blocks"]})
    rest = next((r for r in (unknown, judgement.left, judgement.pulses) if r is not None), None)
    if not blocks and judgement.found:
        blocks = list(judgement.suspects)
    if not blocks and rest is not None:
        blocks = ["valve" if rest.channel == "flow" else "actuator"]
    classes = [class_of(f) for f in judgement.findings]
    location = {"blocks": blocks, "regions": [], "onset": None, "intervals": []}
    if judgement.strays is not None:
        location |= _when_seen(judgement, judgement.strays, ["actuator"])
    elif judgement.pulses is not None:
        location |= _when_seen(judgement, judgement.pulses, ["line", "measurement", "valve"])
    elif found:
        more = {"alpha": alpha, "random_state": random_state, "aside": aside_of(judgement.findings)}
        seen = judgement.suspected or judgement.model
        location = location_of(problem, seen, unknown, blocks, **more)
    location["change"] = change_entry(whole, judgement, location)
    joined = _recordings(whole)
    if joined:
        # times are of their common clock, and read by the recording that they fall into
        location["recordings"] = [{k: each[k] for k in ("source", "begins", "assumed")} for each in joined]
    content = {
        "schema": "sklvalve.diagnosis/1",
        "subject": "valve",
        "verdict": verdict,
        "mismatch": {"detected": found, "p_value": judgement.p_value, "alpha": alpha},
        "location": location,
        "effects": entries,
        "comparison": judgement.comparison.to_records(),
        "fit": fit,
        "proof": "later_rows" if len(whole) > len(problem.recording) else "forward",
        "not_testable": not_testable,
        "next_test": mend or next_test(classes, judgement.verdict, rest, problem, plan),
        "data": [{k: d[k] for k in ("finding", "role", "detail")} for d in data],
        "provenance": {
            "sklvalve": sklvalve.__version__,
            "recording_sha256": whole.sha256,
            "rows": len(problem.recording),
            "random_state": random_state,
            **({"recordings": joined} if joined else {}),
            **begins_of(whole),
        },
        "units": {role: whole.unit(role) for role in whole},
        # by these a size that is a share of its signal's span becomes one in the recording's own unit
        "spans": {c: float(f"{problem.spans[c] * abs(whole.per_si(c)):.4g}") for c in problem.channels},
    }
    content["rules"] = rules.to_records(asked)
    content["reasons"] = reasons_of(judgement, mend, problem, doubts)
    content["details"] = [plan.details] if plan is not None and plan.details and not mend else []
    if judgement.referee is not None:
        content["referee"] = referee_entry(judgement.referee, whole)
    if rest is not None:
        content["unknown"] = _unknown_entry(whole, judgement) if unknown is not None else _unlearnt(rest)
    if judgement.left is not None:
        content["unknown"] |= _beyond_noise(whole, problem, judgement)
    if judgement.pulses is not None:
        content["unknown"] |= _in_moments(judgement.pulses)
    return content


def _asked(judgement, entries, verdict, alpha):
    """All rules that were asked, the last of them by what the diagnosis ends with."""
    asked = list(judgement.rules)
    if judgement.p_value is not None:
        # what was seen later, such as a change or a black box, counts as well
        asked.append(rules.rarity(judgement.p_value, alpha))
    if judgement.verdict == "named":
        likeliest = max(entries, key=lambda entry: entry["probability"] or 0.0)
        asked.append(rules.probability(likeliest["probability"], verdict == "named"))
    return rules.in_order(asked)


def _when_seen(judgement, seen, blocks):
    """Place and times of a location, where rows speak for themselves [s from the first sample]."""
    clock = judgement.model.chain.clock - judgement.model.chain.clock[0]
    rows, last = seen.intervals, len(clock) - 1
    seconds = [[float(clock[a]), float(clock[min(b, last)])] for a, b in rows]
    onset = seconds[0][0] if rows[0][0] > _AT_FIRST * len(clock) else None
    return {"blocks": blocks, "onset": onset, "intervals": seconds}


def _recordings(whole):
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


def _unlearnt(left):
    """The entry of a rest that follows from nothing recorded, as far as can be told."""
    return {
        "signal": left.channel,
        "inputs": [],
        "size": left.size,
        "skill": None,
        "p_value": left.p_value,
        "correction": {"added": False, "rmse_without": None, "rmse_with": None},
    }


def _beyond_noise(whole, problem, judgement):
    """How far a rest is beyond noise, and what comes closest of the known effects and is not named for it."""
    left, leaves = judgement.left, judgement.closest_leaves
    closest = [effect_entry(f, whole, problem) for f in judgement.closest]
    for entry in closest:
        # they are refuted: none of their names has a probability
        entry["members"] = [member | {"probability": None} for member in entry["members"]]
    keys = ("members", "size", "sentence")
    return {
        "beyond_noise": {"size": left.size, "noise": left.noise, "allowed": left.allowed},
        "closest": [{key: entry[key] for key in keys} for entry in closest],
        "closest_leaves": leaves.size if closest and leaves is not None and leaves.too_much else None,
    }


def _in_moments(pulses):
    """To which side a flow breaks out, and how often to that one and to the other."""
    side = "below" if pulses.falls else "above"
    return {"pulses": {"side": side, "moments": pulses.many, "against": pulses.against}}


def _unknown_entry(whole, judgement):
    unknown = judgement.unknown
    entry = {
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
        told = abs(unit) * np.array(judgement.errors)
        entry["correction"] |= {"rmse_without": float(told[0]), "rmse_with": float(told[1])}
    return entry


def traces_of(whole, flagged, used, nominal, corrected):
    """Arrays for pictures, of every row, in the recording's own units.

    Parameters
    ----------
    whole : Recording
    flagged : ndarray of bool
        Of the rows used.
    used : int
    nominal, corrected : ValveSimulation
    """

    def own(signals):
        return {r: whole.in_recorded_units(r, v) for r, v in signals.items() if r in ("opening", "flow")}

    roles = [r for r in ("command", "opening", "flow", "p1", "p2", "temperature") if r in whole]
    shown = np.zeros(len(whole), dtype=bool)
    shown[: len(flagged)] = flagged
    return {
        "time": whole.time - whole.time[0],
        "units": {r: whole.unit(r) for r in roles},
        "recorded": {r: whole.in_recorded_units(r, whole[r]) for r in roles},
        "nominal": own(nominal.simulate(whole)),
        "corrected": own(corrected.simulate(whole)),
        "dp": whole["p1"] - whole["p2"] if "p1" in whole and "p2" in whole else None,
        "pressure_ratio": nominal.chain_of(whole).pressure_ratio,
        "flagged": shown,
        "begins": [low for low, _ in whole.spans],
        "until": None if used == len(whole) else used,
        "first_stamp": first_stamp(whole),
    }
