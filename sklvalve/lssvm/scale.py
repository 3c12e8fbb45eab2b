# SPDX-License-Identifier: BSD-3-Clause
"""The gamma that suits the spread of the rows, from rows that may come in blocks."""

import numpy as np

from sklvalve.lssvm.rows import raise_unless_weighed
from sklvalve.lssvm.solvers import raise_unless_finite


def moments(X, weight):
    """Weight, mean and mean square about it of all numbers of some rows, which count by their weights.

    Returns
    -------
    moments : ndarray of shape (3,)
        Zeros where no row counts.
    """
    known = weight > 0.0
    X, weight = np.asarray(X[known], dtype=np.float64), weight[known]
    if not len(X):
        return np.zeros(3)
    mean = np.average(X.mean(axis=1), weights=weight)
    return np.array([weight.sum(), mean, np.average(((X - mean) ** 2).mean(axis=1), weights=weight)])


def gamma_of_scale(parts, n_features):
    """Gamma of ``gamma="scale"``: one over the number of columns times the variance of all numbers in them.

    Parameters
    ----------
    parts : iterable of ndarray of shape (3,)
        `moments` of the blocks of rows.
    n_features : int

    Returns
    -------
    gamma : float
        1 where all numbers are the same, as in :class:`sklearn.svm.SVR`.

    Raises
    ------
    ValueError
        If the variance overflows.
    """
    parts = np.stack(list(parts))
    raise_unless_weighed(parts[:, 0].any())
    share = parts[:, 0] / parts[:, 0].sum()
    mean = share @ parts[:, 1]
    variance = share @ (parts[:, 2] + (parts[:, 1] - mean) ** 2)
    raise_unless_finite(variance)
    return float(1.0 / (n_features * variance)) if variance > 0.0 else 1.0
