# SPDX-License-Identifier: BSD-3-Clause
"""Fit what it tells of a name how much of its difference it leaves over; print the numbers.

    python -m benchmarks.concealed.calibrate_left_over

To the classes of all sealed records that the present core has judged, without a history and with one: the
seven runs kept no evidence. Two numbers are added to the log odds that `borne_out` gives without them. Each
draw is then tried by the numbers of the others, beside the same log odds shifted alone.
"""

import argparse
import sys
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
from scipy.special import expit, logit

from benchmarks.concealed.calibrate import FRESH, logistic, told_of
from benchmarks.concealed.report.history import RESULTS
from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.report.reliability import EDGES, by_chance
from benchmarks.concealed.scoring.calibration import expected_error, log_score
from benchmarks.concealed.scoring.lines import read_lines
from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.mismatch.decide.probability import probability_of

# of the present core, and no record twice: files named again_ and later_ hold records of others
SEVENTH = RESULTS / "seed_69400423" / "again_28795cf.jsonl.gz"
OF_DRAWS = "[!a]*/[!al]*.jsonl.gz"
# of the ridge: a prior of the coefficient of a nat with this standard deviation
_SPREAD = 1.0


def judged_since(files):
    """Draw -> classes of which it is known what they leave over."""
    draws: dict = {}
    for file in files:
        lines = [line for line in read_lines(file) if "found" in line]
        told = told_of([{"run": file.parent.name, "lines": lines}], since=1.0)
        draws.setdefault(file.parent.name, []).extend(t for t in told if t.grounds.left is not None)
    return draws


def without_it(told):
    """Log odds of classes as they are where it is not known what is left."""
    return np.array([logit(probability_of(replace(each.grounds, left=None))) for each in told])


def fitted(told, of_a_nat=True):
    """Offset of the log odds, and what a nat that is left adds to them."""
    rows = np.array([[1.0, each.grounds.left * of_a_nat] for each in told])
    right = np.array([each.right for each in told], dtype=float)
    return logistic(rows, right, np.zeros(2), _SPREAD, beside=without_it(told))


def tried(draws, of_a_nat):
    """(probability by the numbers of the other draws, whether it is right) of each class, by draw."""
    by_draw = {}
    for name, told in draws.items():
        offset, slope = fitted(list(chain(*(draws[n] for n in draws if n != name))), of_a_nat)
        said = expit(without_it(told) + offset + slope * np.array([each.grounds.left for each in told]))
        by_draw[name] = list(zip(said, (each.right for each in told), strict=True))
    return by_draw


def _row(words, pairs):
    named = [right for said, right in pairs if said >= NAMED_FROM]
    return [
        words,
        len(pairs),
        f"{np.mean([said for said, _ in pairs]):.3f}",
        f"{np.mean([right for _, right in pairs]):.3f}",
        str(log_score(pairs)),
        f"{expected_error(pairs, EDGES)} ({by_chance(pairs):.3f})",
        f"{sum(named)}, {len(named) - sum(named)}",
    ]


def main(arguments=None):
    """Print the numbers and how they do; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.calibrate_left_over", description=__doc__.splitlines()[0]
    )
    parser.add_argument(
        "scores", type=Path, nargs="*", help="files of scores; those of all draws unless given"
    )
    files = parser.parse_args(arguments).scores or [SEVENTH, *sorted(FRESH.glob(OF_DRAWS))]
    draws = judged_since(files)
    every = list(chain(*draws.values()))
    offset, slope = fitted(every)
    wrong = sum(not each.right for each in every)
    print(f"    # of {len(every)} classes of {len(draws)} draws, {wrong} of them wrong")
    print(f"    left_over=({offset:.3f}, {slope:.4f}),")
    without, with_it = tried(draws, False), tried(draws, True)
    rows = [
        *(
            _row(f"{name}: {words}", pairs[name])
            for name in draws
            for words, pairs in (("without", without), ("with", with_it))
        ),
        *(
            _row(f"all: {words}", list(chain(*pairs.values())))
            for words, pairs in (("without", without), ("with", with_it))
        ),
    ]
    head = [
        "draw",
        "classes",
        "mean probability",
        "right",
        "log score",
        "calibration error (by chance)",
        f"of those from {NAMED_FROM} on right, wrong",
    ]
    print(f"\n{table(head, rows)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
