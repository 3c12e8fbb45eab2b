# SPDX-License-Identifier: BSD-3-Clause
"""Whether ``cannot_tell`` is said where a record cannot tell, and not where it can.

The generator's own distances decide: below 6 between two explanations (or between the effect and nothing) the
record leaves it open, above 20 it does not.
"""

from benchmarks.concealed.scoring.lines import (
    classes_of,
    distances_of,
    of_kind,
    true_names,
    verdict_of,
)
from benchmarks.concealed.scoring.rates import rate_of

OPEN, CLEAR = 6.0, 20.0


def left_open(line):
    """Whether the record leaves open what it holds; None where the generator does not say."""
    least = distances_of(line)[2]
    return None if least is None else least < OPEN


def ambiguous(line):
    """Whether the diagnosis leaves it open.

    It cannot tell; or it names a class of several that holds the truth; or it tells no mismatch where the
    effect is hardly one.
    """
    verdict, to_nothing = verdict_of(line), distances_of(line)[0]
    if verdict == "cannot_tell":
        return True
    if verdict == "no_mismatch":
        return to_nothing is not None and to_nothing < OPEN
    true = true_names(line)
    return verdict == "named" and any(len(names) > 1 and names & true for names in classes_of(line))


def honest_silence(line):
    """Whether the record leaves it open and the diagnosis says so without a name."""
    silent = verdict_of(line) in ("cannot_tell", "no_mismatch")
    return bool(left_open(line)) and silent and ambiguous(line)


def told_open(lines):
    """Of records with effects of the catalogue that leave it open: those told so."""
    some = of_kind(lines, "single", "pair")
    return rate_of(ambiguous(line) for line in some if left_open(line))


def answered(lines):
    """Of records with effects of the catalogue that leave nothing open: those that get an answer by name."""
    some = of_kind(lines, "single", "pair")
    clear = [line for line in some if (distances_of(line)[2] or 0.0) > CLEAR]
    return rate_of(verdict_of(line) == "named" for line in clear)


def one_name(lines):
    """Of the same: those of which a class holds true names alone."""
    some = of_kind(lines, "single", "pair")
    clear = [line for line in some if (distances_of(line)[2] or 0.0) > CLEAR]
    return rate_of(
        verdict_of(line) == "named" and any(names <= true_names(line) for names in classes_of(line) if names)
        for line in clear
    )
