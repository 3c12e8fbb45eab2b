# SPDX-License-Identifier: BSD-3-Clause
"""Where the rows of a fit come from, block by block, in the coordinates of the kernel.

Nothing here holds more than a block at a time: an array may lie in a file that is mapped into memory, and
blocks may come from anywhere.
"""

import zlib
from dataclasses import dataclass

import numpy as np
from sklearn.utils.validation import _check_sample_weight, validate_data

from sklvalve.lssvm.kernels import SHIFT_INVARIANT
from sklvalve.lssvm.solvers import raise_unless_finite

# numbers of one block
_NUMBERS = 2**20
#: Rows at the beginning that say where the middle is, where nobody can look at all of them.
HEAD = 1000


@dataclass(frozen=True)
class Coordinates:
    """Rows as the kernel sees them: less their middle, so that small differences keep their digits.

    Attributes
    ----------
    offset : ndarray of shape (n_features,)
    scale : ndarray of shape (n_features,) or None
        What each column is multiplied by after it.
    """

    offset: np.ndarray
    scale: np.ndarray | None = None

    def __call__(self, X):
        """Rows of any type of number, of shape (n, n_features), as a new array."""
        moved = np.subtract(X, self.offset, dtype=np.float64)
        if self.scale is not None:
            moved *= self.scale
        return moved

    def back(self, moved):
        """Rows as they came, but for rounding."""
        return (moved if self.scale is None else moved / self.scale) + self.offset


def as_columns(y):
    """Targets in double, of shape (n, n_targets), also where n is zero."""
    y = np.asarray(y, dtype=np.float64)
    return y[:, None] if y.ndim == 1 else y


def merged(X, y, weight):
    """Rows that repeat each other made one, with the mean of their targets and the sum of their weights.

    That changes nothing of the function that is fitted.
    """
    rows, first, of = np.unique(X, axis=0, return_index=True, return_inverse=True)
    if len(rows) == len(X):
        return X, y, weight
    total = np.bincount(of, weights=weight)
    means = [
        y[first, k] + np.bincount(of, weights=weight * (v - y[first, k][of])) / total
        for k, v in enumerate(y.T)
    ]
    return rows, np.column_stack(means), total


def middle_of(X, kernel, bias):
    """What may be taken off all rows without a change of the function that is fitted; zero where nothing."""
    if kernel_moves_along(kernel, bias):
        return np.mean(X, axis=0, dtype=np.float64)
    return np.zeros(X.shape[1])


def kernel_moves_along(kernel, bias):
    """Whether the function that is fitted follows where all rows are moved alike."""
    return isinstance(kernel, str) and (kernel in SHIFT_INVARIANT or (kernel == "linear" and bias == "free"))


def unit_of(targets):
    """A power of two near the largest target, by which they are divided; that costs no digit."""
    largest = float(np.abs(targets).max(initial=0.0))
    return float(2.0 ** np.floor(np.log2(largest))) if np.isfinite(largest) and largest > 0.0 else 1.0


def raise_unless_usable(C):
    """Refuse a C whose inverse overflows."""
    with np.errstate(divide="ignore", over="ignore"):
        if not np.isfinite(np.divide(1.0, C)):
            raise ValueError(f"C = {C:g} is so small that 1 / C is infinite; give C = 1e-300 or more.")


def weight_of(C, sample_weight, X):
    """Weights of the rows, of shape (n,); one that is so small that 1 / (C w) is infinite counts as nothing.

    Raises
    ------
    ValueError
        If weights are negative or not finite, or if 1 / C is infinite.
    """
    raise_unless_usable(C)
    if sample_weight is None:
        return np.ones(len(X))
    weight = _check_sample_weight(sample_weight, X, dtype=np.float64, ensure_non_negative=True, copy=True)
    with np.errstate(divide="ignore", over="ignore"):
        weight[~np.isfinite(1.0 / (C * weight))] = 0.0
    return weight


def raise_unless_weighed(weighed):
    """Refuse rows of which none counts."""
    if not weighed:
        raise ValueError("There are no rows with a positive weight; give at least one.")


def begin(blocks, kernel, bias):
    """Middle of the rows, of the targets, and a unit of these, by the first rows that have a weight.

    Parameters
    ----------
    blocks : iterable
        Of X, y and weight; no more are read than are needed.
    kernel : str or callable
    bias : {"free", "regularized", "none"}

    Returns
    -------
    offset : ndarray of shape (n_features,)
    shift : ndarray of shape (n_targets,)
        Zero unless the bias is free.
    unit : float

    Raises
    ------
    ValueError
        If there are no blocks, or no row has a weight.
    """
    first = next((block for block in blocks if (block[2] > 0.0).any()), None)
    raise_unless_weighed(first is not None)
    X, y, weight = first
    rows = np.flatnonzero(weight > 0.0)[:HEAD]
    targets = y[rows]
    shift = targets.mean(axis=0) if bias == "free" else np.zeros(y.shape[1])
    return middle_of(X[rows], kernel, bias), shift, unit_of(targets - shift)


class ArrayBlocks:
    """Rows of arrays, in blocks that are views of them.

    Parameters
    ----------
    X : ndarray of shape (n, d)
        Of any type of number, mapped into memory perhaps.
    y : ndarray of shape (n, n_targets)
    weight : ndarray of shape (n,)
    """

    def __init__(self, X, y, weight):
        self._columns, self._step = (X, y, weight), max(1, _NUMBERS // max(1, X.shape[1]))

    def __iter__(self):
        for start in range(0, len(self._columns[0]), self._step):
            yield tuple(column[start : start + self._step] for column in self._columns)


class GivenBlocks:
    """Blocks that a user gives, each checked as it comes.

    Parameters
    ----------
    blocks : iterable or callable
        Of ``(X, y)`` or ``(X, y, sample_weight)``; a callable returns such an iterable.
    estimator : BaseEstimator
        The first block sets its columns; the others have the same.

    Attributes
    ----------
    single : bool
        Whether y has one dimension; known after the first block.

    Raises
    ------
    ValueError
        If the blocks can be read only once, are none, or one is no block, not finite, unlike the first, or
        another one than when it was read before.
    """

    def __init__(self, blocks, estimator):
        if not callable(blocks) and iter(blocks) is blocks:
            raise ValueError(
                "The blocks are read several times, and these can be read only once: give a list, or a "
                "function that returns a new generator each time."
            )
        self._blocks, self._estimator = blocks, estimator
        self._targets = self._rows = None
        self._sums: list[int] = []

    def __iter__(self):
        rows = 0
        for number, block in enumerate(self._blocks() if callable(self._blocks) else self._blocks):
            if not isinstance(block, tuple | list) or len(block) not in (2, 3):
                raise ValueError(
                    f"Block {number} must be (X, y) or (X, y, sample_weight), got {type(block).__name__}."
                )
            X, y, weight = self._checked(*block)
            self._raise_unless_as_before(number, X, y, weight)
            rows += len(X)
            yield X, y, weight
        if self._rows is not None and rows != self._rows:
            raise ValueError(
                f"The blocks had {self._rows} rows when they were first read and {rows} now: they must be "
                "the same each time; a function must return a new generator."
            )
        self._rows = rows

    def _raise_unless_as_before(self, number, *columns):
        total = 0
        for column in columns:
            total = zlib.crc32(np.ascontiguousarray(column).tobytes(), total)
        if number == len(self._sums):
            # on the first time; blocks beyond the last one of a whole pass are found by their rows
            self._sums.append(total)
        elif total != self._sums[number]:
            raise ValueError(
                f"Block {number} holds other numbers than when it was first read: the blocks are read "
                "several times and must be the same each time; give a list, or fix the seed that makes them."
            )

    @property
    def single(self):
        return self._targets == ()

    def _checked(self, X, y, sample_weight=None):
        reset = self._targets is None
        more = {"dtype": np.float64, "multi_output": True, "y_numeric": True, "reset": reset}
        X, y = validate_data(self._estimator, X, y, **more)
        if reset:
            self._targets = y.shape[1:]
        if y.shape[1:] != self._targets:
            raise ValueError(
                f"y has the shape {y.shape} in a block, and {('n', *self._targets)} in the first."
            )
        return X, as_columns(y), weight_of(self._estimator.C, sample_weight, X)


@dataclass(frozen=True)
class Move:
    """A block in the coordinates of the kernel, its targets less a shift in a unit of their own."""

    coordinates: Coordinates
    shift: np.ndarray | float
    unit: float

    def __call__(self, block):
        X, y, weight = block
        X, known = self.coordinates(X), weight > 0.0
        raise_unless_finite(X[known])
        return X, (y - self.shift) / self.unit, weight


class MovedBlocks:
    """Blocks in the coordinates of the kernel.

    Parameters
    ----------
    blocks : iterable
        Of X, y and weight, of any type of number.
    move : Move
    """

    def __init__(self, blocks, move):
        self._blocks, self._move = blocks, move

    def __iter__(self):
        return map(self._move, self._blocks)
