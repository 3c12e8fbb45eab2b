# SPDX-License-Identifier: BSD-3-Clause
"""From when on an effect acts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import (
    FIRST_ONSET,
    LAST_ONSET,
    SWITCH_PENALTY,
    Model,
    Term,
    complexity_penalty,
)
from sklvalve.mismatch.inference.whitened_onset import losses_from_here
from sklvalve.mismatch.search.growing import fit_growing
from sklvalve.simulation.robust import ROBUST_FROM

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.simulation.noise import NoiseModel
    from sklvalve.simulation.noise_of_pieces import NoiseOfPieces


def row_losses(problem: Problem, model: Model, channels: Iterable[str]) -> np.ndarray:
    """What each row costs a model: robust loss of its whitened residuals in some channels together."""
    total, left = np.zeros(len(problem.recording)), problem.residuals(model)
    for channel in channels:
        total += losses_of(problem.noise[channel], left[channel])
    return total


def losses_of(noise: NoiseModel | NoiseOfPieces, residual: np.ndarray) -> np.ndarray:
    """Robust loss of each row of one channel's residual, whitened."""
    scaled = (noise.whiten(residual) / ROBUST_FROM) ** 2
    return ROBUST_FROM**2 * (np.sqrt(1.0 + scaled) - 1.0)


def best_onset(problem: Problem, without: Model, acting: Model) -> float:
    """Time at which to pass from a model without an effect to one with it, at the least cost.

    Parameters
    ----------
    problem : Problem
    without, acting : Model
        The effect is the last member of `acting`.

    Returns
    -------
    onset : float
        Absolute time [s].
    """
    # a channel that the effect leaves alone says nothing of when it began, only how often it was fitted
    touched = problem.channels_touched(acting.terms[-1].effect)
    losses = _losses_by_change(problem, without, acting, touched)
    n = len(problem.recording)
    first, last = int(FIRST_ONSET * n), int(LAST_ONSET * n)
    return float(acting.chain.clock[first + int(np.argmin(losses[first:last]))])


def penalty_with_times(problem: Problem, model: Model, term: Term) -> float:
    r"""Log likelihood that a term of a fitted hypothesis must earn, its onset and switches summed over.

    As `complexity_penalty`, which prices each time as one of all rows. Where the recording leaves open when
    an effect began, many rows share what it gains. So a time costs

    .. math:: \log n - \log \sum_k e^{G_k - \max G}

    with G what the effect, at its fitted size, gains where that time is at row k: between its neighbours, of
    all n rows.

    Parameters
    ----------
    problem : Problem
    model : Model
        Fitted, with the term.
    term : Term

    Returns
    -------
    penalty : float
        At most that of `complexity_penalty`, which stands for what grows.

    Notes
    -----
    Simulated are the effect throughout and none; a row has the residual of the one or the other. An effect of
    the stem is remembered beyond that row, so that its times cost somewhat too much: 2 to 3 nats in three
    cases.
    """
    penalty = complexity_penalty(problem, term)
    if term.onset is None or term.effect.grows:
        return penalty
    others = tuple(m for m in model.terms if m is not term)
    without, acting = (problem.simulate(t, model.values) for t in (others, (*others, Term(term.effect))))
    touched = problem.channels_touched(term.effect)
    n = len(problem.recording)
    rows = np.searchsorted(model.chain.clock, np.atleast_1d(term.times))
    begins = _losses_by_change(problem, without, acting, touched)
    stops = _losses_by_change(problem, acting, without, touched) if len(rows) > 1 else begins
    ends = [0, *rows.tolist(), n]
    for k in range(len(rows)):
        by_row = -(stops if k % 2 else begins)[ends[k] : ends[k + 2] + 1]
        cost = np.log(n) - np.logaddexp.reduce(by_row - by_row.max())
        penalty -= max(SWITCH_PENALTY - float(cost), 0.0)
    return penalty


def _losses_by_change(problem: Problem, before: Model, after: Model, channels: Iterable[str]) -> np.ndarray:
    """Loss of all rows where one hypothesis takes another's place at each of them, and at the end."""
    losses = np.append(0.0, np.cumsum(row_losses(problem, before, channels)))
    left, left_then = problem.residuals(before), problem.residuals(after)
    for channel in channels:
        noise = problem.noise[channel]
        white, white_then = noise.whiten(left[channel]), noise.whiten(left_then[channel])
        losses[:-1] += losses_from_here(noise, white, white_then)
    return losses


def fit_with_onset(
    problem: Problem,
    model: Model,
    effect: Effect,
    *,
    hold: str | None = None,
    attempt: int = 0,
    onset: float | None = None,
    max_steps: int = 5,
) -> Model:
    """Fit of an effect that begins within the recording.

    Begins with the effect switched on after a half of the record, moves the onset to where the losses of the
    models without it and with it throughout change sides, and fits again as long as that is likelier.

    Parameters
    ----------
    problem : Problem
    model : Model
        The hypothesis so far.
    effect : Effect
    hold, attempt, max_steps
        As in `Problem.fit`.
    onset : float, default=None
        Where to begin the search [s, absolute]; the middle of the record unless given.

    Returns
    -------
    fitted : Model
    """
    clock = problem.plain.clock
    onset = float(clock[len(clock) // 2]) if onset is None else onset
    options: dict[str, Any] = {"hold": hold, "attempt": attempt, "max_steps": max_steps}
    if effect.grows:
        return fit_growing(problem, model, effect, onset=onset, **options)
    fitted = problem.fit((*model.terms, Term(effect, onset)), start=model, **options)
    for _ in range(4):
        throughout = problem.simulate((*model.terms, Term(effect)), fitted.values)
        moved = best_onset(problem, model, throughout)
        if abs(moved - onset) < 1.5 * problem.recording.sample_time:
            break
        again = problem.fit((*model.terms, Term(effect, moved)), start=fitted, **options)
        # what the losses of two fits suggest need not be better when it is fitted itself
        if again.log_likelihood <= fitted.log_likelihood:
            break
        onset, fitted = moved, again
    return fitted
