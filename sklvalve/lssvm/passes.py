# SPDX-License-Identifier: BSD-3-Clause
"""Passes over rows that are too many to be held as kernel values: what landmarks need to know of them.

A pass gives sums over all rows, so it may be made block by block, and each block wherever it lies.
"""

import numpy as np

from sklvalve.lssvm.cells import Cells
from sklvalve.lssvm.products import KernelBlocks
from sklvalve.lssvm.threads import Turns

_BLOCK = 2**17
# parts of a sample are thinned together when there are so many of them
_PARTS = 16


class Passes:
    """Passes over blocks of rows that this process can read.

    Parameters
    ----------
    between : callable
        ``between(A, B)`` is the kernel matrix of the rows of two arrays.
    blocks : iterable
        Each time it is iterated over it gives the same blocks ``(X, y, weight)``, arrays of shape (k, d),
        (k, n_targets) and (k,).
    """

    def __init__(self, between, blocks):
        self._between, self._blocks = between, blocks

    def looked_at(self, *, most, length, most_cells, random_state):
        """Some rows drawn from all, the sum of the weights, and a coarse copy, from one pass.

        Parameters
        ----------
        most : int
            Rows to be drawn.
        length : float or None
            In which the kernel falls; None where no copy is wanted.
        most_cells : int
            Of the copy.
        random_state : RandomState

        Returns
        -------
        sample : tuple
            X, y and weight of the rows drawn.
        n : float
            Sum of the weights.
        copy : tuple or None
            X, y and weight of weighted means.
        """
        cells, drawn, n = None if length is None else Cells(length, most_cells), [], 0.0
        for X, y, weight in self._blocks:
            if cells is not None:
                cells.add(X, y, weight)
            n += weight.sum()
            drawn.append(_thinned(X, y, weight, random_state.uniform(size=len(X)), most))
            if len(drawn) > _PARTS:
                drawn = [_lowest(drawn, most)]
        X, y, weight, _ = _lowest(drawn, most)
        return (X, y, weight), n, None if cells is None else cells.result()

    def sums(self, run, landmarks, alpha, b, *, with_targets):
        """Kernel values and ones, times weight times what is left: target, or nothing, less function.

        Parameters
        ----------
        run : callable
            Of `threads.own_threads`.
        landmarks : ndarray of shape (m, d)
        alpha : ndarray of shape (m, n_targets)
        b : ndarray of shape (n_targets,)
        with_targets : bool

        Returns
        -------
        sums : ndarray of shape (m + 1, n_targets)
        """
        total = np.zeros((len(alpha) + 1, alpha.shape[1]))
        for X, y, weight in self._blocks:
            left = y if with_targets else None
            total += sums_of_block(run, self._between, landmarks, alpha, b, X, left, weight)
        return total


def sums_of_block(run, between, landmarks, alpha, b, X, y, weight):
    """`Passes.sums` of one block; without targets where y is None."""
    m = len(alpha)
    blocks = KernelBlocks(between, X, landmarks)
    step = max(32, _BLOCK // m)
    turns = Turns([slice(start, start + step) for start in range(0, len(X), step)])
    parts = [np.zeros((m + 1, alpha.shape[1])) for _ in range(run.many)]

    def work(k):
        own = parts[k]
        for rows in turns:
            values = blocks(rows, slice(None))
            left = -(values @ alpha) - b
            if y is not None:
                left += y[rows]
            left *= weight[rows, None]
            own[:-1] += values.T @ left
            own[-1] += left.sum(axis=0)

    run(work)
    return np.sum(parts, axis=0)


def _thinned(X, y, weight, chance, most):
    """Of rows with random numbers those with the lowest."""
    kept = np.argpartition(chance, most - 1)[:most] if len(chance) > most else slice(None)
    return X[kept], y[kept], weight[kept], chance[kept]


def _lowest(parts, most):
    """A sample of all the rows of some samples."""
    return _thinned(*(np.concatenate(column) for column in zip(*parts, strict=True)), most)
