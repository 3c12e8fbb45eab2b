# SPDX-License-Identifier: BSD-3-Clause
"""What a diagnosis costs: time and memory."""

from collections import Counter
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Cost:
    """Of one quantity over the records that tell it; not a number where none does."""

    of: int
    median: float
    ninth: float
    most: float
    total: float

    def __str__(self):
        if self.of == 0:
            return "-"
        return f"{self.median:.0f} (90 % below {self.ninth:.0f}, at most {self.most:.0f})"


def cost(lines, key="seconds"):
    """`Cost` in ``seconds``, or in megabytes of memory (``peak_mb``)."""
    values = [float(line[key]) for line in lines if line.get(key) is not None]
    if not values:
        nan = float("nan")
        return Cost(0, nan, nan, nan, 0.0)
    ninth = float(np.quantile(values, 0.9))
    return Cost(len(values), float(np.median(values)), ninth, max(values), sum(values))


def load(lines):
    """Mean load of the machine meanwhile; not a number where it is not told."""
    values = [float(line["load"]) for line in lines if line.get("load") is not None]
    return float(np.mean(values)) if values else float("nan")


def codes(lines):
    """States of the code that were judged, with the number of records of each."""
    return Counter(line.get("code") or "?" for line in lines)
