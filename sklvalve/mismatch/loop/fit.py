# SPDX-License-Identifier: BSD-3-Clause
"""Every stem of a family, each with the process and the noise that suit it best."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from sklvalve.mismatch.loop.noise import FILTERS, autoregression, rhythms, whiten, whitened_level
from sklvalve.mismatch.loop.search import left_over, nonnegative

_REFINED = 6  # stems whose noise is fitted in full
_ROUNDS = 3


@dataclass(frozen=True, eq=False)
class LoopFit:
    """One stem, its process and its noise.

    Parameters
    ----------
    stem : int
        Place among the candidates; 0 is the command itself.
    mixture : ndarray of shape (k,)
        Weights of the responses [value's unit].
    noise : tuple of float
        The filter, as in `FILTERS`.
    order : int
        Order of the autoregression behind it.
    innovations : ndarray of shape (rows used,)
        What the past foresees of no row [value's unit].
    rhythm : bool
        Whether an oscillation from outside stands beside it.
    log_likelihood : float
        Gaussian, with one taken off for each coefficient of the autoregression and of the oscillation.
    """

    stem: int
    mixture: np.ndarray
    noise: tuple[float, float]
    order: int
    innovations: np.ndarray
    rhythm: bool
    log_likelihood: float


def simple_fits(columns, value, used, sense):
    """Log likelihood of each stem under the simpler noise, a wander under white noise.

    Parameters
    ----------
    columns : ndarray of shape (m, k, n)
        Responses to each stem.
    value : ndarray of shape (n,)
    used : ndarray of bool, shape (n,)
        Rows that count.
    sense : int
        Sign of the response.

    Returns
    -------
    likelihoods : ndarray of shape (m,)
    noises : list of tuple of float
        The filter that suits each, as in `FILTERS`.
    silent : float
        Log likelihood without any response.
    """
    count = int(used.sum())
    left, free = left_over(
        np.ascontiguousarray(columns), np.asarray(value, float), used, np.array(FILTERS), float(sense)
    )
    best = np.argmin(left, axis=1)
    likelihoods = -0.5 * count * np.log(left[np.arange(len(left)), best] / count)
    silent = float(-0.5 * count * np.log(free.min() / count))
    return likelihoods, [FILTERS[place] for place in best], silent


@dataclass(frozen=True, eq=False)
class Compared:
    """The command itself and the stems, each with the noise that suits it best.

    Parameters
    ----------
    likelihoods : ndarray of shape (m,)
        Of each stem under the simpler noise, beside the oscillation from outside where there is one.
    silent : float
        Without any response.
    command, stem, small : LoopFit
        Of the command itself, of the best stem whose band matters, and of the best with a smaller one.
    waves : ndarray of shape (w, n) or None
        The oscillation from outside that the command's own model wants.
    """

    likelihoods: np.ndarray
    silent: float
    command: LoopFit
    stem: LoopFit
    small: LoopFit
    waves: np.ndarray | None


def fit_stems(columns, value, used, sense, eligible):
    """Fits of the command and of the best stem, without and with an oscillation from outside.

    An oscillation from outside may stand beside the command *and* beside a stem that sticks: else the stem
    would be preferred for what the valve has no part in, or a regular disturbance would hide it.

    Parameters
    ----------
    columns, value, used, sense
        As in `simple_fits`; the first stem is the command.
    eligible : (ndarray of bool, ndarray of bool), each of shape (m,)
        Stems that may be chosen: those with a band that matters, and those with a smaller one.

    Returns
    -------
    compared : Compared
    """
    plain = _compared(columns, value, used, sense, eligible, None)
    noises = {plain.command.noise, plain.stem.noise}
    tried = rhythms(value, used)
    if not tried:  # too few rows for any wave
        return plain
    fits = [
        max(
            (refined(columns, 0, value, used, sense, noise, waves) for noise in noises),
            key=lambda fit: fit.log_likelihood,
        )
        for waves in tried
    ]
    best = int(np.argmax([fit.log_likelihood for fit in fits]))
    if fits[best].log_likelihood <= plain.command.log_likelihood:
        return plain
    beside = _compared(columns, value, used, sense, eligible, tried[best])
    command = max(fits[best], beside.command, key=lambda fit: fit.log_likelihood)
    stem = max(plain.stem, beside.stem, key=lambda fit: fit.log_likelihood)
    small = max(plain.small, beside.small, key=lambda fit: fit.log_likelihood)
    return Compared(beside.likelihoods, beside.silent, command, stem, small, tried[best])


def _compared(columns, value, used, sense, eligible, waves):
    # waves of single frequencies pass every filter as themselves, so that they can be taken out before it
    likelihoods, noises, silent = simple_fits(
        without(columns, waves, used), without(value, waves, used), used, sense
    )
    order = np.argsort(-likelihoods, kind="stable")
    stem, small = (
        max(
            (
                refined(columns, place, value, used, sense, noises[place], waves)
                for place in order[chosen[order]][:most]
            ),
            key=lambda fit: fit.log_likelihood,
        )
        for chosen, most in zip(eligible, (_REFINED, _REFINED // 2), strict=True)
    )
    command = max(
        (refined(columns, 0, value, used, sense, noise, waves) for noise in {noises[0], stem.noise}),
        key=lambda fit: fit.log_likelihood,
    )
    return Compared(likelihoods, silent, command, stem, small, waves)


def without(values, waves, used):
    """Values along the last axis without what waves (and a level) explain of them.

    Parameters
    ----------
    values : ndarray of shape (..., n)
    waves : ndarray of shape (w, n) or None
    used : ndarray of bool, shape (n,)

    Returns
    -------
    left : ndarray of shape (..., n)
    """
    if waves is None:
        return values
    basis = np.concatenate([np.ones((1, waves.shape[1])), waves])
    found = np.linalg.pinv(basis[:, used].T) @ np.moveaxis(values[..., used], -1, 0).reshape(used.sum(), -1)
    return values - (found.T @ basis).reshape(values.shape)


def mixture_of(columns, value, rows, sense, noise):
    """Weights of one stem's responses, from some of the rows.

    Parameters
    ----------
    columns : ndarray of shape (k, n)
    value : ndarray of shape (n,)
    rows : ndarray of bool, shape (n,)
    sense : int
    noise : tuple of float

    Returns
    -------
    mixture : ndarray of shape (k,)
    norm : float
        Root of the sum of squares that is left over.
    """
    level = whitened_level(len(value), *noise)[None]
    mixture, left = _solve(whiten(columns, *noise), whiten(value, *noise), level, rows, sense)
    return mixture, float(np.linalg.norm(left[rows]))


def _solve(answers, new, free, rows, sense):
    """Weights of one sign for the answers and of any for the rest; what is left over in every row."""
    free = free[np.any(free[:, rows] != 0.0, axis=1)]
    basis = np.linalg.qr(free[:, rows].T)[0]
    answered = answers[:, rows] - (answers[:, rows] @ basis) @ basis.T
    aim = new[rows] - basis @ (basis.T @ new[rows])
    scale = np.sqrt((answered**2).sum(axis=1).max()) or 1.0
    sizes = np.sqrt((answered**2).sum(axis=1))
    sizes = np.where(sizes > 1e-9 * scale, sizes, scale)
    reduced = sense * answered / sizes[:, None]
    weights, _ = nonnegative(reduced @ reduced.T, reduced @ aim)
    mixture = sense * weights / sizes
    left = new - mixture @ answers
    return mixture, _levelled(left, free, rows)


def refined(columns, place, value, used, sense, noise, waves=None):
    """The fit of one stem with an autoregression behind its noise, and `waves` from outside if given.

    Parameters
    ----------
    columns : ndarray of shape (m, k, n)
        Responses to each stem.
    place : int
        Which stem.
    value : ndarray of shape (n,)
    used : ndarray of bool, shape (n,)
    sense : int
    noise : tuple of float
        The filter to begin with, as in `FILTERS`.
    waves : ndarray of shape (w, n), optional

    Returns
    -------
    fit : LoopFit
    """
    new, answers = whiten(value, *noise), whiten(columns[place], *noise)
    free = whitened_level(len(value), *noise)[None]
    if waves is not None:
        free = np.concatenate([free, whiten(waves, *noise)])
    extra = len(free) - 1
    mixture, left = _solve(answers, new, free, used, sense)
    found = _scored(place, mixture, noise, 0, left[used], extra)
    for _ in range(_ROUNDS):
        coefficients = autoregression(left[used])
        if not len(coefficients):
            break
        after = np.concatenate([[1.0], -coefficients])
        mixture, fresh = _solve(
            *(lfilter(after, [1.0], rows, axis=-1) for rows in (answers, new, free)), used, sense
        )
        tried = _scored(place, mixture, noise, len(coefficients), fresh[used], extra)
        if tried.log_likelihood > found.log_likelihood:
            found = tried
        left = _levelled(new - mixture @ answers, free, used)
    return found


def _levelled(values, free, used):
    """Values without what the level and the waves explain of them."""
    return values - np.linalg.lstsq(free[:, used].T, values[used], rcond=None)[0] @ free


def _scored(place, mixture, noise, order, left, extra):
    likelihood = -0.5 * len(left) * np.log(np.mean(left**2)) - order - extra
    return LoopFit(place, mixture, noise, order, left, extra > 0, float(likelihood))
