# SPDX-License-Identifier: BSD-3-Clause
"""Signals without their gaps."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def filled(values: ArrayLike) -> NDArray[np.float64]:
    """Values with gaps bridged by straight lines; zero where nothing is known.

    Parameters
    ----------
    values : array-like of shape (n,)
    """
    values = np.asarray(values, dtype=float)
    known = np.flatnonzero(np.isfinite(values))
    return np.interp(np.arange(len(values)), known, values[known]) if len(known) else np.zeros(len(values))
