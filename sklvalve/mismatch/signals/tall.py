# SPDX-License-Identifier: BSD-3-Clause
"""Least squares of many rows and few columns, block by block: memory for one block beside the columns."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

# rows of a block: with some tens of columns it stays in a core's cache
_ROWS = 8192


def row_blocks(begin: int, end: int) -> list[slice]:
    """Rows from `begin` to `end`, in blocks that a core's cache holds."""
    return [slice(low, min(low + _ROWS, end)) for low in range(begin, end, _ROWS)]


def triangle(blocks: Iterable[np.ndarray], above: np.ndarray | None = None) -> np.ndarray:
    """R of the QR factors of a matrix, of which each block of rows is seen once.

    Parameters
    ----------
    blocks : iterable of ndarray of shape (n_i, k)
        Rows, block by block.
    above : ndarray of shape (m, k), default=None
        R of the rows before these.

    Returns
    -------
    r : ndarray of shape (at most k, k)
        :math:`R^T R = A^T A`, by orthogonal steps alone, so nothing is squared: Golub and Van Loan, Matrix
        Computations, 2013, section 5.2 (the blocks stand below one another).

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.mismatch.signals.tall import triangle
    >>> A = np.random.default_rng(0).standard_normal((90, 3))
    >>> R = triangle([A[:50], A[50:]])
    >>> bool(np.allclose(R.T @ R, A.T @ A))
    True
    """
    made = above
    for block in blocks:
        rows = block if made is None else np.concatenate([made, block])
        made = np.asarray(np.linalg.qr(rows, mode="r"))
    if made is None:
        raise ValueError("expected a block of rows at least")
    return made
