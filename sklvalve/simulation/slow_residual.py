# SPDX-License-Identifier: BSD-3-Clause
"""What a simulation leaves over slowly: means of its residual over stretches in which it moves little."""

from __future__ import annotations

import numpy as np

#: Rows of a stretch.
LENGTH = 40
# a row in which the simulated signal moves by more than this share of its span is of no slow residual
_MOVES = 0.004


def moves_little(simulated: np.ndarray, span: float) -> np.ndarray:
    """Rows in which a simulated signal moves little.

    Parameters
    ----------
    simulated : ndarray of shape (n,)
    span : float
        Of the signal, in its unit.

    Returns
    -------
    rows : ndarray of bool, shape (n,)
    """
    return np.abs(np.gradient(np.nan_to_num(simulated))) < _MOVES * span


def slow_means(values: np.ndarray, keep: np.ndarray) -> np.ndarray:
    """Means over stretches of `LENGTH` rows.

    Parameters
    ----------
    values : ndarray of shape (n,)
    keep : ndarray of bool, shape (n,)
        Rows that count.

    Returns
    -------
    means : ndarray of shape (n // 40,)
        NaN where no more than half of a stretch is kept.
    """
    table = by_stretches(np.where(keep, values, np.nan))
    count = np.isfinite(table).sum(axis=1)
    return np.where(count > 0.5 * LENGTH, np.nansum(table, axis=1) / np.maximum(count, 1), np.nan)


def by_stretches(values: np.ndarray) -> np.ndarray:
    """Rows in a table of shape (n // 40, 40); what is over at the end is left out."""
    many = len(values) // LENGTH
    return values[: many * LENGTH].reshape(many, LENGTH)
