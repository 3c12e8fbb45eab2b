# SPDX-License-Identifier: BSD-3-Clause
"""The equations of an LS-SVM with more rows than one call of LAPACK is good for."""

import warnings

import numpy as np
from scipy.linalg import LinAlgWarning

from sklvalve.lssvm.conjugate import LowRankPreconditioner, conjugate_gradients
from sklvalve.lssvm.packed import PackedCholesky
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.products import symmetric_product
from sklvalve.lssvm.solvers import Dual, raise_unless_finite, relative, right_sides, with_bias
from sklvalve.lssvm.threads import own_threads

# columns of the preconditioner: beyond them they cost more than they save
_RANK, _ROWS_A_COLUMN, _LEAST_RANK = 2000, 8, 256
_REFINEMENTS = 3
# of the tolerance, at which conjugate gradients stop: what is left of the targets' equations and, times a
# bias hardly larger than the largest target, of those of the ones may add up
_OF_TOL = 0.5


def solve_tiled(blocks, y, ridge, *, bias, tol, n_jobs=None):
    """By a Cholesky factor in tiles, refined until the equations are met.

    Parameters
    ----------
    blocks : callable
        ``blocks(rows, columns)`` gives a part of the kernel matrix, two slices, as a new array.
    y : ndarray of shape (n, n_targets)
    ridge : ndarray of shape (n,)
    bias : {"free", "regularized", "none"}
    tol : float
        Of `Dual.residual`; above it steps of refinement are taken.
    n_jobs : int, default=None

    Returns
    -------
    dual : Dual or None
        None where the matrix is not positive definite.

    Warns
    -----
    scipy.linalg.LinAlgWarning
        If the equations are met poorly.
    """
    n = len(y)

    def with_ridge(rows, columns):
        block = blocks(rows, columns)
        if rows == columns:
            block[np.diag_indices_from(block)] += ridge[rows]
        return block

    factor = PackedCholesky(with_ridge, n, n_jobs=n_jobs)
    if not factor.positive_definite:
        return None
    shift, right = right_sides(y, ridge, bias)
    x = factor.solve(right)
    raise_unless_finite(x)
    with own_threads(n_jobs) as run:
        left = right - symmetric_product(run, blocks, n, x) - ridge[:, None] * x
        dual = _dual(x, left, right, shift, bias)
        for _ in range(_REFINEMENTS):
            if dual.residual <= tol:
                break
            x = x + factor.solve(left)
            left = right - symmetric_product(run, blocks, n, x) - ridge[:, None] * x
            better = _dual(x, left, right, shift, bias)
            if not better.residual < dual.residual:
                break
            dual = better
    if dual.residual > tol:
        warn_of_residual(dual.residual)
    return dual


def solve_pcg(
    between,
    blocks,
    X,
    diagonal,
    y,
    ridge,
    *,
    bias,
    tol,
    max_iter,
    rank,
    random_state,
    n_jobs=None,
    patient=True,
):
    """By conjugate gradients on the whole kernel matrix, helped by a low rank of it.

    Parameters
    ----------
    between, blocks : callable
        Kernel matrix of the rows of two arrays, and of two slices of the rows of the fit.
    X : ndarray of shape (n, d)
    diagonal : ndarray of shape (n,)
        Of the kernel matrix.
    y, ridge, bias, tol, n_jobs
        As in `solve_tiled`.
    max_iter : int
    rank : int
        Most columns of the low rank.
    random_state : RandomState
    patient : bool, default=True
        Of `conjugate_gradients`.

    Returns
    -------
    dual : Dual
        Whether it is good enough `Dual.residual` says.
    """
    n = len(y)
    shift, right = right_sides(y, ridge, bias)
    # where less is left than the ridge itself holds, the first step is nearly the last
    more = {"left": float(ridge.min()), "random_state": random_state, "n_jobs": n_jobs}
    F, _, _ = pivoted_cholesky(between, X, diagonal, rank=min(rank, rank_for(n)), **more)
    precondition = LowRankPreconditioner(F, ridge)
    with own_threads(n_jobs) as run:

        def apply(v):
            return symmetric_product(run, blocks, n, v) + ridge[:, None] * v

        solved = conjugate_gradients(
            apply, precondition, right, tol=_OF_TOL * tol, max_iter=max_iter, patient=patient
        )
    raise_unless_finite(solved.x)
    dual = _dual(solved.x, solved.residual, right, shift, bias)
    dual.n_iter = solved.n_iter
    return dual


def rank_for(n):
    """Columns of a preconditioner for n rows, where memory does not bound them."""
    return min(n, max(_LEAST_RANK, min(_RANK, n // _ROWS_A_COLUMN)))


def warn_of_residual(residual):
    """Tell that the equations are met poorly."""
    warnings.warn(
        f"The LS-SVM equations are met only to {residual:.1e} of the target: lower C, make the kernel "
        "smoother, or merge repeated rows into one with their weight.",
        LinAlgWarning,
        stacklevel=4,
    )


def _dual(x, left, right, shift, bias):
    alpha, b = with_bias(x[:, :-1], x[:, -1:], bias)
    # the bias is a combination of both solutions, and so is what is left of the equations
    of_all = left[:, :-1] - b * left[:, -1:]
    return Dual(alpha, b + shift, relative(of_all, right[:, :-1]))
