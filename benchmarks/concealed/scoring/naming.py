# SPDX-License-Identifier: BSD-3-Clause
"""Whether what is missing is called by its name.

Give `distinguishable_only(lines)` instead of all lines to count only what the generator's own distances call
distinguishable.
"""

import numpy as np

from benchmarks.concealed.scoring.honesty import honest_silence
from benchmarks.concealed.scoring.lines import (
    concealed,
    distinguishable,
    entries_of,
    failed,
    grouped,
    names_of,
    of_kind,
    refused,
    true_names,
    verdict_of,
)
from benchmarks.concealed.scoring.outcome import found_names, judge, wrongly_named
from benchmarks.concealed.scoring.rates import macro_of, mean_of, rate_of

# A wrong name costs a user more than an honest "cannot tell".
PRICE_OF_WRONG = 2.0


def class_right(lines):
    """Of one effect: a class of the verdict ``named`` holds it, and no class beside it is wrong."""
    return rate_of(judge(line) == "right" for line in of_kind(lines, "single"))


def class_holds(lines):
    """Of one effect: a class of the verdict ``named`` holds it, whatever else is named beside it."""
    return rate_of(bool(found_names(line)) for line in of_kind(lines, "single"))


def ranking(line):
    """Names told, whatever the verdict, the most probable first; one without probability counts as none."""
    told: dict = {}
    for entry in entries_of(line):
        for member in entry.get("members") or ():
            probability = member.get("probability") or 0.0
            told[member["name"]] = max(probability, told.get(member["name"], 0.0))
    # sorting keeps the order told among equals
    return sorted(told, key=lambda name: -told[name])


def top(lines, first):
    """Of one effect: its name is among the `first` names most believed in, whatever the verdict."""
    return rate_of(bool(true_names(line) & set(ranking(line)[:first])) for line in of_kind(lines, "single"))


def macro_right(lines):
    """`class_right` averaged over effects, the rare weighing as much as the frequent."""
    groups = grouped(of_kind(lines, "single"), concealed)
    return macro_of([class_right(group) for group in groups.values()])


def class_size(line):
    """Names in the class that holds a true one; None where there is none."""
    true = true_names(line)
    classes = [set(names_of(entry)) for entry in entries_of(line)]
    return next((len(names) for names in classes if names & true), None)


def mean_class_size(lines):
    """Names in the class that holds the effect, over records with one effect that are named rightly."""
    right = [line for line in of_kind(lines, "single") if judge(line) == "right"]
    return mean_of([class_size(line) for line in right], digits=1)


def wrong_name(lines):
    """Of all records, healthy ones too: any class told holds no true name."""
    return rate_of(wrongly_named(line) for line in lines)


def wrong_candidate(lines):
    """Of all records: wrong names that are mere candidates, under the verdict ``cannot_tell``."""
    return rate_of(wrongly_named(line) and verdict_of(line) == "cannot_tell" for line in lines)


def abstention(lines):
    """Of records with anything concealed: ``cannot_tell``."""
    some = of_kind(lines, "single", "pair", "outside")
    return rate_of(None if failed(line) else verdict_of(line) == "cannot_tell" for line in some)


def not_distinguishable(lines):
    """Of records with one effect of which the generator tells: those that it cannot tell from another."""
    told = [distinguishable(line) for line in of_kind(lines, "single")]
    return rate_of(None if answer is None else not answer for answer in told)


def breaks(lines):
    """Of all records: the diagnosis broke."""
    return rate_of(failed(line) and not refused(line) for line in lines)


def refusals(lines):
    """Of all records: refused as bad input, as exchanged pressures are."""
    return rate_of(refused(line) for line in lines)


def useful(line):
    """Whether what is said is true and of use.

    The right class, every effect of a pair, no mismatch in a healthy valve, ``none_of_these`` where no
    catalogue holds it; and silence where the record leaves it open.
    """
    return judge(line) in ("right", "both found") or (not wrongly_named(line) and honest_silence(line))


def useful_and_true(lines):
    """Share of useful answers less twice that of wrong names; from -2 to 1."""
    worth = [float(useful(line)) - PRICE_OF_WRONG * wrongly_named(line) for line in lines]
    return mean_of(np.array(worth), digits=2)
