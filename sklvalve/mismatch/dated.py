# SPDX-License-Identifier: BSD-3-Clause
"""A judgement with the date of what changed, whether it has a name or not."""

from dataclasses import replace

import numpy as np

from sklvalve.mismatch.change import Change, find_change, size_of
from sklvalve.mismatch.late import stands_out


def dated(problem, judged, alpha):
    """A judgement with its change, where there is one that stands out.

    Where all that was found is there from the start, what changes is looked for in what is left beside it;
    else in what the simulation without it leaves, whether it has a name or not.

    Parameters
    ----------
    problem : Problem
    judged : Judgement
    alpha : float

    Returns
    -------
    judged : Judgement
        ``cannot_tell`` where nothing else was found missing.
    """
    if judged.change is not None:
        return judged
    onsets = [f.term.onset for f in judged.findings]
    begun = [f for f in judged.findings if f.term.onset is not None and not f.term.effect.grows]
    if begun and judged.verdict == "named":
        return replace(judged, change=_of(problem, judged, begun[0]))
    seen = judged.model if onsets and all(onset is None for onset in onsets) else judged.nominal
    found = find_change(problem, seen)
    if found is None or not stands_out(problem, found, alpha):
        return judged
    if judged.verdict == "no_mismatch":
        # what changes by more than counts is no agreement, though nothing was found that explains it
        return replace(
            judged, verdict="cannot_tell", p_value=min(judged.p_value, found.p_value), change=found
        )
    return replace(judged, change=found)


def _of(problem, judged, finding):
    """The change that a named effect made which began within the recording, in the signal it moves most."""
    channel = max(finding.sizes, key=lambda c: finding.sizes[c])
    left, shown = problem.residuals(judged.nominal)[channel], judged.nominal.predictions[channel]
    row = int(np.searchsorted(judged.model.chain.clock, finding.term.onset))
    size = size_of(left, shown, row)
    if size is None:
        parts = [part[np.isfinite(part)] for part in (left[row:], left[:row])]
        if not all(len(part) for part in parts):
            return None
        size = float(np.median(parts[0]) - np.median(parts[1]))
    return Change(channel, row, (row, row), size, 0.0, judged.p_value)


def change_entry(whole, judgement, location):
    """``location.change`` of diagnosis.json: when a signal changed and by how much; None where none did.

    Of an effect that has a name the onset's own interval is told.
    """
    found = judgement.change
    if found is None:
        return None
    clock = judgement.model.chain.clock - judgement.model.chain.clock[0]
    low, high = (float(clock[min(k, len(clock) - 1)]) for k in found.within)
    if location.get("onset") == float(clock[found.row]) and location.get("onset_ci95"):
        low, high = location["onset_ci95"]
    return {
        "signal": found.channel,
        "time": float(clock[found.row]),
        "ci95": [low, high],
        "size": float(f"{found.size * whole.per_si(found.channel):.4g}"),
        "unit": whole.unit(found.channel),
        "p_value": found.p_value,
    }
