# SPDX-License-Identifier: BSD-3-Clause
"""Periods of an oscillating signal, cut at its zero crossings and laid side by side."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, sosfiltfilt

from sklvalve.mismatch.loop.constants import FEWEST_HALF_PERIODS
from sklvalve.mismatch.loop.oscillation import filled, zero_crossings

POINTS = 33  # of each half period, ends included
_HARMONICS = 8.0  # kept of the wave; what is faster is noise to a shape of two straight lines
_NEAR = 1.0 / 6.0  # of a period, in which the wave's own zero lies from that of its first harmonic
_LENGTHS = (0.25, 0.8)  # of a period, of half periods that count


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


def half_periods(signal: ArrayLike, rows: float) -> NDArray:
    """Half periods of an oscillation from zero to zero, all turned upwards.

    Parameters
    ----------
    signal : array-like of shape (n,)
        As recorded.
    rows : float
        Rows in a period.

    Returns
    -------
    shapes : ndarray of shape (h, POINTS)
        Signal less its drift, at even steps from one zero to the next [signal's unit]; none if there are no
        two zeros.
    """
    centred = without_drift(signal, rows)
    smooth = low_passed(centred, _HARMONICS / rows)
    all_zeros, first = zero_crossings(smooth), zero_crossings(low_passed(centred, 1.6 / rows))
    if len(all_zeros) < 2 or len(first) < 2:
        return np.empty((0, POINTS))
    nearest = _nearest(all_zeros, first)
    zeros = np.where(np.abs(nearest - first) < _NEAR * rows, nearest, first)
    lengths = np.diff(zeros)
    counted = (lengths > _LENGTHS[0] * rows) & (lengths < _LENGTHS[1] * rows)
    begin, lengths = zeros[:-1][counted], lengths[counted]
    at = begin[:, None] + lengths[:, None] * np.linspace(0.0, 1.0, POINTS)
    shapes = np.interp(at, np.arange(len(smooth)), smooth)
    return shapes * np.sign(shapes.sum(axis=1))[:, None]


def too_few(name: str, shapes: NDArray) -> str | None:
    """The sentence that says that a signal has too few half periods; None where it has enough."""
    if len(shapes) >= FEWEST_HALF_PERIODS:
        return None
    return f"The {name} has {len(shapes)} whole half periods, and {FEWEST_HALF_PERIODS} are needed."


def _nearest(places: NDArray, wanted: NDArray) -> NDArray:
    """The nearest of some sorted places to each place that is wanted."""
    after = np.clip(np.searchsorted(places, wanted), 1, len(places) - 1)
    below, above = places[after - 1], places[after]
    return np.where(wanted - below < above - wanted, below, above)


def residual_squares(shapes: NDArray, dictionary: NDArray) -> NDArray:
    """Residual sum of squares of each half period by the best shape of a dictionary, its size free.

    Parameters
    ----------
    shapes : ndarray of shape (h, POINTS)
        [signal's unit]
    dictionary : ndarray of shape (m, POINTS)

    Returns
    -------
    squares : ndarray of shape (h,)
        [signal's unit squared]
    """
    unit = dictionary / np.linalg.norm(dictionary, axis=1, keepdims=True)
    size = np.maximum(shapes @ unit.T, 0.0).max(axis=1)
    return np.maximum((shapes**2).sum(axis=1) - size**2, 0.0)


def sines() -> NDArray:
    """Half a sine, shape (1, POINTS)."""
    return np.sin(np.pi * np.linspace(0.0, 1.0, POINTS))[None]


def triangles() -> NDArray:
    """Triangles with their peak at every place between a tenth and nine tenths, shape (m, POINTS)."""
    at = np.linspace(0.0, 1.0, POINTS)
    peaks = np.linspace(0.1, 0.9, 33)[:, None]
    return np.minimum(at / peaks, (1.0 - at) / (1.0 - peaks))
