# SPDX-License-Identifier: BSD-3-Clause
"""Every stem of a family, each with the process and the noise that suit it best."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sklvalve.mismatch.loop.least_squares import nonnegative_weights, residual_sums
from sklvalve.mismatch.loop.noise import (
    FILTERS,
    external_oscillations,
    fit_autoregression,
    whiten,
    whitened_level,
)

_REFINED = 6  # stems whose noise is fitted in full
_ROUNDS = 3  # of autoregression and weights in turns

NoiseFilter = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Regression:
    """A value to be explained by the responses to one of several stems.

    Parameters
    ----------
    responses : ndarray of shape (m, k, n)
        To each stem; in a search for sticking the first stem is the command itself [fraction of travel].
    value : ndarray of shape (n,)
        [value's unit]
    used : ndarray of bool, shape (n,)
        Rows that count.
    gain_sign : int
        Sign of the process gain, 1 or -1.
    oscillation : ndarray of shape (w, n), optional
        Waves from outside that stand beside the stem [1].
    """

    responses: NDArray
    value: NDArray
    used: NDArray[np.bool_]
    gain_sign: int
    oscillation: NDArray | None = None


@dataclass(frozen=True, eq=False)
class LoopFit:
    """One stem, its process and its noise.

    Parameters
    ----------
    regression : Regression
        That was fitted, with the oscillation from outside that stands beside the stem.
    index : int
        Place among the stems; 0 is the command itself.
    weights : ndarray of shape (k,)
        Of the responses [value's unit / fraction of travel].
    noise_filter : tuple of float
        As in `FILTERS`.
    innovations : ndarray of shape (rows used,)
        Errors of the forecast one row ahead [value's unit].
    log_likelihood : float
        Gaussian, less a complexity penalty of one for each coefficient of the autoregression and of the
        oscillation [nats].
    """

    regression: Regression
    index: int
    weights: NDArray
    noise_filter: NoiseFilter
    innovations: NDArray
    log_likelihood: float

    @property
    def response(self) -> NDArray:
        """Free run of the value, but for its level, of shape (n,) [value's unit]."""
        return self.weights @ self.regression.responses[self.index]


@dataclass(frozen=True, eq=False)
class Screening:
    """Every stem under the simpler noise, a wander under white noise.

    Parameters
    ----------
    log_likelihoods : ndarray of shape (m,)
        Of each stem [nats].
    noise_filters : list of tuple of float
        The filter that suits each, as in `FILTERS`.
    without_response : float
        Log likelihood without any response [nats].
    """

    log_likelihoods: NDArray
    noise_filters: list[NoiseFilter]
    without_response: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """The command itself and the stems, each with the noise that suits it best.

    Parameters
    ----------
    screening : Screening
        Of each stem, beside the oscillation from outside that the command's own model asks for.
    command, sticking, small_band : LoopFit
        Of the command itself, of the best stem with a relevant band, and of the best with a smaller one.
    """

    screening: Screening
    command: LoopFit
    sticking: LoopFit
    small_band: LoopFit


def likeliest(fits: Iterable[LoopFit]) -> LoopFit:
    """The fit of the largest log likelihood, the first of equal ones."""
    return max(fits, key=attrgetter("log_likelihood"))


def screen(regression: Regression) -> Screening:
    """Log likelihood of each stem under the simpler noise, a wander under white noise."""
    used, count = regression.used, int(regression.used.sum())
    # waves of single frequencies pass every filter as themselves, so that they can be taken out before it
    responses = np.ascontiguousarray(_without_oscillation(regression.responses, regression))
    value = _without_oscillation(regression.value, regression)
    sums, without_response = residual_sums(
        responses, value, used, np.array(FILTERS), float(regression.gain_sign)
    )
    best = np.argmin(sums, axis=1)
    return Screening(
        -0.5 * count * np.log(sums[np.arange(len(sums)), best] / count),
        [FILTERS[place] for place in best],
        float(-0.5 * count * np.log(without_response.min() / count)),
    )


def fit_stems(regression: Regression, relevant: NDArray[np.bool_], small: NDArray[np.bool_]) -> Comparison:
    """Fits of the command and of the best stem, without and with an oscillation from outside.

    An oscillation from outside may stand beside the command *and* beside a stem that sticks: else the stem
    would be preferred for what the valve has no part in, or a regular disturbance would hide it.

    Parameters
    ----------
    regression : Regression
        Its first stem is the command; without an oscillation.
    relevant, small : ndarray of bool, shape (m,)
        Stems with a relevant band, and those with a smaller one.

    Returns
    -------
    comparison : Comparison
    """
    plain = _compare(regression, relevant, small)
    filters = {plain.command.noise_filter, plain.sticking.noise_filter}
    waves = external_oscillations(regression.value, regression.used)
    beside_waves = [replace(regression, oscillation=each) for each in waves]
    command = likeliest([plain.command, *(refine(r, 0, each) for r in beside_waves for each in filters)])
    if command is plain.command:
        return plain
    beside = _compare(command.regression, relevant, small)
    return Comparison(
        beside.screening,
        likeliest([command, beside.command]),
        likeliest([plain.sticking, beside.sticking]),
        likeliest([plain.small_band, beside.small_band]),
    )


def _compare(regression: Regression, relevant: NDArray[np.bool_], small: NDArray[np.bool_]) -> Comparison:
    """The command and the best stems, all with or all without the oscillation."""
    screening = screen(regression)
    filters, order = screening.noise_filters, np.argsort(-screening.log_likelihoods, kind="stable")
    sticking, small_band = (
        likeliest(refine(regression, int(k), filters[k]) for k in order[eligible[order]][:most])
        for eligible, most in ((relevant, _REFINED), (small, _REFINED // 2))
    )
    tried = {filters[0], sticking.noise_filter}
    command = likeliest(refine(regression, 0, each) for each in tried)
    return Comparison(screening, command, sticking, small_band)


def _without_oscillation(values: NDArray, regression: Regression) -> NDArray:
    """Values along the last axis without what the oscillation (and a level) explains of them."""
    waves, used = regression.oscillation, regression.used
    if waves is None:
        return values
    basis = np.concatenate([np.ones((1, waves.shape[1])), waves])
    sizes = np.linalg.pinv(basis[:, used].T) @ np.moveaxis(values[..., used], -1, 0).reshape(used.sum(), -1)
    return values - (sizes.T @ basis).reshape(values.shape)


def fit_weights(
    responses: NDArray, value: NDArray, rows: NDArray[np.bool_], gain_sign: int, noise_filter: NoiseFilter
) -> tuple[NDArray, float]:
    """Weights of one stem's responses, from some of the rows.

    Returns the weights, of shape (k,) [value's unit / fraction of travel], and the root of the residual sum
    of squares. `rows` are those fitted, `responses` of shape (k, n).
    """
    level = whitened_level(len(value), *noise_filter)[None]
    whitened = whiten(responses, *noise_filter), whiten(value, *noise_filter)
    weights, residual = _solve(*whitened, level, rows, gain_sign)
    return weights, float(np.linalg.norm(residual[rows]))


def _solve(
    responses: NDArray, value: NDArray, free: NDArray, rows: NDArray[np.bool_], gain_sign: int
) -> tuple[NDArray, NDArray]:
    """Weights of one sign for the responses and of any for the free terms; the residual of every row."""
    free = free[np.any(free[:, rows] != 0.0, axis=1)]
    basis = np.linalg.qr(free[:, rows].T)[0]
    projected = responses[:, rows] - (responses[:, rows] @ basis) @ basis.T
    target = value[rows] - basis @ (basis.T @ value[rows])
    sizes = np.sqrt((projected**2).sum(axis=1))
    scale = sizes.max() or 1.0
    sizes = np.where(sizes > 1e-9 * scale, sizes, scale)
    reduced = gain_sign * projected / sizes[:, None]
    weights = gain_sign * nonnegative_weights(reduced @ reduced.T, reduced @ target)[0] / sizes
    return weights, _without_free(value - weights @ responses, free, rows)


def refine(regression: Regression, index: int, noise_filter: NoiseFilter) -> LoopFit:
    """The fit of the stem at an index, with an autoregression behind the filter of its noise."""
    used, waves = regression.used, regression.oscillation
    value = whiten(regression.value, *noise_filter)
    responses = whiten(regression.responses[index], *noise_filter)
    free = whitened_level(len(value), *noise_filter)[None]
    if waves is not None:
        free = np.concatenate([free, whiten(waves, *noise_filter)])

    def scored(weights: NDArray, innovations: NDArray, order: int) -> LoopFit:
        likelihood = -0.5 * len(innovations) * np.log(np.mean(innovations**2)) - order - (len(free) - 1)
        return LoopFit(regression, index, weights, noise_filter, innovations, float(likelihood))

    weights, residual = _solve(responses, value, free, used, regression.gain_sign)
    fits = [scored(weights, residual[used], 0)]
    for _ in range(_ROUNDS):
        coefficients = fit_autoregression(residual[used])
        if not len(coefficients):
            break
        inverse = np.concatenate([[1.0], -coefficients])
        filtered = [lfilter(inverse, [1.0], rows, axis=-1) for rows in (responses, value, free)]
        weights, innovations = _solve(filtered[0], filtered[1], filtered[2], used, regression.gain_sign)
        fits.append(scored(weights, innovations[used], len(coefficients)))
        residual = _without_free(value - weights @ responses, free, used)
    return likeliest(fits)


def _without_free(values: NDArray, free: NDArray, used: NDArray[np.bool_]) -> NDArray:
    """Values without what the level and the waves explain of them."""
    return values - np.linalg.lstsq(free[:, used].T, values[used], rcond=None)[0] @ free
