# SPDX-License-Identifier: BSD-3-Clause
r"""How far an LS-SVM may be from new targets: standard deviations, and intervals by what it erred.

An LS-SVM is the mean of a gaussian process with covariance :math:`C \sigma^2 k` and noise
:math:`\sigma^2 / w`. On landmarks, with z of `nystrom.inward` and B the matrix of their equations, a new row
differs from it with the variance

.. math:: \sigma^2 v(x), \quad v(x) = 1 + \tilde z^T B^{-1} \tilde z + C (k(x, x) - |z|^2) ,

the last term being what the landmarks do not span. Where they are all rows, it is exact.
"""

import numpy as np
from scipy.linalg import solve_triangular

from sklvalve.lssvm.kernels import kernel_diagonal
from sklvalve.lssvm.nystrom import inward, normal_equations, penalized, penalty_of, row_spans
from sklvalve.lssvm.solvers import factor_of
from sklvalve.lssvm.threads import own_threads

# a row whose own equation says all leaves no error to be told
_LEAST = 1e-12


def fit_spread(blocks, between, landmarks, function, *, C, bias, n_jobs=None):
    r"""What is needed to tell the spread of predictions.

    Parameters
    ----------
    blocks : iterable
        Of X, y and weight, in the coordinates of the kernel; read twice.
    between : callable
    landmarks : ndarray of shape (m, d)
    function : callable
        The fitted function of such an X, of shape (k, n_targets).
    C : float
    bias : {"free", "regularized", "none"}
    n_jobs : int, default=None

    Returns
    -------
    spread : dict of ndarray
        ``landmarks``, ``L`` and ``B``, lower factors, ``sigma`` of shape (n_targets,), ``scaled``, the sorted
        sizes of the errors on rows left out over :math:`\sqrt{v}`, of shape (n, n_targets).
    errors : ndarray of shape (n, n_targets)
        Target less prediction of each row by a machine that has not seen it; NaN without weight.

    Notes
    -----
    With the leverage :math:`h_i = w_i \tilde z_i^T B^{-1} \tilde z_i` a machine without row i errs by
    :math:`e_i / (1 - h_i)` there, as far as C leaves digits of :math:`1 - h_i` (to 1e-8 at C = 1e6, and not
    at all at 1e12), and its variance there is
    :math:`\sigma^2 (1 / (w_i (1 - h_i)) + C (k(x_i, x_i) - |z_i|^2))`; :math:`\sigma^2` is the mean of the
    squared errors over these.
    """
    L = factor_of(between(landmarks, landmarks))
    matrix, right = 0.0, 0.0
    with own_threads(n_jobs) as run:
        for X, y, weight in blocks:
            more = normal_equations(run, between, landmarks, L, X, y, weight)
            matrix, right = matrix + more[0], right + more[1]
    B = penalized(matrix, right, penalty_of(len(L), C, bias), bias)[0]
    spread = {"landmarks": landmarks, "L": L, "B": B}
    errors, scaled = [], []
    for X, y, weight in blocks:
        left, size = np.full(y.shape, np.nan), np.full(len(y), np.nan)
        known = weight > 0.0
        reach, lack = _reach(spread, between, X[known], bias)
        rest = 1.0 - weight[known] * reach
        # a row that alone says all about itself leaves nothing to compare with
        rest[rest <= _LEAST] = np.nan
        left[known] = (y[known] - function(X[known])) / rest[:, None]
        size[known] = 1.0 / (weight[known] * rest) + C * lack
        errors.append(left)
        scaled.append(left / np.sqrt(size)[:, None])
    scaled = np.concatenate(scaled)
    scaled = np.sort(np.abs(scaled[np.isfinite(scaled[:, 0])]), axis=0)
    sigma = np.sqrt(np.mean(scaled**2, axis=0)) if len(scaled) else np.full(scaled.shape[1], np.inf)
    spread |= {"sigma": sigma, "scaled": scaled}
    return spread, np.concatenate(errors)


def root_v(spread, between, X, *, C, bias):
    """Square root of v(x) of rows in the coordinates of the kernel, of shape (n,)."""
    reach, lack = _reach(spread, between, X, bias)
    return np.sqrt(1.0 + reach + C * lack)


def quantile(spread, coverage):
    """Errors over root v that so large a share of new rows will not exceed, of shape (n_targets,).

    Infinite where there are too few rows to say so.
    """
    scaled = spread["scaled"]
    rank = int(np.ceil((len(scaled) + 1) * coverage))
    return scaled[rank - 1] if rank <= len(scaled) else np.full(scaled.shape[1], np.inf)


def _reach(spread, between, X, bias):
    """Of some rows z^T B^-1 z, and what the landmarks do not span of k(x, x)."""
    reach, lack = np.zeros(len(X)), kernel_diagonal(between, X) if len(X) else np.zeros(0)
    for rows in row_spans(len(X), len(spread["L"])):
        z = inward(between, spread["landmarks"], spread["L"], X[rows])
        lack[rows] -= np.einsum("ij,ij->j", z[:-1], z[:-1])
        if bias == "none":
            z[-1] = 0.0
        through = solve_triangular(spread["B"], z, lower=True, check_finite=False)
        reach[rows] = np.einsum("ij,ij->j", through, through)
    return reach, np.maximum(lack, 0.0)
