# SPDX-License-Identifier: BSD-3-Clause
"""Whether the same records, given in another way, are judged the same."""

from scipy.stats import binomtest

from benchmarks.concealed.scoring.lines import verdict_of
from benchmarks.concealed.scoring.outcome import judge
from benchmarks.concealed.scoring.rates import rate_of


def paired(first, second):
    """Pairs of lines of the same record; records that only one of the two has are left out."""
    others = {line.get("record"): line for line in second}
    return [(line, others[line.get("record")]) for line in first if line.get("record") in others]


def same_verdict(first, second):
    """Of the records in both: the verdict is the same, a diagnosis that broke being none."""
    pairs = paired(first, second)
    return rate_of(verdict_of(a) is not None and verdict_of(a) == verdict_of(b) for a, b in pairs)


def same_outcome(first, second):
    """Of the records in both: the same word came of it (`judge`)."""
    return rate_of(judge(a) == judge(b) for a, b in paired(first, second))


def changed(first, second):
    """(record, word before, word after) of those of which another word came."""
    pairs = [(a.get("record"), judge(a), judge(b)) for a, b in paired(first, second)]
    return [(record, before, after) for record, before, after in pairs if before != after]


def mcnemar(pairs):
    """How often only the first, and only the second, of pairs of bool holds, and how likely chance does that.

    Returns
    -------
    lost, won : int
    p_value : float
        Exact and two-sided, that chance alone makes them as uneven.
    """
    lost, won = sum(a and not b for a, b in pairs), sum(b and not a for a, b in pairs)
    return lost, won, binomtest(lost, lost + won).pvalue if lost + won else 1.0
