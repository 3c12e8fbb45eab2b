# SPDX-License-Identifier: BSD-3-Clause
"""The longest straight lines through the rows of a signal, compiled."""

import numba as nb
import numpy as np
from numpy.typing import NDArray


@nb.njit(cache=True)
def longest_lines(time: NDArray[np.float64], values: NDArray[np.float64], room: float) -> NDArray[np.int64]:
    """Rows in which the longest lines end that pass all rows between within `room`, one after the other."""
    last = len(values) - 1
    ends = np.zeros(last + 1, dtype=np.int64)
    many, start = 1, 0
    while start < last:
        low, high, stop = -np.inf, np.inf, start + 1
        for row in range(start + 1, last + 1):
            lasts, rise = time[row] - time[start], values[row] - values[start]
            if low <= rise / lasts <= high:
                stop = row
            low, high = max(low, (rise - room) / lasts), min(high, (rise + room) / lasts)
            if low > high:
                break
        ends[many] = start = stop
        many += 1
    return ends[:many]
