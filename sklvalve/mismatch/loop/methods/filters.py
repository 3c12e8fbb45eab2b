# SPDX-License-Identifier: BSD-3-Clause
"""Signals of an oscillating loop without drift and without noise."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, sosfiltfilt

from sklvalve.recording.gaps import filled


def control_error(value: ArrayLike, setpoint: ArrayLike | None) -> NDArray:
    """Value less set-point; the value itself where there is none."""
    value = np.asarray(value, dtype=float)
    return value if setpoint is None else value - np.asarray(setpoint, dtype=float)


def without_drift(signal: ArrayLike, rows: float) -> NDArray:
    """Signal less its average over one period: what is left repeats with the period, in its own shape.

    Parameters
    ----------
    signal : array-like of shape (n,)
        [any unit]
    rows : float
        Rows in a period.

    Returns
    -------
    centred : ndarray of shape (n,)
        [signal's unit]
    """
    signal = filled(signal)
    width = max(3, round(rows))
    return signal - uniform_filter1d(signal - signal.mean(), width, mode="nearest") - signal.mean()


def low_passed(signal: NDArray, frequency: float) -> NDArray:
    """Signal without what is faster than a frequency [cycles per row], not shifted in time."""
    if frequency >= 0.4:
        return signal
    sections = butter(2, 2.0 * frequency, output="sos")
    return sosfiltfilt(sections, signal, padlen=min(len(signal) - 1, int(3.0 / frequency)))
