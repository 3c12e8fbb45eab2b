# SPDX-License-Identifier: BSD-3-Clause
"""Intervals of parameters: what noise, a simulation that is never right, and the data sheet leave open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.describe.locate import causes_of, time_profile_of_cause
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.inference.hypothesis import Model, Term, parameter_values
from sklvalve.simulation import Tolerance
from sklvalve.simulation.fitting import Misfit

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# of a normal distribution: 95 %
WITHIN_95 = 1.96
# share of an effect that a simulation gets wrong, or less, in 95 of 100: with 0.15, as tolerances are
# exceeded by, 132 of 136 parameters of sealed records lay within six tenths of their intervals
SHARE_OFF = 0.09


def interval_of(problem: Problem, term: Term, fitted: Model, quantity: Quantity) -> tuple[float, ...] | None:
    r"""Interval that holds a parameter of an effect with 95 %.

    .. math:: h = \sqrt{(1.96\, s)^2 + (1.96\, m)^2} + t

    with the standard deviation s of the fit, what the parameter may make up for, m, and what the sheet leaves
    open of such an effect, t. A simulation gets up to 9 % of an effect wrong, and that is one error
    however many rows there are:

    .. math:: m^2 = [(A + P)^{-1}]_{ii}, \quad A = J^T J \left(\frac{1.96}{0.09\, \Delta}\right)^2

    with the rms change :math:`\Delta` that the effect makes, the derivatives J of the simulated signals, as
    shares of their spans and rms over the rows, and the curvature P of the priors: calibration answers as far
    as the data sheet lets it. The effect's other parameters describe its shape and are held.

    A response, a zero or a capacity that the sheet leaves open is a parameter of the calibration, and
    answers. A static error is not: friction and feedback of a calibrated actuator stand for play, and a sound
    valve has some, so that t is the size up to which such an effect is within the tolerance of the static
    error. Of a delay from the start it is one scan, half of what the calibration may hold beside it. What
    grows does so the faster the later it began: t is how far the rates lie apart over the interval of its
    onset. These are bounds and no scatter, and so they are added.

    Parameters
    ----------
    problem : Problem
    term : Term
    fitted : Model
        That holds it.
    quantity : Quantity

    Returns
    -------
    low, high : float
        Within what is physically possible; None where the fit knows no deviation.
    """
    key = f"{term.effect.key}.{quantity.name}"
    value, spread = fitted.values[key], fitted.spreads.get(key, np.nan)
    if not np.isfinite(spread):
        return None
    half = np.hypot(WITHIN_95 * spread, _mistaken(problem, term, fitted, key))
    if quantity.log:
        # what nothing bounds but physics would leave the range of a number
        half = min(half, np.log(quantity.high / quantity.low))
        ends = value * np.exp(-half), value * np.exp(half)
    else:
        ends = value - half, value + half
    below, above = _open(problem, term, fitted, quantity, value)
    ends = ends[0] - below, ends[1] + above
    return tuple(float(np.clip(e, quantity.low, quantity.high)) for e in ends)


def _mistaken(problem: Problem, term: Term, fitted: Model, key: str) -> float:
    """How far a parameter may be off to make up for what the simulation gets wrong of its effect."""
    others = tuple(m for m in fitted.terms if m.effect.key != term.effect.key)
    acting = problem.simulate(fitted.terms, fitted.values)
    without = problem.simulate(others, fitted.values)
    wrong = SHARE_OFF * float(
        np.linalg.norm(_scaled(problem, acting.predictions, without.predictions, problem.channels))
    )
    for misfit in problem.misfits(fitted, problem.channels):
        if key not in misfit.vector.names or wrong <= 0.0:
            continue
        slopes, priors, free = _slopes(problem, misfit, term, fitted, key)
        curvature = slopes.T @ slopes * (WITHIN_95 / wrong) ** 2 + priors.T @ priors
        if curvature[0, 0] <= 0.0:
            return 0.0
        # what moves nothing and has no prior answers nothing
        curvature[np.diag_indices(free)] += 1e-9 * curvature[0, 0]
        return WITHIN_95 * float(np.sqrt(np.linalg.inv(curvature)[0, 0]))
    return 0.0


def _slopes(
    problem: Problem, misfit: Misfit, term: Term, fitted: Model, key: str
) -> tuple[np.ndarray, np.ndarray, int]:
    """Derivatives of simulated signals and of priors; of the parameter first, then of the calibration's."""
    z, names = misfit.vector.pack(fitted.values), misfit.vector.names
    base, prior = misfit.predictions(z), misfit.vector.prior_residuals(z)
    moved, reach = misfit.neighbours(z)
    prefix = f"{term.effect.key}."
    places = [names.index(key), *(i for i, name in enumerate(names) if not name.startswith(prefix))]
    slopes = [
        _scaled(problem, misfit.predictions(moved[i]), base, misfit.channels) / reach[i] for i in places
    ]
    pulls = [(misfit.vector.prior_residuals(moved[i]) - prior) / reach[i] for i in places]
    return np.stack(slopes, axis=1), np.stack(pulls, axis=1), len(places)


def _scaled(
    problem: Problem, one: dict[str, np.ndarray], other: dict[str, np.ndarray], channels: Sequence[str]
) -> np.ndarray:
    """Difference of two simulations, channel after channel, in spans and so that its norm is its rms [1]."""
    parts = []
    for c in channels:
        gap = (one[c] - other[c]) / problem.spans[c]
        seen = np.isfinite(gap)
        parts.append(np.where(seen, gap, 0.0) / np.sqrt(max(seen.sum(), 1)))
    return np.concatenate(parts)


def _open(problem: Problem, term: Term, fitted: Model, quantity: Quantity, value: float) -> tuple[float, ...]:
    """How far below and above its value the data sheet, or the onset, leaves the size of an effect open."""
    if quantity.name != term.effect.parameters[0].name:
        return 0.0, 0.0
    if term.effect.grows:
        for cause in causes_of(problem, fitted):
            if cause.term is not None and cause.term.effect.key == term.effect.key:
                ends = np.multiply(time_profile_of_cause(problem, fitted, cause).sizes, value)
                return max(value - ends.min(), 0.0), max(ends.max() - value, 0.0)
    if quantity.name == "delay" and term.onset is None:
        return 2 * (float(problem.recording.sample_time),)
    return 2 * (_of_sound_valves(problem, term, fitted, quantity),)


def _of_sound_valves(problem: Problem, term: Term, fitted: Model, quantity: Quantity) -> float:
    """Size up to which an effect is a static error within the tolerance; zero where its size is another."""
    chain, values = fitted.chain, parameter_values(term, fitted)

    def beyond(size: float, tolerance: Tolerance) -> bool:
        return term.effect.beyond_tolerance(values | {quantity.name: size}, chain, tolerance, False)

    allowed, exact = problem.tolerance, replace(problem.tolerance, static_error=0.0, play=0.0)
    if beyond(quantity.low, allowed) or not beyond(quantity.high, allowed) or not beyond(quantity.low, exact):
        return 0.0
    low, high = quantity.low, quantity.high
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if beyond(middle, allowed) else (middle, high)
    return float(high)
