# SPDX-License-Identifier: BSD-3-Clause
"""Cholesky factor of a kernel matrix of which the lower tiles alone are stored.

Half the memory of the square, and no call of LAPACK sees more than one tile: on some machines a threaded
factorisation of a large matrix ends the process.
"""

from threading import Event

import numpy as np
from scipy.linalg.blas import dtrsm

from sklvalve.lssvm.blas import divide_by, factor, take_off, take_off_square
from sklvalve.lssvm.threads import Turns, one_blas_thread, own_threads

TILE = 512


class PackedCholesky:
    r"""Factor L of a symmetric positive definite matrix, in tiles.

    Parameters
    ----------
    block : callable
        ``block(rows, columns)`` gives a part of the matrix, two slices, as a new array.
    n : int
        Rows of the matrix.
    tile : int, default=512
    n_jobs : int, default=None
        Threads; None is what BLAS would use.

    Attributes
    ----------
    positive_definite : bool
        Where it is False there is no factor, and `solve` must not be called.

    Notes
    -----
    Column by column, each tile is made, brought up to date with those on its left, and divided by the factor
    on the diagonal. Threads take tiles in that order and wait where they need one that is not finished yet:
    only on tiles that were taken before their own, so somebody always goes on.

    Examples
    --------
    >>> import numpy as np
    >>> matrix = np.array([[4.0, 2.0], [2.0, 5.0]])
    >>> found = PackedCholesky(lambda rows, columns: matrix[rows, columns].copy(), 2, tile=1)
    >>> found.solve(np.array([[8.0], [9.0]])).ravel()
    array([1.375, 1.25 ])
    """

    def __init__(self, block, n, *, tile=TILE, n_jobs=None):
        self.n = n
        self._spans = [slice(start, min(start + tile, n)) for start in range(0, n, tile)]
        many = len(self._spans)
        self._tiles = {}
        self._ready = {(i, j): Event() for j in range(many) for i in range(j, many)}
        self.positive_definite = True
        turns = Turns([(i, j) for j in range(many) for i in range(j, many)])

        def work(_):
            for i, j in turns:
                if not self.positive_definite:
                    return
                try:
                    self._finish(block, i, j)
                except BaseException:
                    # nobody may wait for a tile that will never come
                    self._give_up()
                    raise

        with own_threads(n_jobs) as run:
            run(work)
        del self._ready

    def _finish(self, block, i, j):
        tile = np.asfortranarray(block(self._spans[i], self._spans[j]), dtype=np.float64)
        for k in range(j):
            left, right = self._tile(i, k), self._tile(j, k)
            # routines that are given sizes alone would read past the end of what is not there
            if left is None or right is None:
                return
            if i == j:
                take_off_square(tile, left)
            else:
                take_off(tile, left, right)
        if i == j:
            if not (factor(tile) and np.isfinite(tile.diagonal()).all()):
                self._give_up()
                return
        else:
            diagonal = self._tile(j, j)
            if diagonal is None:
                return
            divide_by(tile, diagonal)
        self._tiles[i, j] = tile
        self._ready[i, j].set()

    def _tile(self, i, j):
        """A finished tile; None where it will never come."""
        self._ready[i, j].wait()
        return self._tiles.get((i, j))

    def _give_up(self):
        self.positive_definite = False
        for event in self._ready.values():
            event.set()

    def solve(self, right):
        """Solution x of L L^T x = right, of the shape (n, m) of `right`."""
        x = np.array(right, dtype=np.float64)
        many = len(self._spans)
        # a few columns are bound by memory: threads of BLAS would only wait for each other
        with one_blas_thread():
            for j in range(many):
                own = x[self._spans[j]] = dtrsm(1.0, self._tiles[j, j], x[self._spans[j]], lower=1)
                for i in range(j + 1, many):
                    x[self._spans[i]] -= self._tiles[i, j] @ own
            for j in reversed(range(many)):
                own = x[self._spans[j]]
                for i in range(j + 1, many):
                    own -= self._tiles[i, j].T @ x[self._spans[i]]
                x[self._spans[j]] = dtrsm(1.0, self._tiles[j, j], own, lower=1, trans_a=1)
        return x
