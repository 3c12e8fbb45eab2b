# SPDX-License-Identifier: BSD-3-Clause
"""What faulty parts make of a signal, in their plainest form: operators for regressors and features."""

import numpy as np


def filled(values):
    """Signal with gaps bridged; zeros where nothing is known."""
    known = np.isfinite(values)
    if not known.any():
        return np.zeros(len(values))
    return np.interp(np.arange(len(values)), np.flatnonzero(known), values[known])


def stick_and_jump(signal, band, jump):
    """A stem that rests until its drive is off by half a `band`, then jumps so that half of `jump` is left.

    Parameters
    ----------
    signal : ndarray of shape (n,)
        Where the drive would have the stem [1].
    band, jump : float
        Whole widths [1]; with no jump it is play.

    Returns
    -------
    stem : ndarray of shape (n,)
    """
    half, behind = 0.5 * band, 0.5 * (band - jump)
    at, out = signal[0], np.empty(len(signal))
    for k, wanted in enumerate(signal.tolist()):
        gap = wanted - at
        if gap > half:
            at = wanted - behind
        elif gap < -half:
            at = wanted + behind
        out[k] = at
    return out


def slope_by(x, y, many=14):
    """Slope of `y` over `x` in each row, from means of bins of `x`; for curves with little scatter."""
    edges = np.quantile(x, np.linspace(0.0, 1.0, many + 1))
    edges = np.unique(edges)
    if len(edges) < 4 or edges[-1] - edges[0] < 1e-4:
        return np.zeros(len(x))
    cell = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    rows = np.maximum(np.bincount(cell, minlength=len(edges) - 1), 1)
    middle = [np.bincount(cell, weights=v, minlength=len(edges) - 1) / rows for v in (x, y)]
    apart = np.concatenate([[True], np.diff(middle[0]) > 1e-6])
    if apart.sum() < 3:
        return np.zeros(len(x))
    return np.interp(x, middle[0][apart], np.gradient(middle[1][apart], middle[0][apart]))
