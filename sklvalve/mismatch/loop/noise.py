# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a loop's value: white noise on a wander, then whatever else repeats itself."""

import numpy as np
from scipy.signal import lfilter

from sklvalve.mismatch.loop.process import lagged

#: How much of the wander stays from row to row, and how slowly it is followed.
FILTERS = tuple(
    (keep, follow)
    for keep in (1.0, 0.98, 0.9, 0.7)
    for follow in (0.0, 0.4, 0.7, 0.85, 0.95, 0.99)
    if keep == 1.0 or follow <= keep
)
_ORDERS = (0, 2, 4, 8, 14, 24, 40)
_ROWS_EACH = 20  # to each coefficient and each wave, at least: more of them fit what will not come again
#: Harmonics and width of the oscillations from outside that are tried, a regular one and one that drifts.
RHYTHMS = ((1, 1), (3, 1), (5, 2), (3, 4), (5, 4), (9, 1), (9, 3))
_SWINGS = 8  # for each of its width: a band as wide as its own frequency is no rhythm but any slow course


def whiten(values, keep, follow):
    """What is new in each row of a wander under white noise.

    Filter (1 - keep B) / (1 - follow B), B the row before, started at rest at the first value; with
    ``keep = 1`` a random walk under white noise, the more white noise the nearer `follow` is to 1.

    Parameters
    ----------
    values : ndarray of shape (..., n)
    keep, follow : float

    Returns
    -------
    new : ndarray of shape (..., n)
    """
    return lfilter([1.0, -keep], [1.0, -follow], values - values[..., :1], axis=-1)


def whitened_level(n, keep, follow):
    """What `whiten` makes of a constant level, not started at rest."""
    return lfilter([1.0, -keep], [1.0, -follow], np.ones(n))


def autoregression(residual):
    """Coefficients by which a residual repeats itself, of the order that Akaike's criterion chooses.

    Up to 40 rows, so an oscillation from outside belongs to the noise.

    Parameters
    ----------
    residual : ndarray of shape (n,)

    Returns
    -------
    coefficients : ndarray of shape (p,)
    """
    most = min(_ORDERS[-1], len(residual) // _ROWS_EACH)
    before, now = lagged(residual, most)[most:], residual[most:]
    products, aims, power = before.T @ before, before.T @ now, now @ now
    # as small as rounding: a residual that repeats itself exactly
    products[np.diag_indices(most)] += 1e-12 * np.trace(products) / most
    best, best_score = np.zeros(0), len(now) * np.log(power)
    for order in _ORDERS[1:]:
        if order > most:
            break
        found = np.linalg.solve(products[:order, :order], aims[:order])
        left = max(power - found @ aims[:order], 1e-12 * power)
        score = len(now) * np.log(left) + 2 * order
        if score < best_score:
            best, best_score = found, score
    return best


def rhythms(value, used=None):
    """Oscillations that may come from outside: at the strongest frequency, beside it, and at its harmonics.

    Parameters
    ----------
    value : ndarray of shape (n,)
    used : ndarray of bool, shape (n,), optional
        Rows that were recorded; all unless given.

    Returns
    -------
    waves : list of ndarray of shape (k, n)
        The wider ones only where the swings are many.
    """
    n = len(value)
    recorded = n if used is None else int(used.sum())
    time = np.arange(n) / n
    swings = value - np.polyval(np.polyfit(time, value, 2), time)
    power = np.abs(np.fft.rfft(swings * np.hanning(n))) ** 2
    power[:3] = 0.0
    peak = int(np.argmax(power))
    out = []
    for harmonics, width in RHYTHMS:
        if width > 1 and peak < _SWINGS * width:
            continue
        turns = {h * peak + i for h in range(1, harmonics + 1) for i in range(-width, width + 1)}
        turns = sorted(turn for turn in turns if 0 < turn < n // 2)
        if 2 * len(turns) * _ROWS_EACH > recorded:
            continue
        angle = 2.0 * np.pi * np.outer(turns, time)
        out.append(np.concatenate([np.cos(angle), np.sin(angle)]))
    return out
