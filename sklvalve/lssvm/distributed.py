# SPDX-License-Identifier: BSD-3-Clause
"""Passes over the parts of a Dask collection, wherever they lie: a cluster, or files larger than memory.

Every pass is one graph of sums, so a worker that is lost costs its part once more, and not the answer.
"""

import numpy as np

from sklvalve.lssvm.passes import Look, look_at, sums_of_block
from sklvalve.lssvm.rows import as_columns
from sklvalve.lssvm.scale import moments
from sklvalve.lssvm.threads import own_threads

# parts that are looked at before what they told is put together
_AT_ONCE = 16


def is_dask(X):
    """Whether X is a Dask array or data frame."""
    return hasattr(X, "__dask_graph__") and hasattr(X, "to_delayed")


class DaskPasses:
    """Passes over Dask collections, as `passes.Passes` are over blocks that this process can read.

    Parameters
    ----------
    between : callable
    parts : list of delayed
        Each a block X, y and weight, of any type of number.
    lengths : list of int
        Rows of each.
    moved : callable
        ``moved(block)`` gives the block in the coordinates of the kernel.
    """

    def __init__(self, between, parts, lengths, moved):
        from dask import delayed

        self.between, self._lengths = between, lengths
        self._parts = [delayed(moved)(part) for part in parts]

    def look(self, *, most, side, most_cells, seed):
        """As `passes.Passes.look`."""
        import dask

        look = Look(most, side, most_cells)
        starts = np.concatenate([[0], np.cumsum(self._lengths)[:-1]])
        tasks = [
            dask.delayed(look_at)(part, int(start), seed, most, side)
            for part, start in zip(self._parts, starts, strict=True)
        ]
        for first in range(0, len(tasks), _AT_ONCE):
            for told in dask.compute(*tasks[first : first + _AT_ONCE]):
                look.add(told)
        return look

    def sums(self, run, landmarks, alpha, b, *, with_targets):
        """As `passes.Passes.sums`; the threads are those of the workers."""
        del run
        import dask

        function = dask.delayed((self.between, landmarks, alpha, b))
        parts = [dask.delayed(_sums_there)(function, part, with_targets) for part in self._parts]
        while len(parts) > 1:
            parts = [dask.delayed(_added)(parts[k : k + 2]) for k in range(0, len(parts), 2)]
        return parts[0].compute()


def parts_of(X, y, sample_weight):
    """Blocks X, y and weight of Dask collections, and how many rows each has.

    Returns
    -------
    parts : list of delayed
    lengths : list of int

    Raises
    ------
    ValueError
        If the collections are not divided alike.
    """
    import dask

    columns = [
        _delayed(values, name) for name, values in (("X", X), ("y", y), ("sample_weight", sample_weight))
    ]
    if any(column is not None and len(column) != len(columns[0]) for column in columns):
        raise ValueError(
            "X, y and sample_weight must be Dask collections of as many parts: X has "
            f"{len(columns[0])}, y {len(columns[1] or [])}; give them the same chunks or partitions."
        )
    if columns[2] is None:
        columns[2] = [None] * len(columns[0])
    parts = [dask.delayed(_block)(*column) for column in zip(*columns, strict=True)]
    return parts, list(dask.compute(*[dask.delayed(_length)(part) for part in parts]))


def moments_of_parts(parts):
    """`rows.moments` of the rows of each part, which stay where they are."""
    import dask

    return list(dask.compute(*[dask.delayed(_moments)(part) for part in parts]))


def _moments(block):
    X, _, weight = block
    return moments(X, weight)


def _delayed(values, name):
    if values is None:
        return None
    if not is_dask(values):
        raise ValueError(
            f"With a Dask collection X, {name} must be one as well; got {type(values).__name__}."
        )
    if hasattr(values, "rechunk") and values.ndim == 2:
        # all columns of a row together
        values = values.rechunk({1: -1})
    return np.ravel(values.to_delayed()).tolist()


def _block(X, y, weight):
    X, y = np.asarray(X, dtype=np.float64), np.asarray(y, dtype=np.float64)
    weight = np.ones(len(X)) if weight is None else np.asarray(weight, dtype=np.float64)
    if not len(X) == len(y) == len(weight):
        raise ValueError(
            f"A part has {len(X)} rows of X, {len(y)} of y and {len(weight)} weights: divide them alike."
        )
    if not all(np.isfinite(column).all() for column in (X, y, weight)) or (weight < 0.0).any():
        raise ValueError("Every number of X, y and sample_weight must be finite, and no weight negative.")
    return X, as_columns(y), weight


def _length(block):
    return len(block[0])


def _sums_there(function, block, with_targets):
    # the worker has other parts to do at the same time
    with own_threads(1) as run:
        return sums_of_block(run, *function, block, with_targets=with_targets)


def _added(parts):
    return np.sum(parts, axis=0)
