# SPDX-License-Identifier: BSD-3-Clause
"""Whether a probability of 0.9 is right nine times in ten.

Of every class told, in whatever record and under whatever verdict, the probability told is held against
whether the class holds a true name.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmarks.concealed.scoring.lines import entries_of, names_of, true_names
from benchmarks.concealed.scoring.rates import Estimate, Rate, mean_of, nothing, resampled

# Probabilities are told with four digits, and a wrong one of 1 would count for ever.
LEAST = 1e-4
EDGES = tuple(np.linspace(0.0, 1.0, 11))


def told_classes(lines):
    """(probability, whether the class holds a true name), one a class told with a probability."""
    return [
        (float(entry["probability"]), bool(set(names_of(entry)) & true_names(line)))
        for line in lines
        for entry in entries_of(line)
        if entry.get("probability") is not None
    ]


def told_names(lines):
    """(probability, whether it is a true one), one a name told with a probability."""
    return [
        (float(member["probability"]), member["name"] in true_names(line))
        for line in lines
        for entry in entries_of(line)
        for member in entry.get("members") or ()
        if member.get("probability") is not None
    ]


def brier(told):
    """Mean square of probability less outcome; 0 is best, 0.25 is a coin."""
    return mean_of([(p - true) ** 2 for p, true in told], digits=3)


def log_score(told):
    """Mean of minus the logarithm of the probability of what is the case; 0 is best, 0.69 is a coin."""
    return mean_of([-np.log(_of_the_case(p, true)) for p, true in told], digits=2)


def _of_the_case(p, true):
    p = min(max(p, LEAST), 1.0 - LEAST)
    return p if true else 1.0 - p


@dataclass(frozen=True)
class Bin:
    """Classes told with a probability from `low` up to `high`: the mean told, and how many were true."""

    low: float
    high: float
    mean: float
    true: Rate


def reliability(told, edges=EDGES):
    """Rows of `Bin`, those with any class; the last one includes its upper edge."""
    rows = []
    for low, high in pairwise(edges):
        inside = [(p, true) for p, true in told if low <= p < high or (p == high == edges[-1])]
        if inside:
            mean = float(np.mean([p for p, _ in inside]))
            rows.append(Bin(float(low), float(high), mean, Rate(sum(t for _, t in inside), len(inside))))
    return rows


def expected_error(told, edges=EDGES):
    """Expected calibration error: |mean told - share true| of each bin, weighed by its classes.

    Few classes make it larger than it is, by chance; its interval too.
    """
    if not told:
        return nothing(digits=3)
    bins = len(edges) - 1
    columns = np.zeros((len(told), bins + 1))
    for row, (p, true) in zip(columns, told, strict=True):
        row[min(int(np.searchsorted(edges, p, side="right")) - 1, bins - 1)] = p - true
        row[-1] = 1.0
    return resampled(columns, lambda sums: np.abs(sums[:-1]).sum(axis=0) / sums[-1], digits=3)


@dataclass(frozen=True)
class Calibration:
    """Figures of all probabilities told."""

    of: int
    brier: Estimate
    log_score: Estimate
    expected_error: Estimate
    bins: list


def calibration(lines, told=told_classes):
    """`Calibration` of the classes told; of single names with ``told=told_names``."""
    pairs = told(lines)
    figures = brier(pairs), log_score(pairs), expected_error(pairs)
    return Calibration(len(pairs), *figures, reliability(pairs))
