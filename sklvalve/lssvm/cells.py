# SPDX-License-Identifier: BSD-3-Clause
"""Rows gathered in cells of a grid: few weighted rows that stand for many."""

import numpy as np

# sides of a cell over the length in which the kernel falls: such cells say what the kernel sees of the rows
SIDE = 0.15
_MOST = 2**62


class Cells:
    """Weighted means of the cells of a grid, gathered part by part.

    Parameters
    ----------
    side : float
        Of a cell.
    most : int
        Of so many cells coarser ones are made.
    """

    def __init__(self, side, most):
        self._side, self._most = side, most
        self._parts, self._many = [], 0

    def add(self, part):
        """Add what `gathered` made of some rows."""
        self._parts.append(part)
        self._many += len(part[0])
        if self._many > 4 * self._most:
            self._parts = [self._together(self._most)]
            self._many = len(self._parts[0][0])

    def result(self, most=None):
        """Weighted means of the rows of each cell, of which there are not more than `most`.

        Returns
        -------
        X : ndarray of shape (k, d)
        y : ndarray of shape (k, n_targets)
        weight : ndarray of shape (k,)
        """
        self._parts = [self._together(self._most if most is None else min(most, self._most))]
        return self._parts[0]

    def _together(self, most):
        merged = [np.concatenate(column) for column in zip(*self._parts, strict=True)]
        found = gathered(*merged, self._side)
        while len(found[0]) > most:
            # coarser as the number of cells asks for, in the plane that most rows lie near
            self._side *= max(1.2, (len(found[0]) / most) ** (1.0 / 4.0))
            found = gathered(*found, self._side)
        return found


def gathered(X, y, weight, side):
    """Weighted means of rows and targets by cells, and their weights."""
    places = np.floor(X / side)
    places -= places.min(axis=0)
    _, of = np.unique(_numbered(places), return_inverse=True)
    total = np.bincount(of, weights=weight)
    means = [np.bincount(of, weights=weight * v) / total for v in (*X.T, *y.T)]
    d = X.shape[1]
    return np.column_stack(means[:d]), np.column_stack(means[d:]), total


def _numbered(places):
    """One number for each place; columns are folded together before their product is too large for one."""
    key, size = np.zeros(len(places), dtype=np.int64), 1
    for column in places.T:
        if column.max() >= _MOST:
            _, column = np.unique(column, return_inverse=True)
        many = int(column.max()) + 1
        if size * many >= _MOST:
            _, key = np.unique(key, return_inverse=True)
            size = int(key.max()) + 1
        key = key * many + column.astype(np.int64)
        size *= many
    return key
