# SPDX-License-Identifier: BSD-3-Clause
"""The linear algebra of the LS-SVM: one factorisation gives the dual weights and the bias.

Pure functions of arrays. All matrices are lower triangles in Fortran order; what stands above the diagonal is
never read.
"""

import warnings

import numpy as np
from scipy.linalg import LinAlgWarning, eigh
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrf

# Threaded LAPACK Cholesky of some OpenBLAS builds ends the process from about 16,000 rows, so a larger
# matrix is factored in tiles, of which LAPACK sees one at a time.
LAPACK_ROWS = 8000
TILE = 2048

# Beyond this ratio the solution is checked against the equations and refined.
ILL_CONDITIONED = 1e10
# Equations met worse than this, relative to the target, are worth a warning, ...
POORLY_MET = 1e-6
# ... and worse than this least squares, which takes some twenty times as long as the factorisation.
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
    alpha : ndarray of shape (n, n_targets)
    b : ndarray of shape (n_targets,)

    Raises
    ------
    ValueError
        If the kernel matrix or the solution is not finite.

    Warns
    -----
    scipy.linalg.LinAlgWarning
        If the matrix is not positive definite or the equations are not met, so that the least-squares
        solution is taken; and if they are met poorly.

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
    matrix = gram()
    _add_to_diagonal(matrix, ridge)
    solution, trouble = _by_cholesky(matrix, right, lambda v: product(v) + ridge[:, None] * v)
    if trouble is None:
        alpha, b = with_bias(solution[:, :-1], solution[:, -1:], bias)
    else:
        warnings.warn(
            f"{trouble}. The least-squares solution was taken, which is slower; {_MEND}.",
            LinAlgWarning,
            stacklevel=4,
        )
        del matrix, solution  # of a large problem, room for the eigenvectors
        matrix = gram()
        _add_to_diagonal(matrix, ridge)
        alpha, b = least_squares(matrix, right[:, :-1], bias=bias)
    b = b + shift
    raise_unless_finite(alpha, b)
    return alpha, b


def cholesky(matrix, *, tile=None):
    """Factor a symmetric positive definite matrix in place, lower triangle, in tiles.

    Parameters
    ----------
    matrix : ndarray of shape (n, n), Fortran order
        Its lower triangle is replaced by the factor L of matrix = L L^T.
    tile : int, default=None
        Rows of a tile; None takes the whole matrix as one tile as long as that is safe.

    Returns
    -------
    positive_definite : bool
        If False, the content of `matrix` is spoilt.

    Notes
    -----
    Left-looking: each tile is brought up to date with everything on its left by matrix products just before
    it is needed, so that the one LAPACK call sees a tile only.

    Examples
    --------
    >>> import numpy as np
    >>> matrix = np.array([[4.0, 0.0], [2.0, 5.0]], order="F")
    >>> cholesky(matrix)
    True
    >>> matrix
    array([[2., 0.],
           [1., 2.]])
    """
    tiles = _tiles(len(matrix), tile)
    for k, column in enumerate(tiles):
        done = slice(0, column.start)
        for row in tiles[k:]:
            if k:
                matrix[row, column] -= matrix[row, done] @ matrix[column, done].T
            block = np.asfortranarray(matrix[row, column])
            if row is column:
                block, failed = dpotrf(block, lower=1, clean=0, overwrite_a=1)
                if failed:
                    return False
                diagonal = block
            else:
                block = dtrsm(1.0, diagonal, block, side=1, lower=1, trans_a=1, overwrite_b=1)
            if not np.may_share_memory(block, matrix):
                matrix[row, column] = block
    return True


def cholesky_solve(factor, right, *, tile=None):
    """Solve L L^T x = right for a factor made by :func:`cholesky`.

    Parameters
    ----------
    factor : ndarray of shape (n, n), Fortran order
        Only its lower triangle is read.
    right : ndarray of shape (n, m)
    tile : int, default=None
        As for :func:`cholesky`.

    Returns
    -------
    x : ndarray of shape (n, m)
    """
    x = np.array(right, dtype=np.float64, order="F")
    tiles = _tiles(len(factor), tile)
    for rows in tiles:
        below = slice(rows.stop, None)
        x[rows] = dtrsm(1.0, np.asfortranarray(factor[rows, rows]), x[rows], lower=1)
        x[below] -= factor[below, rows] @ x[rows]
    for rows in reversed(tiles):
        below = slice(rows.stop, None)
        x[rows] -= factor[below, rows].T @ x[below]
        x[rows] = dtrsm(1.0, np.asfortranarray(factor[rows, rows]), x[rows], lower=1, trans_a=1)
    return x


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


def right_sides(y, ridge, bias):
    """Offset that a free bias takes up, and the targets without it beside a column of ones."""
    # without the offset digits are left for the rest
    shift = np.average(y, axis=0, weights=ridge.min() / ridge) if bias == "free" else np.zeros(y.shape[1])
    return shift, np.column_stack([y - shift, np.ones(len(y))])


def with_bias(t, s, bias):
    """Dual weights and bias from the solutions for targets and for ones."""
    if bias == "none":
        return t, np.zeros(t.shape[1])
    b = t.sum(axis=0) / (s.sum() + (bias == "regularized"))
    return t - s * b, b


def _by_cholesky(matrix, right, apply):
    """Solution by the factor of `matrix`, which is spoilt, and None or what is wrong with the solution."""
    if not cholesky(matrix):
        return None, (
            "The kernel matrix plus 1/C on its diagonal is not positive definite: it is no kernel, or C is "
            "too large for it"
        )
    solution = cholesky_solve(matrix, right)
    raise_unless_finite(solution)
    if np.ptp(np.log(matrix.diagonal())) <= 0.5 * np.log(ILL_CONDITIONED):
        return solution, None
    solution, worst = _refined(solution, right, matrix, apply)
    trouble = (
        f"The LS-SVM equations are met only to {worst:.1e} of the target: C is too large for this kernel or "
        "for rows that repeat each other"
    )
    if worst > NOT_MET:  # weights of a factor that hardly was one can predict anything
        return solution, trouble
    if worst > POORLY_MET:
        warnings.warn(f"{trouble}; {_MEND}.", LinAlgWarning, stacklevel=5)
    return solution, None


def _refined(solution, right, factor, apply):
    """Solution after a few steps of iterative refinement, and its worst residual relative to the target."""
    size = np.maximum(np.abs(right).max(axis=0), np.finfo(float).tiny)
    residual = right - apply(solution)
    worst = (np.abs(residual) / size).max()
    for _ in range(3):
        better = solution + cholesky_solve(factor, residual)
        residual = right - apply(better)
        now = (np.abs(residual) / size).max()
        if not now < worst:
            break
        solution, worst = better, now
    return solution, worst


def _add_to_diagonal(matrix, ridge):
    np.einsum("ii->i", matrix)[:] += ridge


def _tiles(n, tile):
    step = tile or (n if n <= LAPACK_ROWS else TILE)
    return [slice(start, min(start + step, n)) for start in range(0, n, step)]


def raise_unless_finite(*arrays):
    """Refuse what has overflowed."""
    if not all(np.isfinite(array).all() for array in arrays):
        raise ValueError(
            "The kernel matrix or its solution is not finite: X or y is too large for this kernel; "
            "scale it, for example with StandardScaler."
        )
