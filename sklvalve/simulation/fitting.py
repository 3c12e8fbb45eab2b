# SPDX-License-Identifier: BSD-3-Clause
"""Fit of a chain's open parameters to a recording by simulation error."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sklvalve.recording.dead_bands import band_of
from sklvalve.simulation.parameters import ParameterVector
from sklvalve.simulation.robust import (
    normal_equations,
    robust_cost,
    robust_weights,
    step_inside,
    stepped,
)

# old derivatives serve on while a step gains more than this share of the first step that they led
_STALE = 0.05
# of a noise not yet learnt, share of the span
_UNKNOWN = 0.003


@dataclass(frozen=True)
class ChannelFit:
    """Result of a fit of one or several channels.

    Attributes
    ----------
    values : dict
        Parameter name -> value.
    log_likelihood : float
        Robust log likelihood of the whitened residuals, priors included, up to a constant of the noise.
    predictions : dict
        Channel -> simulated signal.
    parameters : tuple of Parameter
    spreads : dict
        Parameter name -> standard deviation, of its logarithm where the parameter moves by that.
    settled : bool
        Whether it ended because no step gained any more, and not for having taken all the steps it may.
    """

    values: dict
    log_likelihood: float
    predictions: dict
    parameters: tuple = ()
    spreads: dict = field(default_factory=dict)
    settled: bool = True


@dataclass(frozen=True)
class PlainNoise:
    """White noise of one size, the stand-in before a noise model is fitted."""

    scale: float

    def whiten(self, residuals):
        """Residuals in standard deviations; gaps become zero."""
        return np.nan_to_num(residuals / self.scale)

    @property
    def pieces(self):
        """Filters of the recordings, as `NoiseModel.pieces`: none, for it remembers nothing."""
        return []


def first_noise(spans):
    """Noise of channels before anything is known of it, as share of their spans [SI]."""
    return {channel: PlainNoise(_UNKNOWN * span) for channel, span in spans.items()}


def simulate_channels(chain, values, channels):
    """Simulated signals of the channels, by name."""
    return {name: getattr(chain, name)(values) for name in channels}


def left_of(recording, predictions, channel):
    """Recorded minus simulated.

    Of an opening that a historian held within a dead band only what lies outside of the band is known to
    differ. A flow keeps all of its difference: in the mean over many values it tells far less than its band,
    and its noise model knows the band as the step of a reading.
    """
    left = recording[channel] - predictions[channel]
    if channel == "opening" and channel in recording.bands:
        left = np.copysign(np.maximum(np.abs(left) - band_of(recording, channel), 0.0), left)
    return left


def residual_of(chain, predictions, channel, rows):
    """Recorded minus simulated, NaN in rows that are not used."""
    left = left_of(chain.recording, predictions, channel)
    return left if rows is None else np.where(rows, left, np.nan)


class Misfit:
    """Whitened simulation error of some channels, as a function of the parameters that a fit moves.

    Parameters
    ----------
    chain : Chain
    parameters : sequence of Parameter
        Those to be moved.
    channels : sequence of str
        Signals to be met, `"opening"` and/or `"flow"`.
    noise : dict
        Channel -> object with `whiten(residuals)`.
    fixed : dict, default=None
        Values of parameters that the chain needs and that are not moved.
    rows : ndarray of bool, default=None
        Rows that count.
    """

    def __init__(self, chain, parameters, channels, noise, *, fixed=None, rows=None):
        self.chain, self.channels, self.noise, self.rows = chain, tuple(channels), noise, rows
        self.vector, self.fixed = ParameterVector(parameters), dict(fixed or {})

    def values(self, z):
        """Every parameter's value where the moved ones stand at `z`."""
        return self.fixed | self.vector.values(z)

    def predictions(self, z):
        """Simulated signals of the channels, by name."""
        return simulate_channels(self.chain, self.values(z), self.channels)

    def whitened(self, predictions):
        """Whitened residuals of predictions, channel after channel."""
        parts = [
            self.noise[c].whiten(residual_of(self.chain, predictions, c, self.rows)) for c in self.channels
        ]
        return np.concatenate(parts)

    def errors(self, z):
        """Whitened residuals of the channels, then distances from the priors."""
        return np.concatenate([self.whitened(self.predictions(z)), self.vector.prior_residuals(z)])

    def neighbours(self, z):
        """Points beside `z`, one a parameter, and how far each is: one-sided, away from the nearer bound."""
        reach = 1e-3 * self.vector.scale
        reach = np.where(z + reach > self.vector.high, -reach, reach)
        moved = z + np.diag(reach)
        if "opening" in self.channels:
            self.chain.free_runs_ahead([self.values(m) for m in moved])
        return moved, reach

    def slopes(self, z, base):
        """Derivatives of `errors` [n_errors, n_parameters], by one-sided differences from `base`.

        A parameter's own lie side by side in memory: the transpose is in C order.
        """
        moved, reach = self.neighbours(z)
        return np.stack([(self.errors(m) - base) / r for m, r in zip(moved, reach, strict=True)]).T


def fit_chain(
    chain, parameters, channels, noise, *, start=None, fixed=None, rows=None, max_steps=20, loss=None
):
    """Fit parameters to channels, least squares of the whitened simulation error with bounds and priors.

    Parameters
    ----------
    chain, parameters, channels, noise, fixed, rows
        As in `Misfit`; the chain must need no other parameters.
    start : dict, default=None
        Values to begin with; what it lacks begins at the parameter's own start.
    max_steps : int, default=20
        Bound on the number of optimiser steps.
    loss : Loss, default=SOFT
        `MAJORITY` fits most rows well and lets the others go.

    Returns
    -------
    fit : ChannelFit

    Notes
    -----
    Residuals beyond three standard deviations weigh linearly (soft L1). Derivatives are one-sided
    differences; a signal that cannot depend on a parameter is not simulated again for it.
    """
    misfit = Misfit(chain, parameters, channels, noise, fixed=fixed, rows=rows)
    vector = misfit.vector
    if not len(vector):
        predictions = simulate_channels(chain, misfit.fixed, channels)
        left = sum(log_likelihood(residual_of(chain, predictions, c, rows), noise[c]) for c in channels)
        return ChannelFit(misfit.fixed, left, predictions)
    inside = 1e-6 * np.minimum(vector.scale, vector.high - vector.low)
    z = np.clip(vector.pack(start or {}), vector.low + inside, vector.high - inside)
    z, cost, hessian, settled = _minimise(misfit.errors, misfit.slopes, z, vector, max_steps, loss or SOFT)
    spreads = _spreads(hessian, vector)
    # by rounding a fit may end beyond a bound, and a file of such a value is refused
    values = misfit.values(np.clip(z, vector.low, vector.high))
    return ChannelFit(values, -cost, misfit.predictions(z), tuple(parameters), spreads, settled)


@dataclass(frozen=True)
class Loss:
    """Cost of whitened residuals, and the weights of the quadratic that touches it from above."""

    cost: Callable
    weights: Callable


def _majority_cost(left):
    return float(0.5 * np.sum(np.log1p(left**2)))


def _majority_weights(left):
    return 1.0 / (1.0 + left**2)


SOFT = Loss(robust_cost, robust_weights)
MAJORITY = Loss(_majority_cost, _majority_weights)


def _minimise(stacked, slopes, z, vector, max_steps, loss):
    """Levenberg-Marquardt steps inside bounds.

    There are thousands of rows and a score of parameters, so the normal equations cost next to nothing
    beside the simulations, and derivatives serve for as many steps as they are good for. A parameter at its
    bound that would leave it sits out the step.
    """
    left = stacked(z)
    cost, damping, hessian, idle, settled = loss.cost(left), 1e-3, np.eye(len(z)), 0, False
    for _ in range(max_steps):
        rows, first = np.ascontiguousarray(slopes(z, left).T), 0.0
        gained, before, tries = 0.0, cost, 0
        while tries < 6:
            gradient, hessian = normal_equations(rows, loss.weights(left), left)
            # relative to each parameter's own curvature, with a little of its scale where there is none
            damped = hessian + damping * np.diag(np.diag(hessian) + 1e-6 / vector.scale**2)
            moved = z + step_inside(damped, gradient, vector.low - z, vector.high - z)
            new_left = stacked(moved)
            new_cost = loss.cost(new_left)
            way = (moved - z) / vector.scale
            if way.any():
                # what the step showed of the slopes along it (Broyden)
                missed = new_left - stepped(left, rows, moved - z)
                rows += np.outer(way / vector.scale / (way @ way), missed)
            if new_cost < cost:
                gained = cost - new_cost
                z, left, cost = moved, new_left, new_cost
                damping = max(0.2 * damping, 1e-9)
                first = first or gained
                # old derivatives are left when they have given most of what they can
                if gained < _STALE * first + 1e-3:
                    break
            elif first:
                break
            else:
                tries += 1
                damping = max(10.0 * damping, 1e-4)
        gained = before - cost
        # one short step may be the damping's doing; two are the valley's floor
        idle = idle + 1 if gained < 1e-5 * cost + 1e-3 else 0
        settled = gained == 0.0 or idle == (1 if damping < 1e-3 else 2)
        if settled:
            break
    return z, cost, hessian, settled


def log_likelihood(residuals, noise):
    """Robust log likelihood of residuals under a noise model, as `fit_chain` counts it."""
    return -robust_cost(noise.whiten(residuals))


def _spreads(hessian, vector):
    # the priors are rows of the fit, so the inverse exists wherever anything is known
    scale = vector.scale
    covariance = np.linalg.pinv(hessian * np.outer(scale, scale), rcond=1e-12, hermitian=True)
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0)) * scale
    return dict(zip(vector.names, spread.tolist(), strict=True))
