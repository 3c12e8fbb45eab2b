# SPDX-License-Identifier: BSD-3-Clause
"""Parts of which the solutions of an LS-SVM are made: factors, right sides, the bias.

Pure functions of arrays. Matrices to be factored are lower triangles in Fortran order; what stands above the
diagonal is never read.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrf

# Threaded LAPACK Cholesky of some OpenBLAS builds ends the process from about 16,000 rows, so a larger
# matrix is factored in tiles, of which LAPACK sees one at a time.
LAPACK_ROWS = 8000
TILE = 2048
# what is added to the diagonal of a semidefinite matrix, of its mean: the least that lets it be factored
JITTERS = (1e-14, 1e-12, 1e-10, 1e-8)


@dataclass
class Dual:
    """Solution of the equations of an LS-SVM.

    Attributes
    ----------
    alpha : ndarray of shape (n, n_targets)
    b : ndarray of shape (n_targets,)
    residual : float or None
        Largest :math:`|f(x_i) + \\alpha_i / (C w_i) - y_i|`, relative to the largest target less its mean;
        None where nothing gave reason to look.
    n_iter : int
        Steps; 0 of a factorisation.
    told : bool
        Whether a warning has said that the equations are not met.
    """

    alpha: np.ndarray
    b: np.ndarray
    residual: float | None = None
    n_iter: int = 0
    told: bool = False


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


def factor_of(own, jitters=JITTERS):
    """Lower factor of a matrix that is positive semidefinite but for rounding; it is spoilt."""
    if not len(own):
        return own
    diagonal = np.einsum("ii->i", own)
    # of a kernel that is zero everywhere any size will do
    plain, size = diagonal.copy(), float(diagonal.mean()) or 1.0
    for jitter in jitters:
        diagonal[:] = plain + jitter * size
        factor, failed = dpotrf(own, lower=1, clean=1)
        if not failed and np.isfinite(factor).all():
            return factor
    raise ValueError(
        "A part of the kernel matrix is not positive semidefinite: it is no kernel; use one that is, or "
        "solver='cholesky'."
    )


def right_sides(y, ridge, bias):
    """Offset that a free bias takes up, and the targets without it beside a column of ones."""
    # without the offset digits are left for the rest
    shift = np.average(y, axis=0, weights=ridge.min() / ridge) if bias == "free" else np.zeros(y.shape[1])
    return shift, np.column_stack([y - shift, np.ones(len(y))])


def with_bias(t, s, bias):
    """Dual weights and bias from the solutions for targets and for ones."""
    if bias == "none":
        return t, np.zeros(t.shape[1])
    whole = s.sum() + (bias == "regularized")
    # nothing at all, where nothing better was found, has no bias
    b = t.sum(axis=0) / whole if whole else np.zeros(t.shape[1])
    return t - s * b, b


def relative(left, right):
    """Largest of what is left of some equations, against the largest of their right sides.

    Parameters
    ----------
    left : ndarray of shape (k, m)
    right : ndarray of shape (n, m)

    Returns
    -------
    worst : float
        Infinite where something overflowed.
    """
    worst = (np.abs(left) / np.maximum(np.abs(right).max(axis=0), np.finfo(float).tiny)).max()
    return float(worst) if np.isfinite(worst) else np.inf


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
