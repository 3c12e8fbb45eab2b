# SPDX-License-Identifier: BSD-3-Clause
"""From fits to words: classes of explanations that the recording cannot tell apart, and the verdict."""

import numpy as np

from sklvalve.mismatch.distance import DISTINGUISHABLE
from sklvalve.mismatch.hypothesis import own_values
from sklvalve.mismatch.intervals import interval_of

# a class is named from this probability on
NAMED_FROM = 0.8
#: Share of the classes told on sealed records of a finer plant that held a true name (220 of 233): in the
#: others it was none of the explanations at hand, however clearly one of them was the likeliest.
BORNE_OUT = 0.94
# what is as probable as this is in the class though it fits clearly worse: fewer parameters or switches speak
# for it, and no class is told beside an explanation that is likelier
_POSSIBLE = 0.05
# an unknown rest of this share of what the effects explain makes their names doubtful
_DOUBTFUL = 0.5


def as_told(probability):
    """Probability of a class or member as it is told, from that among the explanations at hand."""
    return round(BORNE_OUT * float(min(probability, 1.0)), 4)


def class_of(finding):
    """Members of the class of the best explanation: effect name -> (probability, Member, Model).

    Those that the recording cannot tell from it, and those that fit worse and are probable all the same.
    """
    found = {}
    for rival in finding.rivals:
        if rival.distance >= DISTINGUISHABLE and rival.probability < _POSSIBLE:
            continue
        name = rival.member.effect.name
        before = found.get(name)
        if before is None:
            found[name] = (rival.probability, rival.member, rival.model)
        else:
            found[name] = (before[0] + rival.probability, before[1], before[2])
    return dict(sorted(found.items(), key=lambda item: -item[1][0]))


def verdict_of(findings, unknown, enough, explained):
    """Verdict, and the findings that stand.

    Parameters
    ----------
    findings : list of Finding
    unknown : Unknown or None
    enough : bool
        Whether there is more than chance makes, and more than counts.
    explained : float
        Size of what the effects explain, share of span, in the unknown's channel [1].
    """
    if not enough:
        return "no_mismatch", []
    if unknown is not None and unknown.size > _DOUBTFUL * explained:
        return "none_of_these", []
    if not findings:
        return "cannot_tell", []
    named = [as_told(sum(p for p, _, _ in class_of(f).values())) >= NAMED_FROM for f in findings]
    return ("named" if any(named) else "cannot_tell"), findings


def effect_entry(finding, recording, workbench):
    """The entry of diagnosis.json for one finding."""
    members = class_of(finding)
    _, who, fitted = next(iter(members.values()))
    total = sum(p for p, _, _ in members.values())
    values = own_values(who, fitted)
    entry = {
        "members": [{"name": n, "probability": as_told(p)} for n, (p, _, _) in members.items()],
        "probability": as_told(total),
        "blocks": sorted({w.effect.block for _, w, _ in members.values()}),
        "size": {c: float(f"{size:.4g}") for c, size in finding.sizes.items() if size > 0.0},
        "onset": None if who.onset is None else float(who.onset - fitted.chain.clock[0]),
        **({"spells": _spells(who, fitted)} if who.switches else {}),
        "parameters": {},
        "sentence": _sentence(who, values),
        "separated_by": who.effect.separated_by,
    }
    for q in who.effect.quantities(fitted.chain):
        value = fitted.values[f"{who.effect.key}.{q.name}"]
        told = interval_of(workbench, who, fitted, q)
        entry["parameters"][q.name] = _in_units(q, value, told, recording)
    return entry


def _spells(who, fitted):
    """From when to when an effect acts that comes and goes [s from the first sample]."""
    clock = fitted.chain.clock
    times = [*who.times, *([clock[-1]] if len(who.times) % 2 else [])]
    return [[float(a - clock[0]), float(b - clock[0])] for a, b in zip(times[::2], times[1::2], strict=True)]


def _sentence(who, values):
    text = who.effect.phrase.format(**values)
    return text[0].upper() + text[1:] + "."


def _in_units(quantity, value, interval, recording):
    """A parameter with its interval; a flow in the recording's own unit."""
    unit, told = quantity.unit, [value, *(interval or ())]
    if unit.startswith(("m3/s", "kg/s")):
        zero = recording.in_recorded_units("flow", np.zeros(1))[0]
        told = [float(recording.in_recorded_units("flow", np.array([v]))[0] - zero) for v in told]
        unit = recording.unit("flow") + ("/h" if unit.endswith("/s/h") else "")
    value, *ends = told
    return {"value": float(value), "unit": unit, "ci95": sorted(ends) if ends else None}
