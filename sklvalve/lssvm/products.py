# SPDX-License-Identifier: BSD-3-Clause
"""Products with kernel matrices that are never stored: block by block, on some threads."""

import numpy as np

from sklvalve.lssvm.kernels import gaussian_gamma, loses_digits
from sklvalve.lssvm.threads import Turns, in_this_thread

# numbers of one block: they stay within the processor's own memory from one step to the next
_BLOCK = 2**17
_ROWS = 256
# of weights; with more of them a product of matrices is quicker than one for each
_COLUMNS = 4


class KernelBlocks:
    """Blocks of the kernel matrix between the rows of two arrays.

    Parameters
    ----------
    between : callable
        Of `kernels.kernel_between`.
    A : ndarray of shape (n, d)
    B : ndarray of shape (m, d), or None
    right : ndarray, default=None
        What `as_right` made of B, in its place.
    """

    def __init__(self, between, A, B, right=None):
        self._between = between
        self._right = as_right(between, B) if right is None else right
        self._gaussian = self._right.shape[1] > A.shape[1]
        if self._gaussian:
            gamma = gaussian_gamma(between, A.shape[1])
            A = _beside(2.0 * gamma * A, -gamma * np.einsum("ij,ij->i", A, A), 1.0)
            # numpy is four times as quick with a row as with a number
            self._zeros = np.zeros(len(self._right))
        self._left = A

    def __call__(self, rows, columns):
        if not self._gaussian:
            return self._between(self._left[rows], self._right[columns])
        values = self._left[rows] @ self._right[columns].T
        # rounding leaves squared distances of equal rows a little below zero
        np.minimum(values, self._zeros[columns], out=values)
        return np.exp(values, out=values)


def as_right(between, B):
    """Rows as `KernelBlocks` wants them on its right; those of a gaussian with the squares behind them.

    So the exponent of a gaussian is one product of matrices, as long as that keeps its digits.
    """
    gamma = gaussian_gamma(between, B.shape[1])
    if gamma is None:
        return B
    exponents = gamma * np.einsum("ij,ij->i", B, B)
    if loses_digits(exponents):
        return B
    # column by column, so that a single row on the left reads them in one go
    return np.asfortranarray(_beside(B, 1.0, -exponents))


def _beside(X, *columns):
    d = X.shape[1]
    wide = np.empty((len(X), d + len(columns)))
    wide[:, :d] = X
    for k, column in enumerate(columns):
        wide[:, d + k] = column
    return wide


def times(block, weights):
    """block @ weights; by single columns where these are few, as a product of matrices copies the block."""
    if 1 < weights.shape[1] <= _COLUMNS:
        return np.column_stack([block @ column for column in weights.T])
    return block @ weights


def kernel_product(between, A, B, weights):
    """K(A, B) @ weights without ever holding K, in this thread."""
    return product(in_this_thread, KernelBlocks(between, A, B), (len(A), len(B)), weights)


def symmetric_product(run, blocks, n, weights):
    """K @ weights for the kernel matrix K of n rows with themselves; each block serves both its sides."""
    step = _ROWS * 2
    spans = [slice(start, min(start + step, n)) for start in range(0, n, step)]
    turns = Turns([(i, j) for i in range(len(spans)) for j in range(i + 1)])
    sums = [np.zeros(weights.shape) for _ in range(run.many)]

    def work(k):
        own = sums[k]
        for i, j in turns:
            rows, columns = spans[i], spans[j]
            block = blocks(rows, columns)
            own[rows] += times(block, weights[columns])
            if i != j:
                own[columns] += times(block.T, weights[rows])

    run(work)
    return np.sum(sums, axis=0) if run.many > 1 else sums[0]


def product(run, blocks, shape, weights):
    """K @ weights for a kernel matrix of a shape (n, m)."""
    n, m = shape
    out = np.empty((n, weights.shape[1]))
    step = max(1, min(n, _BLOCK // max(1, min(m, _BLOCK // _ROWS))))
    wide = max(1, _BLOCK // step)
    turns = Turns([slice(start, min(start + step, n)) for start in range(0, n, step)])

    def work(_):
        for rows in turns:
            total = 0.0
            for start in range(0, m, wide):
                columns = slice(start, min(start + wide, m))
                total = total + times(blocks(rows, columns), weights[columns])
            out[rows] = total

    run(work)
    return out


def raise_of_overflow(many):
    """Refuse predictions that are no numbers."""
    raise ValueError(
        f"The predictions of {many} rows overflow: X, or the targets of the fit, are too large for this "
        "kernel; scale them, for example with StandardScaler and TransformedTargetRegressor."
    )
