# SPDX-License-Identifier: BSD-3-Clause
"""Every stem of a family, each with the process and the noise that suit it best."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls
from scipy.signal import lfilter

from sklvalve.mismatch.loop.noise import FILTERS, autoregression, rhythm, whiten, whitened_level

_REFINED = 8  # stems whose noise is fitted in full
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
    likelihoods = np.full(len(columns), -np.inf)
    noises: list[tuple[float, float]] = [FILTERS[0]] * len(columns)
    silent = -np.inf
    for noise in FILTERS:
        new, level = whiten(value, *noise)[used], whitened_level(len(value), *noise)[used]
        # nothing of a level is left where the first row does not count
        level = level / (np.linalg.norm(level) or 1.0)
        new = new - level * (level @ new)
        silent = max(silent, -0.5 * count * np.log(new @ new / count))
        answers = whiten(columns, *noise)[..., used]
        answers -= (answers @ level)[..., None] * level
        for place, rows in enumerate(answers):
            scale = np.sqrt((rows**2).sum(axis=1).max()) or 1.0
            _, norm = nnls(sense * rows.T / scale, new)
            likelihood = -0.5 * count * np.log(norm**2 / count)
            if likelihood > likelihoods[place]:
                likelihoods[place], noises[place] = likelihood, noise
    return likelihoods, noises, silent


def fit_stems(columns, value, used, sense):
    """Log likelihood of each stem under the simpler noise, and full fits of the command and the best stem.

    Parameters
    ----------
    columns, value, used, sense
        As in `simple_fits`; the first stem is the command.

    Returns
    -------
    likelihoods, silent
        As of `simple_fits`.
    command, stem : LoopFit
        The fit of the command itself, and of the best other stem.
    """
    likelihoods, noises, silent = simple_fits(columns, value, used, sense)
    best = 1 + np.argsort(-likelihoods[1:], kind="stable")[:_REFINED]
    stem = max(
        (refined(columns, place, value, used, sense, noises[place]) for place in best),
        key=lambda fit: fit.log_likelihood,
    )
    # the command may have any noise that served the stem, and an oscillation from outside beside it: else
    # the stem would be preferred for what the valve has no part in
    waves = rhythm(value)
    command = max(
        (
            refined(columns, 0, value, used, sense, noise, extra)
            for noise in {noises[0], stem.noise}
            for extra in (None, waves)
        ),
        key=lambda fit: fit.log_likelihood,
    )
    return likelihoods, silent, command, stem


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
    weights, _ = nnls(sense * answered.T / scale, aim)
    mixture = sense * weights / scale
    left = new - mixture @ answers
    return mixture, left - np.linalg.lstsq(free[:, rows].T, left[rows], rcond=None)[0] @ free


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
        left = new - mixture @ answers
        left = left - np.linalg.lstsq(free[:, used].T, left[used], rcond=None)[0] @ free
    return found


def _scored(place, mixture, noise, order, left, extra):
    likelihood = -0.5 * len(left) * np.log(np.mean(left**2)) - order - extra
    return LoopFit(place, mixture, noise, order, left, extra > 0, float(likelihood))
