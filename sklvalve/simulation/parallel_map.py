# SPDX-License-Identifier: BSD-3-Clause
"""Independent pieces of one search, run in threads: what they spend their time in is compiled and lets go."""

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar

from joblib import cpu_count, effective_n_jobs

# more threads than a few wait for each other's turns at the interpreter
_MOST = 4
_threads: ContextVar[int | None] = ContextVar("threads", default=None)
_here = threading.local()


@contextmanager
def with_threads(n_jobs: int | None) -> Iterator[None]:
    """Run what is inside in so many threads, counted as joblib counts; None takes the cores, at most four."""
    token = _threads.set(None if n_jobs is None else effective_n_jobs(n_jobs))
    try:
        yield
    finally:
        _threads.reset(token)


def _allowed():
    return _threads.get() or min(cpu_count(), _MOST)


def parallel_map(function, items):
    """Results of a function for several items, in their order.

    Parameters
    ----------
    function : callable
        Must change nothing that the others see.
    items : iterable

    Yields
    ------
    result : object
        As soon as it and all before it are there.

    Notes
    -----
    Within a piece that runs side by side already the items come one after the other.
    """
    items = list(items)
    threads = min(_allowed(), len(items))
    if threads < 2 or getattr(_here, "busy", False):
        yield from map(function, items)
        return
    with ThreadPoolExecutor(threads, initializer=_mark) as pool:
        try:
            yield from pool.map(function, items)
        except BaseException:
            # an interrupt must not wait for what has not begun
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _mark():
    _here.busy = True
