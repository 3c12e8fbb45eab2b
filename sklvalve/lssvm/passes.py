# SPDX-License-Identifier: BSD-3-Clause
"""Passes over rows that are too many to be held as kernel values: what landmarks need to know of them.

A pass gives sums over all rows, so it may be made block by block, and each block wherever it lies.
"""

import numpy as np

from sklvalve.lssvm.cells import Cells, gathered
from sklvalve.lssvm.products import KernelBlocks
from sklvalve.lssvm.rows import raise_unless_weighed
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
        self.between, self._blocks = between, blocks

    def look(self, *, most, side, most_cells, seed):
        """What one pass tells of the rows.

        Parameters
        ----------
        most : int
            Rows to be drawn.
        side : float or None
            Of the cells of a coarse copy; None where none is wanted.
        most_cells : int
            Of the copy.
        seed : int

        Returns
        -------
        look : Look
        """
        look = Look(most, side, most_cells)
        for block in self._blocks:
            look.add(look_at(block, look.rows, seed, most, side))
        return look

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
        for block in self._blocks:
            total += sums_of_block(run, self.between, landmarks, alpha, b, block, with_targets=with_targets)
        return total


def look_at(block, start, seed, most, side):
    """What a block adds to a `Look`: its rows, their weight, some that are drawn, and means of cells.

    Each row has a random number of its own by its place among all rows, so that it does not matter in which
    blocks they come. Rows without weight are none.
    """
    many, chance = len(block[0]), _chances(seed, start, len(block[0]))
    kept = block[2] > 0.0
    X, y, weight = block if kept.all() else (column[kept] for column in block)
    cells = gathered(X, y, weight, side) if side is not None and len(X) else None
    weights = weight.sum(), weight.max(initial=0.0)
    return many, weights, _thinned(X, y, weight, chance[kept], most), cells


class Look:
    """What is known of all rows after the first pass.

    Attributes
    ----------
    rows : int
    weight : float
        Sum of the weights.
    heaviest : float
        Of the weights.
    """

    def __init__(self, most, side, most_cells):
        self.rows, self.weight, self.heaviest = 0, 0.0, 0.0
        self._most, self._drawn = most, []
        self._cells = None if side is None else Cells(side, most_cells)

    def add(self, part):
        """Add what `look_at` tells of the next block."""
        many, weights, drawn, cells = part
        self.rows += many
        self.weight += weights[0]
        self.heaviest = max(self.heaviest, weights[1])
        self._drawn.append(drawn)
        if len(self._drawn) > _PARTS:
            self._drawn = [_lowest(self._drawn, self._most)]
        if cells is not None:
            self._cells.add(cells)

    def sample(self):
        """X, y and weight of the rows drawn."""
        raise_unless_weighed(self.weight > 0.0)
        return _lowest(self._drawn, self._most)[:3]

    def copy(self, most):
        """X, y and weight of weighted means, at most so many; None where none was wanted."""
        return None if self._cells is None else self._cells.result(most)


def sums_of_block(run, between, landmarks, alpha, b, block, *, with_targets):
    """`Passes.sums` of one block."""
    X, y, weight = block
    m = len(alpha)
    values_of = KernelBlocks(between, X, landmarks)
    step = max(32, _BLOCK // m)
    turns = Turns([slice(start, start + step) for start in range(0, len(X), step)])
    parts = [np.zeros((m + 1, alpha.shape[1])) for _ in range(run.many)]

    def work(k):
        own = parts[k]
        for rows in turns:
            values = values_of(rows, slice(None))
            left = -(values @ alpha) - b
            if with_targets:
                left += y[rows]
            left *= weight[rows, None]
            own[:-1] += values.T @ left
            own[-1] += left.sum(axis=0)

    run(work)
    return np.sum(parts, axis=0)


def _chances(seed, start, many):
    """Random numbers of rows by their places, whatever was drawn before."""
    bits = np.random.Philox(key=seed)
    # its counter goes on by one for every four numbers
    bits.advance(start // 4)
    return np.random.Generator(bits).random(start % 4 + many)[start % 4 :]


def _thinned(X, y, weight, chance, most):
    """Of rows with random numbers those with the lowest."""
    kept = np.argpartition(chance, most - 1)[:most] if len(chance) > most else slice(None)
    return X[kept], y[kept], weight[kept], chance[kept]


def _lowest(parts, most):
    """A sample of all the rows of some samples, in the order of their random numbers."""
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return _thinned(*(column[np.argsort(columns[-1])] for column in columns), most)
