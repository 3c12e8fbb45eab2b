# SPDX-License-Identifier: BSD-3-Clause
"""A few threads that share blocks of work, each with a BLAS of one thread.

Two threads of one BLAS call wait for each other at every step, and wait badly where another process holds a
core. Threads that take blocks of their own wait for nothing.
"""

from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from functools import cache
from itertools import count, repeat
from threading import Lock

import numpy as np
from joblib import effective_n_jobs
from threadpoolctl import ThreadpoolController


@cache
def _controller():
    # looking for libraries takes milliseconds, and those of numpy and scipy are there by now
    return ThreadpoolController()


class _OneBlasThread:
    """Context in which BLAS keeps to the thread that calls it.

    The limit holds for the whole process, so of threads that ask for it at the same time the first sets it
    and the last takes it away.
    """

    def __init__(self):
        self._lock, self._inside, self._limit = Lock(), 0, None

    def __enter__(self):
        with self._lock:
            if not self._inside:
                self._limit = _controller().limit(limits=1, user_api="blas")
            self._inside += 1

    def __exit__(self, *_):
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._limit.restore_original_limits()


_one_blas_thread = _OneBlasThread()


def one_blas_thread():
    """Context in which BLAS keeps to the thread that calls it; it may be entered from several at once."""
    return _one_blas_thread


def threads_to_use(n_jobs=None):
    """Number of threads: `n_jobs` as scikit-learn has it; None is what BLAS would use by itself."""
    if n_jobs is not None:
        return effective_n_jobs(n_jobs)
    return max(
        (pool["num_threads"] for pool in _controller().info() if pool["user_api"] == "blas"), default=1
    )


@contextmanager
def own_threads(n_jobs=None):
    """Function that runs a task on every thread at once, while BLAS keeps to one thread each.

    Yields
    ------
    run : callable
        ``run(task)`` calls ``task(k)`` for k from 0 to ``run.many`` less one, side by side, and raises the
        first error.
    """
    many = threads_to_use(n_jobs)

    def quietly(task, k):
        # what overflows is seen by whoever asks whether the result is finite; threads inherit no errstate
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            task(k)

    # a pool of one thread would only keep this one waiting
    with one_blas_thread(), ThreadPoolExecutor(many) if many > 1 else nullcontext() as pool:
        each = pool.map if pool else map

        def run(task):
            # a list takes all the answers, and so raises the first error
            list(each(quietly, repeat(task, many), range(many)))

        run.many = many
        yield run


def in_this_thread(task):
    """As the `run` of `own_threads`, with this thread alone and BLAS as it is."""
    task(0)


in_this_thread.many = 1  # type: ignore[attr-defined]


class Turns:
    """Items handed out one at a time, in order, to whichever thread asks."""

    def __init__(self, items):
        self._items, self._lock, self._count = items, Lock(), count()

    def __iter__(self):
        while True:
            with self._lock:
                k = next(self._count)
            if k >= len(self._items):
                return
            yield self._items[k]
