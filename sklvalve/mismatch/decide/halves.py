# SPDX-License-Identifier: BSD-3-Clause
"""Whether each half of a recording allows what was found in the whole of it.

A simulation of a real plant lacks more than one effect of the catalogue. What it lacks looks now like this
effect, now like that, and the one that fits the whole best is the average of both. What truly acts is not
refuted by a half in which it acts, and shows nothing in one in which it does not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.search.rivals import class_of
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Finding, Rival

# a fit to a half begins where that to the whole ended
_STEPS = 4


def refuted_by_a_half(problem: Problem, finding: Finding) -> tuple[float, str]:
    """How far behind the best explanation a half of a recording puts a class, each fitted to it alone.

    Parameters
    ----------
    problem : Problem
    finding : Finding

    Returns
    -------
    distance : float
        Profile-likelihood distance of the likeliest member of the class from the best, in the half that
        speaks most against it. From `DISTINGUISHABLE` on the two are told apart.
    instead : str
        Name of the best in that half; empty where nothing at all explains it better.
    """
    rows = len(problem.recording)
    first = np.arange(rows) < rows // 2
    return max((_refuted(problem, finding, half) for half in (first, ~first)), key=lambda refuted: refuted[0])


def _refuted(problem: Problem, finding: Finding, half: np.ndarray) -> tuple[float, str]:
    used = half if problem.rows is None else half & problem.rows
    best = max(finding.rivals, key=lambda r: r.probability).model
    key = finding.rivals[0].term.effect.key

    def of(rival: Rival) -> Model:
        return problem.fit(rival.model.terms, start=rival.model, rows=used, max_steps=_STEPS)

    fits = dict(zip(finding.rivals, parallel_map(of, finding.rivals), strict=True))
    others = tuple(m for m in finding.rivals[0].model.terms if m.effect.key != key)
    nothing = problem.fit(others, start=best, rows=used, max_steps=_STEPS).log_likelihood
    likeliest = max(fits, key=lambda r: fits[r].log_likelihood)
    top = max(fits[likeliest].log_likelihood, nothing)
    names = class_of(finding)
    best_of_class = max(m.log_likelihood for r, m in fits.items() if r.term.effect.name in names)
    instead = likeliest.term.effect.name if fits[likeliest].log_likelihood > nothing else ""
    return distance(top, best_of_class, top - nothing), instead
