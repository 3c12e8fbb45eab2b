# SPDX-License-Identifier: BSD-3-Clause
"""Errors of an LS-SVM on rows that it is not fitted to, all from one inverse."""

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.linalg.lapack import dpotri, dtrtri

from sklvalve.lssvm.kernels import kernel_between, lower_gram
from sklvalve.lssvm.solvers import cholesky, cholesky_solve, right_sides, with_bias


class HeldOutErrors:
    r"""Errors on rows that are held out.

    Parameters
    ----------
    inverse : object
        Of :math:`H = K + \mathrm{diag}(1 / (C w))`: ``inverse @ right``, ``inverse.diagonal()`` and
        ``inverse.block(rows)``, as `DenseInverse` has them.
    n : int
        Rows.
    bias : {"free", "regularized", "none"}, default="free"
    blocks : sequence of (ndarray of int, ndarray of int), default=None
        Rows to err on, and the rows that are held out with them, the former among these; each row by itself
        unless given.

    Notes
    -----
    With

    .. math:: P = H^{-1} - \frac{H^{-1} 1 1^T H^{-1}}{q + 1^T H^{-1} 1}, \quad \alpha = P y

    with q = 0 for a free bias and 1 for a regularized one (and without the second term for none), a machine
    that is fitted without the rows B errs there by :math:`P_{BB}^{-1} \alpha_B`, exactly. P does not depend
    on the targets, so further targets cost next to nothing.

    References
    ----------
    .. [1] Cawley, G. C., N. L. C. Talbot, Fast exact leave-one-out cross-validation of sparse least-squares
       support vector machines, Neural Networks 17 (2004) 1467.
    """

    def __init__(self, inverse, n, *, bias="free", blocks=None):
        self._inverse, self._free = inverse, bias == "free"
        self._ones = inverse @ np.ones((n, 1))
        self._size = self._ones.sum() + {"free": 0.0, "regularized": 1.0, "none": np.inf}[bias]
        self._diagonal, self._blocks = None, None
        if blocks is None:
            self._diagonal = inverse.diagonal() - self._ones[:, 0] ** 2 / self._size
        else:
            self._blocks = [self._factored(*block, n) for block in checked_blocks(blocks, n)]

    def __call__(self, y):
        """Errors, target less prediction.

        Parameters
        ----------
        y : ndarray of shape (n,) or (n, n_targets)

        Returns
        -------
        errors : ndarray of the shape of y
            NaN in rows that belong to no block.
        """
        targets = y.reshape(len(y), -1)
        # digits of an offset that the bias takes up are digits lost
        targets = targets - targets.mean(axis=0) if self._free else targets
        alpha = self._inverse @ targets
        alpha -= self._ones * (alpha.sum(axis=0) / self._size)
        if self._blocks is None:
            return (alpha / self._diagonal[:, None]).reshape(y.shape)
        errors = np.full(alpha.shape, np.nan)
        for rows, out, own, factor in self._blocks:
            errors[rows] = lu_solve(factor, alpha[out], check_finite=False)[own]
        return errors.reshape(y.shape)

    def _factored(self, rows, out, n):
        place = np.full(n, -1)
        place[out] = np.arange(len(out))
        part = self._inverse.block(out) - self._ones[out] @ self._ones[out].T / self._size
        return rows, out, place[rows], lu_factor(part, check_finite=False)


def checked_blocks(blocks, n):
    """Blocks as they came; a ValueError where one leaves nothing at all to fit."""
    for _, out in blocks or ():
        # such a block's matrix has a rank of one less than its size
        if len(out) >= n - 1:
            raise ValueError("a block that is left out with its gap leaves no row to fit; use more blocks")
    return blocks


class DenseInverse:
    """Inverse of a symmetric positive definite matrix, by its factor; no more is made than is asked for.

    Parameters
    ----------
    matrix : ndarray of shape (n, n), Fortran order
        Its lower triangle is read; it is spoilt.
    scale : ndarray of shape (n,), default=None
        What rows and columns of the inverse are multiplied by.

    Raises
    ------
    ValueError
        If it is not positive definite.
    """

    def __init__(self, matrix, scale=None):
        if not cholesky(matrix):
            raise ValueError("the matrix is not positive definite")
        self._factor, self._values = matrix, None
        self._scale = np.ones(len(matrix)) if scale is None else scale

    def __matmul__(self, right):
        scale = self._scale[:, None]
        return scale * cholesky_solve(self._factor, scale * right)

    def diagonal(self):
        """Diagonal, of shape (n,)."""
        # half of what the whole inverse costs; above its diagonal the factor holds anything
        inner, _ = dtrtri(self._factor, lower=1)
        squares = [inner[j:, j] @ inner[j:, j] for j in range(len(inner))]
        return self._scale**2 * np.array(squares)

    def block(self, rows):
        """Its part between some rows."""
        if self._values is None:
            self._values = np.tril(dpotri(self._factor, lower=1)[0])
            self._values += np.tril(self._values, -1).T
        return self._scale[rows, None] * self._values[np.ix_(rows, rows)] * self._scale[rows]


def blocked_errors(X, *, C, gamma, blocks, gap=0, kernel="rbf"):
    """Errors on blocks of neighbouring rows, of a machine with a free bias.

    Parameters
    ----------
    X : ndarray of shape (n, d)
        A few thousand rows at most: an n by n matrix is inverted.
    C, gamma : float
        As in :class:`~sklvalve.lssvm.LSSVMRegressor`.
    blocks : sequence of slice
        Rows that count as held out together.
    gap : int, default=0
        Rows on either side of a block that are left out with it and do not count.
    kernel : str or callable, default="rbf"

    Returns
    -------
    errors : HeldOutErrors

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.lssvm.held_out import blocked_errors
    >>> X = np.linspace(0.0, 3.0, 40)[:, None]
    >>> errors = blocked_errors(X, C=100.0, gamma=1.0, blocks=[slice(0, 20), slice(20, 40)])
    >>> errors(np.sin(X[:, 0])).shape
    (40,)
    """
    n = len(X)
    gram = lower_gram(kernel_between(kernel, gamma=gamma), X)
    gram[np.diag_indices(n)] += 1.0 / C
    rows = [
        (np.arange(block.start, block.stop), np.arange(max(block.start - gap, 0), min(block.stop + gap, n)))
        for block in blocks
    ]
    return HeldOutErrors(DenseInverse(gram), n, blocks=rows)


def least_in_error(X, y, *, gammas, Cs, blocks, kernel="rbf"):
    """Kernel scale and weight of the errors by which blocks of neighbouring rows are predicted best.

    Parameters
    ----------
    X : ndarray of shape (n, d)
        A few thousand rows at most.
    y : ndarray of shape (n,)
    gammas, Cs : sequence of float
        As in :class:`~sklvalve.lssvm.LSSVMRegressor`; every pair of them is tried.
    blocks : sequence of slice
        Rows that count as held out together.
    kernel : str or callable, default="rbf"

    Returns
    -------
    gamma, C : float
        The pair with the least sum of squared errors; of equal ones the first.

    Notes
    -----
    One machine is fitted for each block, and a pair is given up with the first block that makes it worse than
    another one: of a few pairs that costs a third of what `blocked_errors` does for all of them.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.lssvm.held_out import least_in_error
    >>> X = np.linspace(0.0, 3.0, 40)[:, None]
    >>> blocks = [slice(k, k + 10) for k in range(0, 40, 10)]
    >>> least_in_error(X, np.sin(X[:, 0]), gammas=(0.1, 100.0), Cs=(1000.0,), blocks=blocks)
    (0.1, 1000.0)
    """
    best, least = (gammas[0], Cs[0]), np.inf
    for gamma in gammas:
        gram = kernel_between(kernel, gamma=gamma)(X, X)
        for C in Cs:
            total = 0.0
            for block in blocks:
                total += float(np.sum(_errors_of(gram, y, C, block) ** 2))
                if not total < least:
                    break
            else:
                best, least = (gamma, C), total
    return best


def _errors_of(gram, y, C, block):
    """Errors on a block of rows of a machine with a free bias that is fitted to the others."""
    rest = np.delete(np.arange(len(y)), block)
    ridge = np.full(len(rest), 1.0 / C)
    # of a symmetric matrix the transpose is the same, and in the order that the factorisation wants
    matrix = gram[np.ix_(rest, rest)].T
    matrix[np.diag_indices(len(rest))] += ridge
    if not cholesky(matrix):
        raise ValueError("the matrix is not positive definite")
    shift, right = right_sides(y[rest, None], ridge, "free")
    solution = cholesky_solve(matrix, right)
    alpha, b = with_bias(solution[:, :-1], solution[:, -1:], "free")
    return y[block] - (gram[block][:, rest] @ alpha)[:, 0] - b - shift
