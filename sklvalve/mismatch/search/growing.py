# SPDX-License-Identifier: BSD-3-Clause
"""From when on an effect grows: with another onset it is another signal, so each is fitted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.inference.hypothesis import FIRST_ONSET, LAST_ONSET, Term

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem

# shares of the record: an onset is looked for in steps of a fifth first, then finer
_COARSE, _FINE = 0.2, 0.01


def fit_growing(problem: Problem, model: Model, effect: Effect, *, onset: float, **options: Any) -> Model:
    """Fit of an effect that grows from a moment within the recording.

    The likelihood over the onset has one broad top, for a ramp that begins too early or too late answers with
    its slope: so the onset walks uphill, by steps that halve.

    Parameters
    ----------
    problem : Problem
    model : Model
        The hypothesis so far.
    effect : Effect
    onset : float
        Where to begin the search [s, absolute].
    **options
        Of `Problem.fit`.

    Returns
    -------
    fitted : Model
    """
    # in rows, not in time: that between recordings that were joined would be the most of it
    clock = problem.plain.clock
    rows = np.arange(len(clock))
    first, last = (int(share * (len(clock) - 1)) for share in (FIRST_ONSET, LAST_ONSET))
    fits: dict[float, Model] = {}

    def fitted_at(row: float) -> float:
        row = float(np.clip(row, first, last))
        if row not in fits:
            term = Term(effect, float(np.interp(row, rows, clock)))
            start = max(fits.values(), key=lambda m: m.log_likelihood, default=model)
            fits[row] = problem.fit((*model.terms, term), start=start, **options)
        return row

    best, reach = fitted_at(np.interp(onset, clock, rows)), _COARSE * (last - first)
    while reach > _FINE * (last - first):
        there = max(
            (best, fitted_at(best - reach), fitted_at(best + reach)), key=lambda row: fits[row].log_likelihood
        )
        if there == best:
            reach *= 0.5
        best = there
    return fits[best]
