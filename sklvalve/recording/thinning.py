# SPDX-License-Identifier: BSD-3-Clause
"""Courses of many rows, thinned for a picture."""

import numpy as np
from numpy.typing import NDArray


def decimate(x: NDArray, y: NDArray, points: int = 1500) -> tuple[NDArray, NDArray]:
    """Thin a course to about `points` while every peak stays: lowest and highest value of each bucket.

    Parameters
    ----------
    x, y : ndarray of shape (n,)
        NaN in `y` is a gap and stays one where a whole bucket is NaN.
    points : int, default=1500

    Returns
    -------
    x, y : ndarray of shape (m,)
        m is at most `points`, or n where that is less.
    """
    n = len(x)
    if n <= points:
        return x, y
    size = -(-n // (points // 2))
    whole = n // size * size
    blocks = y[:whole].reshape(-1, size)
    start = np.arange(0, whole, size)
    low = start + np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high = start + np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    rows = np.sort(np.concatenate([low, high, [n - 1]]))
    return x[rows], y[rows]
