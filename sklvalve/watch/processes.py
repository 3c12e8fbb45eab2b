# SPDX-License-Identifier: BSD-3-Clause
"""One task after the other, or over processes of this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any


def side_by_side(task: Callable[..., Any], jobs: Sequence[tuple], n_jobs: int | None) -> Iterator[Any]:
    """Results of a task, in whatever order they come.

    Parameters
    ----------
    task : callable
    jobs : sequence of tuple
        Arguments of each call.
    n_jobs : int or None
        Processes; None is one for each processor.

    Yields
    ------
    result : object
    """
    if n_jobs == 1 or len(jobs) == 1:
        yield from (task(*job) for job in jobs)
        return
    from joblib import Parallel, delayed

    parallel = Parallel(n_jobs=-1 if n_jobs is None else n_jobs, return_as="generator_unordered")
    yield from parallel(delayed(task)(*job) for job in jobs)
