# SPDX-License-Identifier: BSD-3-Clause
"""How fast a loop swings, in rows, and how far its rows may be thinned for it."""

import numpy as np

_SLOWEST = 4  # swings in the record, at least: fewer are a trend
_NOISE = 3.0  # times the median of the power: what lies below is no swing
_KEPT = 30  # rows of a period that are kept; 20 are enough to see where a stem stands still
_FEWEST = 600  # rows that are kept in any case: more noise is averaged out by the fit than by thinning


def rows_a_swing(values):
    """Rows in a period of the strongest swing: the peak of frequency times power.

    Frequency times power is the power in an octave, so a slow wander does not hide a swing.

    Parameters
    ----------
    values : ndarray of shape (n,)

    Returns
    -------
    rows : float
        Infinite where nothing moves.
    """
    n = len(values)
    time = np.arange(n) / n
    swings = values - np.polyval(np.polyfit(time, values, 2), time)
    power = np.abs(np.fft.rfft(swings * np.hanning(n))) ** 2
    power = np.convolve(power, np.ones(3) / 3.0, mode="same")
    # white noise has the most power in the quickest octave
    power = np.maximum(power - _NOISE * np.median(power), 0.0) * np.arange(len(power))
    power[:_SLOWEST] = 0.0
    peak = int(np.argmax(power))
    return n / peak if peak else np.inf


def thinning(command, value):
    """Every how many rows are kept: as many as leave some 30 rows to a period, and 600 in all.

    Parameters
    ----------
    command, value : ndarray of shape (n,)

    Returns
    -------
    every : int
    period : float
        Of the faster of the two [rows as recorded].
    """
    period = min(rows_a_swing(command), rows_a_swing(value))
    most = len(command) // _FEWEST
    return (max(1, min(int(period / _KEPT), most)) if np.isfinite(period) else max(1, most)), period
