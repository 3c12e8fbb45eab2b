# SPDX-License-Identifier: BSD-3-Clause
"""Fit what it tells of a name how much of its difference it leaves over; print the numbers.

    python -m benchmarks.concealed.calibrate_left_over

To the classes of sealed records of which the evidence was kept, without a history and with one; the seven
runs kept none, so the seventh's records are taken as a later commit judged them. Two numbers are added to the
log odds that `borne_out` gives without them. Then each draw is tried by numbers fitted without it, those of
`borne_out` too: as they are, shifted by one number, and with what is left. Which classes have it (the
strongest finding, that acts before the first origin of the forecasts) was chosen with these draws in sight.
"""

import argparse
import sys
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
from scipy.special import expit, logit

from benchmarks.concealed.calibrate import FRESH, fitted_to, logistic, of_histories, to_fit, told_of
from benchmarks.concealed.report.history import RESULTS, runs_of
from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.report.reliability import EDGES, by_chance
from benchmarks.concealed.scoring.calibration import expected_error, log_score
from benchmarks.concealed.scoring.lines import read_lines
from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.mismatch.decide.borne_out import SEALED
from sklvalve.mismatch.decide.probability import probability_of

# no record twice: files named again_ and later_ hold records of others
SEVENTH = RESULTS / "seed_69400423" / "again_28795cf.jsonl.gz"
OF_DRAWS = "[!a]*/[!al]*.jsonl.gz"
# of the ridge: a prior of the coefficient of a nat with this standard deviation
_SPREAD = 1.0
AS_BEFORE, SHIFTED, WITH_IT = "as before", "shifted", "with what is left"


def draws_of(files):
    """Draw -> its classes."""
    draws: dict = {}
    for file in files:
        lines = [line for line in read_lines(file) if "found" in line]
        told = told_of([{"run": file.parent.name, "lines": lines}], since=1.0)
        draws.setdefault(file.parent.name, []).extend(told)
    return draws


def without(name, draws, runs):
    """Numbers as those of `borne_out`, fitted without a draw and without the run of its seed."""
    numbers = fitted_to(told_of([run for run in runs if f"seed_{run['seed']}" != name]))
    others = chain(*(told for other, told in draws.items() if other != name))
    return of_histories([each for each in others if each.grounds.history], numbers)


def known(told):
    """Classes of which it is known what they leave over."""
    return [each for each in told if each.grounds.left is not None]


def odds_of(told, numbers=SEALED):
    """Log odds of classes as they are where it is not known what is left."""
    return np.array([logit(probability_of(replace(each.grounds, left=None), numbers)) for each in told])


def _left(told):
    return np.array([each.grounds.left for each in told])


def fitted(told, numbers=SEALED, of_a_nat=True):
    """Offset of the log odds, and what a nat that is left adds to them."""
    rows = np.stack([np.ones(len(told)), _left(told) * of_a_nat], axis=1)
    right = np.array([each.right for each in told], dtype=float)
    return logistic(rows, right, np.zeros(2), _SPREAD, beside=odds_of(told, numbers))


def tried(draws, runs):
    """State -> draw -> (probability by numbers without the draw, whether it is right) of each class."""
    states: dict = {AS_BEFORE: {}, SHIFTED: {}, WITH_IT: {}}
    for name in draws:
        numbers, told = without(name, draws, runs), known(draws[name])
        others = known(chain(*(draws[other] for other in draws if other != name)))
        for state, by_draw in states.items():
            offset, slope = (0.0, 0.0) if state == AS_BEFORE else fitted(others, numbers, state == WITH_IT)
            said = expit(odds_of(told, numbers) + offset + slope * _left(told))
            by_draw[name] = list(zip(said, (each.right for each in told), strict=True))
    return states


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
    files = parser.parse_args(arguments).scores or [SEVENTH, *to_fit(FRESH.glob(OF_DRAWS))]
    draws = draws_of(files)
    every = known(chain(*draws.values()))
    offset, slope = fitted(every)
    wrong = sum(not each.right for each in every)
    print(f"    # of {len(every)} classes of {len(draws)} draws, {wrong} of them wrong")
    print(f"    left_over=({offset:.3f}, {slope:.4f}),")
    states = tried(draws, runs_of(RESULTS))
    rows = [_row(f"{name}: {state}", states[state][name]) for name in draws for state in states]
    rows += [_row(f"all: {state}", list(chain(*by_draw.values()))) for state, by_draw in states.items()]
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
