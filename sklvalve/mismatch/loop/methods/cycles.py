# SPDX-License-Identifier: BSD-3-Clause
"""Periods of an oscillating signal, cut at its zero crossings and laid side by side."""

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, sosfiltfilt

from sklvalve.mismatch.loop.oscillation import filled

POINTS = 33  # of each half period, ends included
_HARMONICS = 8.0  # kept of the wave; what is faster is noise to a shape of two straight lines
_NEAR = 1.0 / 6.0  # of a period, in which the wave's own zero lies from that of its first harmonic
_LENGTHS = (0.25, 0.8)  # of a period, of half periods that count


def without_drift(signal, rows):
    """Signal less its average over one period: what is left repeats with the period, in its own shape.

    Parameters
    ----------
    signal : array-like of shape (n,)
    rows : float
        Rows in a period.

    Returns
    -------
    centred : ndarray of shape (n,)
    """
    signal = filled(signal)
    width = max(3, round(rows))
    return signal - uniform_filter1d(signal - signal.mean(), width, mode="nearest") - signal.mean()


def low_passed(signal, frequency):
    """Signal without what is faster than a frequency [cycles per row], not shifted in time."""
    if frequency >= 0.4:
        return signal
    sections = butter(2, 2.0 * frequency, output="sos")
    return sosfiltfilt(sections, signal, padlen=min(len(signal) - 1, int(3.0 / frequency)))


def half_periods(signal, rows):
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
    own, first = _zeros(smooth), _zeros(low_passed(centred, 1.6 / rows))
    if len(own) < 2 or len(first) < 2:
        return np.empty((0, POINTS))
    nearest = _nearest(own, first)
    zeros = np.where(np.abs(nearest - first) < _NEAR * rows, nearest, first)
    lengths = np.diff(zeros)
    counted = (lengths > _LENGTHS[0] * rows) & (lengths < _LENGTHS[1] * rows)
    begin, lengths = zeros[:-1][counted], lengths[counted]
    if not len(begin):
        return np.empty((0, POINTS))
    at = begin[:, None] + lengths[:, None] * np.linspace(0.0, 1.0, POINTS)
    shapes = np.interp(at, np.arange(len(smooth)), smooth)
    return shapes * np.sign(shapes.sum(axis=1))[:, None]


def _zeros(signal):
    signs = signal > 0.0
    before = np.flatnonzero(signs[1:] != signs[:-1])
    return before + signal[before] / (signal[before] - signal[before + 1])


def _nearest(own, wanted):
    after = np.clip(np.searchsorted(own, wanted), 1, len(own) - 1)
    return np.where(wanted - own[after - 1] < own[after] - wanted, own[after - 1], own[after])


def left_over(shapes, dictionary):
    """Sum of squares that the best shape of a dictionary leaves of each half period, its size free.

    Parameters
    ----------
    shapes : ndarray of shape (h, POINTS)
    dictionary : ndarray of shape (m, POINTS)

    Returns
    -------
    left : ndarray of shape (h,)
    """
    unit = dictionary / np.linalg.norm(dictionary, axis=1, keepdims=True)
    found = np.maximum(shapes @ unit.T, 0.0).max(axis=1)
    return np.maximum((shapes**2).sum(axis=1) - found**2, 0.0)


def sines():
    """Half a sine, shape (1, POINTS)."""
    return np.sin(np.pi * np.linspace(0.0, 1.0, POINTS))[None]


def triangles():
    """Triangles with their peak at every place between a tenth and nine tenths, shape (m, POINTS)."""
    at = np.linspace(0.0, 1.0, POINTS)
    peaks = np.linspace(0.1, 0.9, 33)[:, None]
    return np.minimum(at / peaks, (1.0 - at) / (1.0 - peaks))
