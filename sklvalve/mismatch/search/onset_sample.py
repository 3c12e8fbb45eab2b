# SPDX-License-Identifier: BSD-3-Clause
"""An onset to the very sample, for each explanation its own."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.simulation.robust import robust_cost

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem


def to_the_sample(problem: Problem, model: Model, *, reach: int = 3) -> Model:
    """A hypothesis whose last effect begins at the likeliest of the samples around its onset.

    An onset that is one sample off costs a row as many standard deviations as the effect is large. A rival
    that is slow to show, behind a meter's lag, would then win by being late.

    Parameters
    ----------
    problem : Problem
    model : Model
    reach : int, default=3
        Samples to each side.

    Returns
    -------
    model : Model
        Fitted again where another sample is likelier, else as given.
    """
    *others, last = model.terms
    if last.onset is None:
        return model
    clock, touched = model.chain.clock, problem.channels_touched(last.effect)
    k = int(np.searchsorted(clock, last.onset))

    def cost(onset: float) -> float:
        trial = problem.simulate((*others, replace(last, onset=onset)), model.values)
        left = problem.residuals(trial)
        return sum(robust_cost(problem.noise[c].whiten(left[c])) for c in touched)

    around = [float(moment) for moment in clock[max(k - reach, 1) : k + reach + 1]]
    best = min([last.onset, *around], key=cost)
    if best == last.onset:
        return model
    again = problem.fit((*others, replace(last, onset=best)), start=model)
    return again if again.log_likelihood > model.log_likelihood else model
