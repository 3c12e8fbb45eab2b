# SPDX-License-Identifier: BSD-3-Clause
"""Several effects at once, and effects that no catalogue holds."""

from benchmarks.concealed.scoring.lines import (
    failed,
    of_kind,
    true_names,
    verdict_of,
)
from benchmarks.concealed.scoring.outcome import found_names, judge, told_classes, wrongly_named
from benchmarks.concealed.scoring.rates import Rate, rate_of, resampled


def exact_set(lines):
    """Of several effects: each is held by a class of its own, and no class holds none of them."""
    return rate_of(judge(line) == "both found" for line in of_kind(lines, "pair"))


def at_least_one(lines):
    """Of several effects: at least one is held by a class of the verdict ``named``."""
    return rate_of(bool(found_names(line)) for line in of_kind(lines, "pair"))


def _counts(line):
    """Things found that are true, things found, things there."""
    return len(found_names(line)), len(told_classes(line)), len(true_names(line))


def precision(lines, *kinds):
    """Of the things named in records of these kinds (one effect or several): the true ones."""
    counts = [_counts(line) for line in of_kind(lines, *(kinds or ("single", "pair")))]
    return Rate(sum(c[0] for c in counts), sum(c[1] for c in counts))


def recall(lines, *kinds):
    """Of the things there: those named."""
    counts = [_counts(line) for line in of_kind(lines, *(kinds or ("single", "pair")))]
    return Rate(sum(c[0] for c in counts), sum(c[2] for c in counts))


def f1(lines, *kinds):
    """Harmonic mean of precision and recall, pooled, its interval by drawing the records anew."""
    counts = [_counts(line) for line in of_kind(lines, *(kinds or ("single", "pair")))]
    return resampled(counts, lambda sums: 2.0 * sums[0] / (sums[1] + sums[2]))


# ---- outside the catalogue


def flagged(lines):
    """Of effects that no catalogue holds: ``none_of_these``, and no name beside it."""
    return rate_of(judge(line) == "right" for line in of_kind(lines, "outside"))


def left_undecided(lines):
    """Of the same: ``cannot_tell`` without any name; a mismatch is told, and nothing untrue."""
    return rate_of(judge(line) == "cannot tell" for line in of_kind(lines, "outside"))


def misnamed(lines):
    """Of the same: called by a name of the catalogue."""
    return rate_of(wrongly_named(line) for line in of_kind(lines, "outside"))


def falsely_flagged(lines):
    """Of effects that the catalogue holds: ``none_of_these``."""
    some = of_kind(lines, "single", "pair")
    return rate_of(None if failed(line) else verdict_of(line) == "none_of_these" for line in some)
