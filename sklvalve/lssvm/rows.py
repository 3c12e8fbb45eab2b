# SPDX-License-Identifier: BSD-3-Clause
"""Where the rows of a fit come from, block by block, in the coordinates of the kernel.

Nothing here holds more than a block at a time: an array may lie in a file that is mapped into memory, and
blocks may come from anywhere.
"""

from dataclasses import dataclass

import numpy as np
from sklearn.utils.validation import _check_sample_weight, validate_data

from sklvalve.lssvm.kernels import SHIFT_INVARIANT

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


def middle_of(X, kernel, bias):
    """What may be taken off all rows without a change of the function that is fitted; zero where nothing."""
    if kernel_moves_along(kernel, bias):
        return np.mean(X, axis=0, dtype=np.float64)
    return np.zeros(X.shape[1])


def kernel_moves_along(kernel, bias):
    """Whether the function that is fitted follows where all rows are moved alike."""
    return isinstance(kernel, str) and (kernel in SHIFT_INVARIANT or (kernel == "linear" and bias == "free"))


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
        If the blocks can be read only once, are none, or one is no block, not finite, or unlike the first.
    """

    def __init__(self, blocks, estimator):
        if not callable(blocks) and iter(blocks) is blocks:
            raise ValueError(
                "The blocks are read several times, and these can be read only once: give a list, or a "
                "function that returns a new generator each time."
            )
        self._blocks, self._estimator, self._targets = blocks, estimator, None

    def __iter__(self):
        for number, block in enumerate(self._blocks() if callable(self._blocks) else self._blocks):
            if not isinstance(block, tuple | list) or len(block) not in (2, 3):
                raise ValueError(
                    f"Block {number} must be (X, y) or (X, y, sample_weight), got {type(block).__name__}."
                )
            yield self._checked(*block)

    def first(self):
        """The first block."""
        for block in self:
            return block
        raise ValueError("There are no blocks; give at least one.")

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
            raise ValueError(f"y has the shape {y.shape} in a block, (n, *{self._targets}) in the first.")
        weight = np.ones(len(X))
        if sample_weight is not None:
            weight = _check_sample_weight(sample_weight, X, dtype=np.float64, ensure_non_negative=True)
        return X, y.astype(np.float64).reshape(len(y), -1), weight


@dataclass(frozen=True)
class Move:
    """A block in the coordinates of the kernel, with a shift taken off its targets."""

    coordinates: Coordinates
    shift: np.ndarray | float

    def __call__(self, block):
        X, y, weight = block
        return self.coordinates(X), y - self.shift, weight


class MovedBlocks:
    """Blocks in the coordinates of the kernel.

    Parameters
    ----------
    blocks : iterable
        Of X, y and weight, of any type of number.
    coordinates, shift
        Of `Move`.
    """

    def __init__(self, blocks, coordinates, shift):
        self._blocks, self._move = blocks, Move(coordinates, shift)

    def __iter__(self):
        return map(self._move, self._blocks)
