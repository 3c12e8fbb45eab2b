# SPDX-License-Identifier: BSD-3-Clause
"""An LS-SVM by one factorisation of its whole matrix, and what to do where that does not solve it."""

import warnings

import numpy as np
from scipy.linalg import LinAlgWarning, eigh

from sklvalve.lssvm.solvers import (
    Dual,
    cholesky,
    cholesky_solve,
    raise_unless_finite,
    relative,
    right_sides,
    with_bias,
)

# Beyond this ratio the solution is checked against the equations and refined.
ILL_CONDITIONED = 1e10
# Where they are met worse than this, relative to the target, least squares is tried; it takes some twenty
# times as long as the factorisation.
NOT_MET = 1e-3
_MEND = "lower C, or merge repeated rows into one with their weight"


def solve_lssvm(gram, product, y, ridge, *, bias="free"):
    r"""Dual weights and bias of the LS-SVM.

    Parameters
    ----------
    gram : callable
        Returns a new array of shape (n, n), Fortran order, that holds the lower triangle of the kernel
        matrix K. Called a second time only if the first factorisation fails, or solves too poorly.
    product : callable
        Returns K @ v for an array v of shape (n, m). Called only where the matrix is badly conditioned.
    y : ndarray of shape (n, n_targets)
        Targets.
    ridge : ndarray of shape (n,)
        Diagonal :math:`1 / (C w_i)`, positive and finite.
    bias : {"free", "regularized", "none"}, default="free"
        See :class:`~sklvalve.lssvm.LSSVMRegressor`.

    Returns
    -------
    dual : Dual

    Raises
    ------
    ValueError
        If the kernel matrix or the solution is not finite.

    Warns
    -----
    scipy.linalg.LinAlgWarning
        If the matrix is not positive definite or the equations are not met, so that the least-squares
        solution was tried.

    Notes
    -----
    With :math:`H = K + \mathrm{diag}(r)`, :math:`t = H^{-1} y` and :math:`s = H^{-1} 1` all three biases are
    :math:`\alpha = t - b s`, where

    .. math::

        b_{free} = \frac{1^T t}{1^T s}, \quad b_{regularized} = \frac{1^T t}{1 + 1^T s}, \quad b_{none} = 0 .

    The first is equation 13 of the paper; the second is the solution of
    :math:`(K + 11^T + \mathrm{diag}(r)) \alpha = y`, :math:`b = 1^T \alpha`.
    """
    shift, right = right_sides(y, ridge, bias)

    def apply(v):
        return product(v) + ridge[:, None] * v

    def told_of(alpha, b):
        left = right[:, :-1] - apply(alpha) - b
        return Dual(alpha, b + shift, relative(left, right[:, :-1]))

    solution, conditioned = _by_cholesky(gram, right, ridge, apply)
    if solution is not None:
        alpha, b = with_bias(solution[:, :-1], solution[:, -1:], bias)
        raise_unless_finite(alpha, b)
        if conditioned:
            return Dual(alpha, b + shift)
        found = told_of(alpha, b)
        if found.residual <= NOT_MET:
            return found
    other = told_of(*least_squares(_with_ridge(gram, ridge), right[:, :-1], bias=bias))
    raise_unless_finite(other.alpha, other.b)
    if solution is None:
        trouble = (
            "The kernel matrix plus 1/C on its diagonal is not positive definite: it is no kernel, or C is "
            "too large for it"
        )
    else:
        trouble = f"The LS-SVM equations are met only to {found.residual:.1e} of the target"
        if found.residual <= other.residual:
            # weights that hardly solve their equations can predict anything, but these are the nearest
            warnings.warn(f"{trouble}; {_MEND}.", LinAlgWarning, stacklevel=4)
            found.told = True
            return found
    warnings.warn(
        f"{trouble}. The least-squares solution was taken, which is slower and meets them to "
        f"{other.residual:.1e}; {_MEND}.",
        LinAlgWarning,
        stacklevel=4,
    )
    other.told = True
    return other


def least_squares(matrix, y, *, bias="free"):
    """Shortest least-squares solution of the LS-SVM equations, for a matrix that is no proper kernel matrix.

    Parameters
    ----------
    matrix : ndarray of shape (n, n), Fortran order
        Kernel matrix with the ridge on its diagonal; only the lower triangle is read, and it is spoilt.
    y : ndarray of shape (n, n_targets)
    bias : {"free", "regularized", "none"}, default="free"

    Returns
    -------
    alpha : ndarray of shape (n, n_targets)
    b : ndarray of shape (n_targets,)

    Notes
    -----
    By eigenvalues; those within rounding of zero are left out. A free bias needs the whole bordered matrix of
    equation 11, because the vector of ones may lie outside the range of H.
    """
    matrix = np.tril(matrix)
    raise_unless_finite(matrix)
    if bias == "regularized":
        matrix += 1.0
    border = 0
    size = max(1.0, float(np.abs(matrix.diagonal()).mean()))
    if bias == "free":
        border = 1
        matrix = np.pad(matrix, ((1, 0), (1, 0)))
        matrix[1:, 0] = size
        y = np.pad(y, ((1, 0), (0, 0)))
    values, vectors = eigh(matrix, lower=True, overwrite_a=True, check_finite=False)
    kept = np.abs(values) > len(values) * np.finfo(float).eps * np.abs(values).max()
    solution = vectors[:, kept] @ ((vectors[:, kept].T @ y) / values[kept, None])
    alpha = solution[border:]
    if bias == "free":
        return alpha, size * solution[0]
    return alpha, alpha.sum(axis=0) if bias == "regularized" else np.zeros(y.shape[1])


def _by_cholesky(gram, right, ridge, apply):
    """Solution, or None where there is no factor, and whether it need not be looked at."""
    matrix = _with_ridge(gram, ridge)
    if not cholesky(matrix):
        return None, False
    solution = cholesky_solve(matrix, right)
    raise_unless_finite(solution)
    if np.ptp(np.log(matrix.diagonal())) <= 0.5 * np.log(ILL_CONDITIONED):
        return solution, True
    return _refined(solution, right, matrix, apply)[0], False


def _refined(solution, right, factor, apply):
    """Solution after a few steps of iterative refinement, and its worst residual relative to the target."""
    residual = right - apply(solution)
    worst = relative(residual, right)
    for _ in range(3):
        better = solution + cholesky_solve(factor, residual)
        residual = right - apply(better)
        now = relative(residual, right)
        if not now < worst:
            break
        solution, worst = better, now
    return solution, worst


def _with_ridge(gram, ridge):
    matrix = gram()
    np.einsum("ii->i", matrix)[:] += ridge
    return matrix
