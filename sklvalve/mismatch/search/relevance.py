# SPDX-License-Identifier: BSD-3-Clause
"""Whether an effect in a fitted hypothesis is one that counts."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.inference.hypothesis import Model, Term, parameter_values, penalised_likelihood
from sklvalve.mismatch.search.scatter import gain_in_spreads
from sklvalve.simulation import Tolerance

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# what the model of an effect gets wrong is no physics of its own: without a further effect this many times
# as much (mean square) must be left over, or it must be a fair share of the strongest and gain in more than
# one or two events, in deviations of the scatter (k equal events among many stretches make the root of k)
_LEFT_WITHOUT = 2.0
SPREADS = 2.0
# of what counts, an explanation in the place of another must make this share
_OF_A_RIVAL = 0.5
# an explanation that needs all that is physically possible speaks against itself: share of its range
_AT_AN_END = 1e-3
#: A healthy simulation is wrong by about this share of what counts as an effect.
WRONG = 0.1


def is_relevant(problem: Problem, model: Model, without: Model, threshold: float) -> bool:
    """Whether the last effect of a hypothesis is one more that the recording asks for.

    Parameters
    ----------
    problem : Problem
    model, without : Model
        With the effect and without it.
    threshold : float
        Log likelihood that it must add beyond its price.

    Returns
    -------
    matters : bool
    """
    gain = penalised_likelihood(problem, model) - penalised_likelihood(problem, without)
    sizes = _change_by_last(problem, model, without)
    if not (gain > threshold and may_explain(problem, model, without)):
        return False
    if not without.terms:
        return True
    large = [c for c in sizes if problem.counts({c: sizes[c]})]
    if any(_leaves_most(problem, model, without, c) for c in large):
        return True
    bare = problem.fit((), start=without)
    strongest = problem.change(without, problem.baseline(without, (), bare))
    fair = any(sizes[c] > SHARE_WRONG * strongest[c] for c in large)
    if large != ["opening"]:
        # or in gain, which counts how long it acts as well; where a stroke is missed, its rest repeats it
        fair |= gain > SHARE_WRONG**2 * (without.log_likelihood - bare.log_likelihood)
    return fair and gain_in_spreads(problem, model, without) >= SPREADS


def may_explain(problem: Problem, model: Model, without: Model) -> bool:
    """Whether the last effect is of a size to explain anything: what is small or absurd does not.

    What a data sheet leaves open may gain a lot and is no mismatch; an explanation that needs all that is
    physically possible speaks against itself.
    """
    term = model.terms[-1]
    counts = beyond_tolerance(problem, model, term) and problem.counts(
        _change_by_last(problem, model, without)
    )
    return counts and not _absurd(model, term)


def may_be_instead(problem: Problem, model: Model, without: Model) -> bool:
    """Whether the last effect may be what stands in the place of another that counts.

    Of one that began it is told already that something did: what made it may be shorter than a response that
    would be told alone. And it may be smaller than what counts, down to half of it. But what a sheet leaves
    open throughout is in a sound valve as well: it explains something else, and noise takes up the rest.
    """
    term = model.terms[-1]
    open_to_it = term.onset is not None or beyond_tolerance(problem, model, term)
    changed = _change_by_last(problem, model, without)
    sizes = {channel: size / _OF_A_RIVAL for channel, size in changed.items()}
    return open_to_it and problem.counts(sizes) and not _absurd(model, term)


def _change_by_last(problem: Problem, model: Model, without: Model) -> dict[str, float]:
    """How much the last effect of a hypothesis changes."""
    return problem.change(model, problem.baseline(model, model.terms[:-1], without))


def _absurd(model: Model, term: Term) -> bool:
    """Whether an effect's own size stands at the end of what is physically possible."""
    first = term.effect.quantities(model.chain)[0]
    size, low, high = model.values[f"{term.effect.key}.{first.name}"], first.low, first.high
    if first.log:
        size, low, high = np.log([size, low, high])
    return min(size - low, high - size) < _AT_AN_END * (high - low)


def _leaves_most(problem: Problem, model: Model, without: Model, channel: str) -> bool:
    """Whether without its last effect at least twice as much (mean square) is left over in a channel."""
    left = [np.nanmean(problem.residuals(m)[channel] ** 2) for m in (model, without)]
    return bool(left[1] > _LEFT_WITHOUT * left[0])


def beyond_tolerance(problem: Problem, model: Model, term: Term) -> bool:
    """Whether an effect, as a model has it, lies beyond what a data sheet leaves open.

    Beyond by more than a simulation gets wrong of its size: a sound valve may stand at the edge.
    """
    # what is there throughout a recording, and was not in the valve's history, began between them
    late = term.onset is not None or problem.history is not None
    edge = {f.name: (1.0 + SHARE_WRONG) * getattr(problem.tolerance, f.name) for f in fields(Tolerance)}
    return term.effect.beyond_tolerance(parameter_values(term, model), model.chain, Tolerance(**edge), late)


def standardized_effect_size(deviations: float, size: float) -> float:
    r"""Size of a change in its standard deviations, noise and what a healthy simulation gets wrong together.

    .. math:: t = \left(\frac{1}{z^2} + \frac{w^2}{s^2}\right)^{-1/2}

    with z its deviations from nothing (`OverTime.deviations`), s its size in multiples of what
    counts, and w = 0.1, about the share of what counts by which a healthy simulation is wrong. It grows with
    both, and neither a clear trifle nor a large change that is not borne out makes it large.

    Parameters
    ----------
    deviations : float
        z [1].
    size : float
        s, in multiples of what counts [1].

    Returns
    -------
    size : float
        At least 0.

    Examples
    --------
    >>> from sklvalve.mismatch.search.relevance import standardized_effect_size
    >>> round(standardized_effect_size(3.0, 100.0), 2), round(standardized_effect_size(100.0, 1.0), 2)
    (3.0, 9.95)
    """
    if not (deviations > 0.0 and size > 0.0):
        return 0.0
    return float(1.0 / np.hypot(1.0 / deviations, WRONG / size))
