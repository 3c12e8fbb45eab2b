# SPDX-License-Identifier: BSD-3-Clause
"""A judgement with the date of what changed, whether it has a name or not."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sklvalve.mismatch.residual.change import Change, find_change, size_of, stands_out
from sklvalve.mismatch.search.rivals import leading_term

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.hypothesis import Model, Term
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Finding
    from sklvalve.recording import Recording


def dated(problem: Problem, judged: Judgement, alpha: float) -> Judgement:
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
    begun = [f for f in judged.findings if _is_abrupt(leading_term(f))]
    if begun and judged.verdict == "named":
        return replace(judged, change=_of(problem, judged, begun[0]))
    explained = judged.model if _is_all_from_the_start(judged) else judged.nominal
    change = find_change(problem, cast("Model", explained))
    if change is None or not stands_out(problem, change, alpha):
        return judged
    if judged.verdict == "no_mismatch":
        # what changes by more than counts is no agreement, though nothing was found that explains it
        p_value = min(p for p in (judged.p_value, change.p_value) if p is not None)
        return replace(judged, verdict="cannot_tell", p_value=p_value, change=change)
    return replace(judged, change=change)


def _is_all_from_the_start(judged: Judgement) -> bool:
    """Whether something was found, and all of it acts from before the recording on."""
    return bool(judged.findings) and all(leading_term(f).onset is None for f in judged.findings)


def _is_abrupt(term: Term) -> bool:
    """Whether a term begins within the recording, and does not grow."""
    return term.onset is not None and not term.effect.grows


def _of(problem: Problem, judged: Judgement, finding: Finding) -> Change | None:
    """The change that a named effect made which began within the recording, in the signal it moves most."""
    onset, p_value = leading_term(finding).onset, judged.p_value
    if onset is None or p_value is None:
        return None
    channel = max(finding.sizes, key=lambda c: finding.sizes[c])
    nominal, model = cast("Model", judged.nominal), cast("Model", judged.model)
    left, shown = problem.residuals(nominal)[channel], nominal.predictions[channel]
    row = int(np.searchsorted(model.chain.clock, onset))
    size = size_of(left, shown, row)
    if size is None:
        parts = [part[np.isfinite(part)] for part in (left[row:], left[:row])]
        if not all(len(part) for part in parts):
            return None
        size = float(np.median(parts[0]) - np.median(parts[1]))
    return Change(channel, row, (row, row), size, 0.0, p_value)


def change_entry(whole: Recording, judgement: Judgement, location: dict[str, Any]) -> dict[str, Any] | None:
    """``location.change`` of diagnosis.json: when a signal changed and by how much; None where none did.

    Of an effect that has a name it gives the onset's own interval.
    """
    change = cast("Change | None", judgement.change)
    if change is None:
        return None
    clock = cast("Model", judgement.model).chain.clock
    clock = clock - clock[0]
    low, high = (float(clock[min(k, len(clock) - 1)]) for k in change.within)
    if location.get("onset") == float(clock[change.row]) and location.get("onset_ci95"):
        low, high = location["onset_ci95"]
    return {
        "signal": change.channel,
        "time": float(clock[change.row]),
        "ci95": [low, high],
        "size": float(f"{change.size * whole.per_si(change.channel):.4g}"),
        "unit": whole.unit(change.channel),
        "p_value": change.p_value,
    }
