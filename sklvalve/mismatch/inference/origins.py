# SPDX-License-Identifier: BSD-3-Clause
"""Where forecasts of a recording begin, and from when on one of two is clearly better."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

#: Where forecasts begin, as shares of a recording; each reaches to the next.
ORIGINS = (0.4, 0.55, 0.7, 0.85, 1.0)
# a black box is clearly better where it is so in all stretches ahead but so many
_BUT = 1


def spans_of(n: int) -> tuple[slice, ...]:
    """Rows between one origin and the next, of n rows: tuple of slice."""
    ends = (np.array(ORIGINS) * n).astype(int)
    return tuple(slice(low, high) for low, high in pairwise(ends.tolist()))


def enough(stretches: int) -> int:
    """In how many of some stretches ahead one must be better to be clearly so: three of four."""
    return max(stretches - _BUT, 1)
