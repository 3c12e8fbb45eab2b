# SPDX-License-Identifier: BSD-3-Clause
"""Products with kernel matrices that are never stored: block by block, on some threads."""

from functools import partial

import numpy as np

from sklvalve.lssvm.threads import Turns

# numbers of one block: they stay within the processor's own memory from one step to the next
_BLOCK = 2**17
_ROWS = 256


class KernelBlocks:
    """Blocks of the kernel matrix between the rows of two arrays.

    Parameters
    ----------
    between : callable
        Of `kernels.kernel_between`.
    A, B : ndarray of shape (n, d) and (m, d)
        With the gaussian kernel their squares are taken once, for all blocks.
    """

    def __init__(self, between, A, B):
        self._between, self._A, self._B = between, A, B
        self._gaussian = isinstance(between, partial) and between.func.__name__ == "_rbf"
        if self._gaussian:
            gamma = between.keywords["gamma"]
            gamma = 1.0 / A.shape[1] if gamma is None else gamma
            self._A, self._B = _with_squares(A, gamma, True), _with_squares(B, gamma, False)

    def __call__(self, rows, columns):
        if not self._gaussian:
            return self._between(self._A[rows], self._B[columns])
        values = self._A[rows] @ self._B[columns].T
        # rounding leaves squared distances of equal rows a little below zero
        np.minimum(values, 0.0, out=values)
        return np.exp(values, out=values)


def _with_squares(X, gamma, first):
    """Columns by which the exponent of a gaussian is one product."""
    squares = -gamma * np.einsum("ij,ij->i", X, X)
    ones = np.ones(len(X))
    if first:
        return np.column_stack([2.0 * gamma * X, squares, ones])
    return np.column_stack([X, ones, squares])


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
            own[rows] += block @ weights[columns]
            if i != j:
                own[columns] += block.T @ weights[rows]

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
                total = total + blocks(rows, columns) @ weights[columns]
            out[rows] = total

    run(work)
    return out
