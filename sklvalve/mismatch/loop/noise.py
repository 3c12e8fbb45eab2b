# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a loop's value: a wander under white noise, an autoregression, and oscillations from outside."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sklvalve.mismatch.loop.oscillation import swing_spectrum
from sklvalve.mismatch.loop.process import lagged

#: How much of the wander stays from row to row, and how slowly it is followed.
FILTERS = tuple(
    (keep, follow)
    for keep in (1.0, 0.98, 0.9, 0.7)
    for follow in (0.0, 0.4, 0.7, 0.85, 0.95, 0.99)
    if keep == 1.0 or follow <= keep
)
_ORDERS = (2, 4, 8, 14, 24, 40)
_ROWS_PER_TERM = 20  # for each coefficient and each wave, at least: more of them fit what will not come again
#: Harmonics and width of the oscillations from outside that are tried, a regular one and one that drifts.
_OSCILLATIONS = ((1, 1), (3, 1), (5, 2), (3, 4), (5, 4), (9, 1), (9, 3))
_SWINGS_PER_WIDTH = 8  # a band as wide as its own frequency is no oscillation but any slow change


def whiten(values: NDArray, keep: float, follow: float) -> NDArray:
    """Innovations of a wander under white noise.

    Filter (1 - keep B) / (1 - follow B), B the row before, started at rest at the first value; with
    ``keep = 1`` a random walk under white noise, the more white noise the nearer `follow` is to 1.

    Parameters
    ----------
    values : ndarray of shape (..., n)
        [any unit]
    keep, follow : float

    Returns
    -------
    innovations : ndarray of shape (..., n)
        [unit of the values]
    """
    return lfilter([1.0, -keep], [1.0, -follow], values - values[..., :1], axis=-1)


def whitened_level(n: int, keep: float, follow: float) -> NDArray:
    """What `whiten` makes of a constant level, not started at rest."""
    return lfilter([1.0, -keep], [1.0, -follow], np.ones(n))


def fit_autoregression(residual: NDArray) -> NDArray:
    """Coefficients of an autoregression of a residual, of the order that Akaike's criterion chooses.

    The order is up to 40 rows, so an oscillation from outside belongs to the noise.
    """
    most = min(_ORDERS[-1], len(residual) // _ROWS_PER_TERM)
    before, now = lagged(residual, most)[most:], residual[most:]
    products, cross_products, power = before.T @ before, before.T @ now, now @ now
    # as small as rounding: a residual that repeats itself exactly
    products[np.diag_indices(most)] += 1e-12 * np.trace(products) / most
    best, best_score = np.zeros(0), len(now) * np.log(power)
    for order in (order for order in _ORDERS if order <= most):
        coefficients = np.linalg.solve(products[:order, :order], cross_products[:order])
        left = max(power - coefficients @ cross_products[:order], 1e-12 * power)
        score = len(now) * np.log(left) + 2 * order
        if score < best_score:
            best, best_score = coefficients, score
    return best


def external_oscillations(value: NDArray, used: NDArray[np.bool_]) -> list[NDArray]:
    """Oscillations that may come from outside: at the strongest frequency, beside it, and at its harmonics.

    Parameters
    ----------
    value : ndarray of shape (n,)
        [any unit]
    used : ndarray of bool, shape (n,)
        Rows that were recorded.

    Returns
    -------
    oscillations : list of ndarray of shape (w, n)
        Cosines and sines [1]; the wider sets only where the swings are many.
    """
    n = len(value)
    power = swing_spectrum(value)
    power[:3] = 0.0
    peak = int(np.argmax(power))
    oscillations = []
    for count, width in _OSCILLATIONS:
        frequencies = _frequencies(peak, count, width, n)
        too_wide = width > 1 and peak < _SWINGS_PER_WIDTH * width
        if not too_wide and 2 * len(frequencies) * _ROWS_PER_TERM <= used.sum():
            angle = 2.0 * np.pi * np.outer(frequencies, np.arange(n) / n)
            oscillations.append(np.concatenate([np.cos(angle), np.sin(angle)]))
    return oscillations


def _frequencies(peak: int, count: int, width: int, n: int) -> list[int]:
    """Cycles in the record of the first harmonics of a peak, each with its neighbours."""
    cycles = {h * peak + i for h in range(1, count + 1) for i in range(-width, width + 1)}
    return sorted(cycle for cycle in cycles if 0 < cycle < n // 2)
