# SPDX-License-Identifier: BSD-3-Clause
"""Independent pieces of one search, run in threads: what they spend their time in is compiled and lets go."""

import threading
from concurrent.futures import ThreadPoolExecutor

from joblib import cpu_count

# more threads than a few wait for each other's turns at the interpreter
_THREADS = min(cpu_count(), 4)
_here = threading.local()


def side_by_side(function, items):
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
    threads = min(_THREADS, len(items))
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
