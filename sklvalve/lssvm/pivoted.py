# SPDX-License-Identifier: BSD-3-Clause
"""A kernel matrix as a product of few columns, found by randomly pivoted Cholesky."""

import numpy as np
from scipy.linalg import solve_triangular

from sklvalve.lssvm.solvers import raise_unless_finite
from sklvalve.lssvm.threads import Turns, own_threads

_BLOCK = 128
# a pivot whose own column is explained to this share by those before it brings rounding only
_SPENT = 1e-15


def pivoted_cholesky(between, X, diagonal, *, rank, left, random_state, n_jobs=None):
    r"""Columns F of a low rank with K close to F F^T, from few rows of the kernel matrix K.

    Parameters
    ----------
    between : callable
        ``between(A, B)`` is the kernel matrix of the rows of two arrays.
    X : ndarray of shape (n, d)
    diagonal : ndarray of shape (n,)
        Of K.
    rank : int
        Most columns.
    left : float
        Trace of K - F F^T from which on no more columns are sought.
    random_state : RandomState
    n_jobs : int, default=None

    Returns
    -------
    F : ndarray of shape (n, r), Fortran order
    pivots : ndarray of shape (r,), int
        Rows that were chosen.
    rest : float
        Trace of K - F F^T, which is positive semidefinite.

    Notes
    -----
    A row is drawn with the chance of what its diagonal still lacks. Many are drawn at once; within those each
    is kept with the chance that it would have had one at a time (accelerated randomly pivoted Cholesky).

    References
    ----------
    .. [1] Chen, Y., E. N. Epperly, J. A. Tropp, R. J. Webber, Randomly pivoted Cholesky, Comm. Pure Appl.
       Math. (2025), arXiv 2207.06503.
    .. [2] Epperly, E. N., J. A. Tropp, R. J. Webber, Embrace rejection: kernel matrix approximation by
       accelerated randomly pivoted Cholesky, arXiv 2410.03969.
    """
    raise_unless_finite(diagonal)
    if (diagonal < 0.0).any():
        raise ValueError(
            "The kernel of a row with itself is negative: it is no kernel; use solver='cholesky'."
        )
    n = len(X)
    rank = min(rank, n)
    F = np.empty((n, rank), order="F")
    lacks = np.array(diagonal, dtype=np.float64)
    first, pivots, total = lacks.copy(), [], float(lacks.sum())
    with own_threads(n_jobs) as run:
        k = 0
        while k < rank and lacks.sum() > max(left, _SPENT * total):
            drawn = random_state.choice(n, size=min(_BLOCK, n), p=lacks / lacks.sum())
            chosen, triangle = _kept(between, X, F[:, :k], lacks, drawn, random_state)
            chosen, triangle = chosen[: rank - k], triangle[: rank - k, : rank - k]
            if not len(chosen):
                # what these rows lack is rounding
                lacks[drawn] = 0.0
                continue
            new = slice(k, k + len(chosen))
            _fill(run, between, X, F, new, chosen, triangle)
            lacks -= np.einsum("ij,ij->i", F[:, new], F[:, new])
            lacks[chosen] = 0.0
            np.maximum(lacks, 0.0, out=lacks)
            lacks[lacks < _SPENT * first] = 0.0
            pivots.extend(chosen)
            k = new.stop
    return F[:, :k], np.array(pivots, dtype=int), float(lacks.sum())


def _kept(between, X, F, lacks, drawn, random_state):
    """Of rows drawn at once those that would have been drawn one at a time, and the factor of their rest."""
    rest = between(X[drawn], X[drawn]) - F[drawn] @ F[drawn].T
    lacking = rest.diagonal().copy()
    # two draws of one row leave nothing to the second
    least = np.maximum(random_state.uniform(size=len(drawn)) * lacking, 1e-10 * lacks[drawn])
    chosen, columns, i = [], np.zeros((len(drawn), len(drawn))), 0
    while (kept := lacking[i:] > least[i:]).any():
        i, done = i + int(kept.argmax()), len(chosen)
        columns[:, done] = (rest[:, i] - columns[:, :done] @ columns[i, :done]) / np.sqrt(lacking[i])
        lacking -= columns[:, done] ** 2
        chosen.append(i)
        i += 1
    triangle = np.tril(columns[np.ix_(chosen, range(len(chosen)))])
    return drawn[chosen], triangle


def _fill(run, between, X, F, new, chosen, triangle):
    """Columns of the chosen rows: what those before lack of them, divided by the factor of their own rest."""
    n, k = len(X), new.start
    of_chosen = F[chosen, :k].copy()
    step = max(256, 2**20 // (k + len(chosen) + 1))
    turns = Turns([slice(start, min(start + step, n)) for start in range(0, n, step)])

    def work(_):
        for rows in turns:
            block = between(X[rows], X[chosen])
            if k:
                block -= F[rows, :k] @ of_chosen.T
            F[rows, new] = solve_triangular(triangle, block.T, lower=True, check_finite=False).T

    run(work)
