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
_ORDERS = (0, 2, 4, 8, 14)
_HARMONICS = (1, 2, 3)
_WIDTH = 1  # neighbouring frequencies on either side: an oscillation's amplitude and phase may drift


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

    Up to 14 rows, so an oscillation from outside belongs to the noise.

    Parameters
    ----------
    residual : ndarray of shape (n,)

    Returns
    -------
    coefficients : ndarray of shape (p,)
    """
    most = min(_ORDERS[-1], len(residual) // 10)
    before, now = lagged(residual, most)[most:], residual[most:]
    best, best_score = np.zeros(0), len(now) * np.log(np.mean(now**2))
    for order in _ORDERS[1:]:
        if order > most:
            break
        found = np.linalg.lstsq(before[:, :order], now, rcond=None)[0]
        score = len(now) * np.log(np.mean((now - before[:, :order] @ found) ** 2)) + 2 * order
        if score < best_score:
            best, best_score = found, score
    return best


def rhythm(value):
    """Waves that may come from outside: at the strongest frequency, beside it, and at its harmonics.

    Parameters
    ----------
    value : ndarray of shape (n,)

    Returns
    -------
    waves : ndarray of shape (k, n)
    """
    n = len(value)
    time = np.arange(n) / n
    rest = value - np.polyval(np.polyfit(time, value, 2), time)
    power = np.abs(np.fft.rfft(rest * np.hanning(n))) ** 2
    power[:3] = 0.0
    peak = int(np.argmax(power))
    turns = [h * peak + i for h in _HARMONICS for i in range(-_WIDTH, _WIDTH + 1) if h * peak + i < n // 2]
    angle = 2.0 * np.pi * np.outer(turns, time)
    return np.concatenate([np.cos(angle), np.sin(angle)])
