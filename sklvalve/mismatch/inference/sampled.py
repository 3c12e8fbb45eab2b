# SPDX-License-Identifier: BSD-3-Clause
"""Fits of a stem begun at points sampled over all that its parameters may be.

A stem sticks, hunts and stops, so the likelihood of its parameters has many valleys, and a fit ends in the
one where it began. An effect whose fit ended in a poor one looks less likely than it is, and another gets its
name. So every explanation of the opening, and nothing, is also begun at points from all over the box of its
parameters, and from what a history expects of those that it knows.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.simulation.robust import robust_cost

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.simulation.fitting import Misfit

# points simulated; of these so many take a few steps, and so many of those are fitted to the end
_POINTS, _TRIED, _FITTED = 64, 6, 2
_STEPS = 4
# how far from what is expected beforehand points lie at most, in its standard deviations
_SPREADS = 2.0


def sampled_fit(problem: Problem, model: Model) -> Model:
    """A hypothesis of the stem fitted from points sampled over its parameters, if that is likelier.

    Parameters
    ----------
    problem : Problem
    model : Model
        A fit of the hypothesis.

    Returns
    -------
    model : Model
        The one given where no sample leads to a likelier one; where no friction is simulated, such as of a
        motor, which neither sticks nor hunts; and where effects act, and none on the opening.
    """
    if model.terms and "opening" not in problem.touched_by(model.terms):
        return model
    fits = [model]
    for misfit in problem.misfits(model, ("opening",)):
        if "actuator_coulomb" not in misfit.vector.names:
            continue
        begun = [replace(model, values=misfit.values(z)) for z in _likeliest_points(misfit)]
        rough = [problem.fit(model.terms, start=m, max_steps=_STEPS) for m in begun]
        best = sorted(rough, key=lambda m: m.log_likelihood, reverse=True)[:_FITTED]
        fits += [problem.fit(model.terms, start=m) for m in best]
    return max(fits, key=lambda m: m.log_likelihood)


def _likeliest_points(misfit: Misfit) -> list[np.ndarray]:
    """Of points all over what the parameters may be those that simulate the recording best, best first."""
    points = misfit.vector.scattered(_POINTS, np.random.default_rng(0), _SPREADS)
    misfit.chain.free_runs_ahead([misfit.values(z) for z in points])
    costs = [robust_cost(misfit.errors(z)) for z in points]
    return [points[k] for k in np.argsort(costs, kind="stable")[:_TRIED]]
