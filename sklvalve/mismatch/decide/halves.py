# SPDX-License-Identifier: BSD-3-Clause
"""Whether each half of a recording allows what was found in the whole of it.

A simulation of a real plant lacks more than one effect of the catalogue. What it lacks looks now like this
effect, now like that, and the one that fits the whole best is the average of both. What truly acts is not
refuted by a half in which it acts, and shows nothing in one in which it does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.search.onset import penalty_with_times
from sklvalve.mismatch.search.rivals import class_of
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Term
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Finding, Rival

# a fit to a half begins where that to the whole ended
_STEPS = 4


def refuted_by_a_half(problem: Problem, finding: Finding, beside: Sequence[Term]) -> tuple[float, str]:
    """How far behind the best explanation a half of a recording puts a class, each fitted to it alone.

    Parameters
    ----------
    problem : Problem
    finding : Finding
    beside : sequence of Term
        What else stands.

    Returns
    -------
    distance : float
        Profile-likelihood distance of the likeliest member of the class from the best, in the half that
        speaks most against it. From `DISTINGUISHABLE` on the two are told apart.
    instead : str
        Name of the best in that half.
    """
    rows = len(problem.recording)
    first = np.arange(rows) < rows // 2
    halves = (_refuted(problem, finding, tuple(beside), half) for half in (first, ~first))
    return max(halves, key=lambda refuted: refuted[0])


def _refuted(
    problem: Problem, finding: Finding, beside: tuple[Term, ...], half: np.ndarray
) -> tuple[float, str]:
    used = half if problem.rows is None else half & problem.rows

    def likelihood_of(rival: Rival) -> float:
        # times that the whole has chosen cost what they cost there
        fit = problem.fit((*beside, rival.term), start=rival.model, rows=used, max_steps=_STEPS)
        return fit.log_likelihood - penalty_with_times(problem, rival.model, rival.term)

    priced = dict(zip(finding.rivals, parallel_map(likelihood_of, finding.rivals), strict=True))
    names = class_of(finding)
    best = max(priced, key=lambda r: priced[r])
    likeliest = max((r for r in priced if r.term.effect.name in names), key=lambda r: priced[r])
    # a half that shows nothing of an effect does not refute it
    bare = problem.fit(beside, start=likeliest.model, rows=used, max_steps=_STEPS).log_likelihood
    nothing = bare - penalty_with_times(problem, likeliest.model, likeliest.term)
    of_class = max(priced[likeliest], nothing)
    return distance(priced[best], of_class, priced[best] - nothing), best.term.effect.name
