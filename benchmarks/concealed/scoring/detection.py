# SPDX-License-Identifier: BSD-3-Clause
"""Whether anything is said to be missing: alarms on healthy records, and power against size."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import kstest

from benchmarks.concealed.scoring.lines import (
    failed,
    grouped,
    of_kind,
    size_step,
    times_of,
    told_mismatch,
)
from benchmarks.concealed.scoring.outcome import judge
from benchmarks.concealed.scoring.rates import Rate, rate_of

# Sizes are drawn, so that they are counted between these, in times of the detectable one.
TIMES = (0.0, 0.75, 1.25, 1.75, 2.25, 2.75, 3.25, 4.0, np.inf)


def alarms(lines):
    """Rate of healthy records in which a mismatch is told; a diagnosis that broke is no alarm."""
    return rate_of(told_mismatch(line) for line in of_kind(lines, "healthy"))


def p_value_of(line):
    """p-value of "nothing is missing"; None where none is told."""
    told = None if failed(line) else (line["found"].get("mismatch") or {}).get("p_value")
    return None if told is None else float(told)


def p_values(lines):
    """Sorted p-values of the healthy records that have one."""
    return np.sort([p for line in of_kind(lines, "healthy") if (p := p_value_of(line)) is not None])


def rejected(lines):
    """Rate of healthy records whose p-value is at most the alpha told beside it (0.01 where none is)."""

    def below(line):
        p = p_value_of(line)
        return None if p is None else p <= (line["found"]["mismatch"].get("alpha") or 0.01)

    return rate_of(below(line) for line in of_kind(lines, "healthy"))


@dataclass(frozen=True)
class Uniformity:
    """Kolmogorov and Smirnov's test of p-values against the uniform law.

    Attributes
    ----------
    of : int
        Number of p-values.
    distance, p_value : float
        Of the test in both directions.
    excess, excess_p_value : float
        In the one direction that hurts: more small p-values than there should be.
    """

    of: int
    distance: float
    p_value: float
    excess: float
    excess_p_value: float

    @property
    def value(self):
        """What a target is held against: the p-value in both directions."""
        return self.p_value

    def __str__(self):
        if self.of == 0:
            return "-"
        # one-sided beside it: p-values that are too large raise no alarm, and fail the test all the same
        return f"D {self.distance:.2f}, p {self.p_value:.2g}; too small: p {self.excess_p_value:.2g}"


def uniformity(lines):
    """Whether the p-values of healthy records are uniform."""
    values = p_values(lines)
    if not len(values):
        nan = float("nan")
        return Uniformity(0, nan, nan, nan, nan)
    both, small = kstest(values, "uniform"), kstest(values, "uniform", alternative="greater")
    statistics = (both.statistic, both.pvalue, small.statistic, small.pvalue)
    return Uniformity(len(values), *map(float, statistics))


@dataclass(frozen=True)
class Power:
    """What becomes of records with one effect of a size.

    Attributes
    ----------
    size : float
        Times the detectable size; of drawn sizes the middle one of the records.
    label : str
    detected, right : Rate
        A mismatch told; the effect named rightly.
    """

    size: float
    label: str
    detected: Rate
    right: Rate


def power(lines):
    """Rows of `Power`, one a planned size (`size_step`)."""
    steps = grouped(of_kind(lines, "single"), size_step)
    return [_power(step, f"{step:g}", steps[step]) for step in sorted(steps)]


def power_by_times(lines, edges=TIMES):
    """Rows of `Power`, one a span of sizes as drawn; spans without a record are left out."""
    rows = []
    known = [line for line in of_kind(lines, "single") if times_of(line) is not None]
    for low, high in pairwise(edges):
        some = [line for line in known if low <= times_of(line) < high]
        if some:
            label = f"{low:g}-{high:g}" if np.isfinite(high) else f"from {low:g}"
            rows.append(_power(float(np.median([times_of(line) for line in some])), label, some))
    return rows


def _power(size, label, lines):
    detected = rate_of(bool(told_mismatch(line)) for line in lines)
    return Power(float(size), label, detected, rate_of(judge(line) == "right" for line in lines))


def detected(lines, step=None):
    """Rate of records with anything concealed in which a mismatch is told; one that broke counts as not.

    With `step` only of records with one effect of that planned size.
    """
    if step is None:
        some = of_kind(lines, "single", "pair", "outside")
    else:
        some = [line for line in of_kind(lines, "single") if size_step(line) == step]
    return rate_of(bool(told_mismatch(line)) for line in some)
