# SPDX-License-Identifier: BSD-3-Clause
"""Fit how often names hold, by what a diagnosis knows of them, to the sealed runs; print the numbers.

    python -m benchmarks.concealed.calibrate                      numbers of mismatch/decide/borne_out.py
    python -m benchmarks.concealed.calibrate --without seventh    fitted without a run, and tried on it
    python -m benchmarks.concealed.calibrate --histories          numbers of records with histories

With `--histories` it takes the scores given after it, or those of all sealed draws with histories, prints
their numbers, and what each draw would have had from the numbers of the others.

A logistic regression with a ridge: the log odds of the leading name, the rarity of the mismatch, whether the
class stands beside a stronger one, whether the values are coarse, whether the effect may vanish. Classes of
recordings without the opening or a pressure get an offset and a slope of their own.
"""

import argparse
import copy
import sys
from collections import defaultdict
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import logit

from benchmarks.concealed.methods import WITH_HISTORY
from benchmarks.concealed.report.history import RESULTS, runs_of
from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.report.reliability import EDGES, by_chance, few_signals, reliability_report
from benchmarks.concealed.scoring.calibration import expected_error, log_score
from benchmarks.concealed.scoring.lines import entries_of, names_of, read_lines, true_names
from sklvalve.mismatch.decide.borne_out import Numbers, summed
from sklvalve.mismatch.decide.probability import (
    Grounds,
    is_coarse,
    left_over,
    log_odds_of_name,
    probability_of,
    vanishing,
)
from sklvalve.mismatch.effects import CATALOGUE, EVENTS
from sklvalve.mismatch.inference.origins import ORIGINS

FRESH = Path(__file__).parent / "fresh"
# not those named again_ and later_, whose records were judged before
OF_HISTORIES = "*/[!al]*_sklvalve_history.jsonl.gz"
# judged by the numbers that are fitted here: it tests them
JUDGED_BY_THEM = ("seed_35829997", "seed_13089313", "seed_74115529", "seed_47441999")

# the runs were judged before stretches counted: what is as strong has a p so many times as large now, as
# `USUAL_P` says; of later runs it is 1
_SINCE_STRETCHES_COUNT = 0.1
# of the ridge: a prior of the coefficients with this standard deviation, and of the slope about one
_SPREAD, _SPREAD_OF_SLOPE = 1.0, 0.5


class Told(NamedTuple):
    """A class that was reported, what it was reported on, and whether it holds the truth."""

    run: str
    grounds: Grounds
    true: tuple

    @property
    def right(self):
        """Whether any of its names is true."""
        return any(self.true)


def told_of(runs, since=_SINCE_STRETCHES_COUNT):
    """Classes of runs as `history.runs_of` gives them, their p-values taken `since` times."""
    return [
        Told(
            run["run"],
            grounds_of(line, entry, k > 0, since),
            tuple(name in true_names(line) for name in names_of(entry)),
        )
        for run in runs
        for line in run["lines"]
        for k, entry in enumerate(entries_of(line))
    ]


def grounds_of(line, entry, beside, since=_SINCE_STRETCHES_COUNT):
    """`Grounds` of an entry of a line of scores, its p-value taken `since` times."""
    name, parameters, evidence = entry["members"][0]["name"], entry["parameters"], entry.get("evidence")
    forms = [
        e
        for e in (*CATALOGUE, *EVENTS)
        if e.name == name and {q.name for q in e.parameters} == set(parameters)
    ]
    return Grounds(
        name,
        since * line["found"]["mismatch"]["p_value"],
        beside=beside,
        coarse=is_coarse(line["found"].get("data") or []),
        may_vanish=bool(forms) and bool(vanishing(forms[0], parameters)),
        few_signals=few_signals(line),
        history=line.get("method") in WITH_HISTORY,
        left=left_over(evidence["gain"], evidence["skill"]) if _is_forecast(line, entry, beside) else None,
    )


def _is_forecast(line, entry, beside):
    """Whether it is known how every forecast did with an effect; the seven runs kept no evidence."""
    begins = entry.get("onset") or 0.0
    return "evidence" in entry and not beside and begins < ORIGINS[0] * line["truth"]["duration"]


def held_by_name(told):
    """Leading name -> (classes that hold the truth, classes)."""
    held: dict = {}
    for each in told:
        right, many = held.get(each.grounds.leading, (0, 0))
        held[each.grounds.leading] = right + each.right, many + 1
    return dict(sorted(held.items()))


def fitted_to(told):
    """Numbers fitted to classes."""
    held = held_by_name(told)
    rows = np.array([[1.0, _others_say(each, held), *each.grounds.columns] for each in told])
    right = np.array([each.right for each in told], dtype=float)
    few = np.array([each.grounds.few_signals for each in told])
    of_all = logistic(rows[~few], right[~few], np.array([0.0, 1.0, *[0.0] * (rows.shape[1] - 2)]), _SPREAD)
    odds = np.stack([np.ones(few.sum()), rows[few] @ of_all], axis=1)
    of_few = logistic(odds, right[few], np.array([0.0, 1.0]), _SPREAD_OF_SLOPE)
    return Numbers(of_all[0], of_all[1], tuple(of_all[2:]), tuple(of_few), held)


def of_histories(told, numbers):
    """Numbers with those of classes that were told with a history."""
    ours = held_by_name(told)
    together = summed(numbers.held, ours)
    rows, right = [], np.array([each.right for each in told], dtype=float)
    for each in told:
        others = replace(numbers, held=_without(each, together))
        rows.append([1.0, logit(probability_of(replace(each.grounds, history=False, left=None), others))])
    # few records have histories: the sealed numbers are believed until these say otherwise
    fitted = logistic(np.array(rows), right, np.array([0.0, 1.0]), _SPREAD_OF_SLOPE, free=0)
    return replace(numbers, with_history=tuple(fitted), held_with_history=ours)


def _others_say(each, held):
    """Log odds of its name by the other classes."""
    return log_odds_of_name(each.grounds.leading, _without(each, held))


def _without(each, held):
    """Counts of the other classes: a class must not vote for itself."""
    right, many = held[each.grounds.leading]
    return held | {each.grounds.leading: (right - each.right, many - 1)}


def logistic(rows, right, about, spread, free=1, beside=0.0):
    """Coefficients of least log loss `beside` known log odds; the first is `free`, others have a prior."""

    def loss(values):
        odds, off = beside + rows @ values, (values - about)[free:] / spread
        return np.sum(np.logaddexp(0.0, odds) - right * odds) + 0.5 * off @ off

    return minimize(loss, about).x


def reported_anew(line, numbers):
    """A line of scores with the probabilities that numbers give it."""
    made = copy.deepcopy(line)
    for k, entry in enumerate(entries_of(made)):
        whole = probability_of(grounds_of(line, entry, k > 0), numbers)
        shares = _shares(entry)
        entry["probability"] = round(whole, 4)
        for member, share in zip(entry["members"], shares, strict=True):
            member["probability"] = round(float(whole * share), 4)
    return made


def _shares(entry):
    """Shares of the members of a class."""
    reported = np.array([m["probability"] or 0.0 for m in entry["members"]])
    return reported / max(reported.sum(), 1e-12)


def as_code(numbers):
    """The numbers as `borne_out` has them."""
    each = ", ".join(f"{c:.3f}" for c in numbers.of_grounds)
    lines = [
        "SEALED = Numbers(",
        f"    intercept={numbers.intercept:.3f},",
        f"    of_name={numbers.of_name:.3f},",
        f"    of_grounds=({each}),",
        f"    few_signals=({numbers.few_signals[0]:.3f}, {numbers.few_signals[1]:.3f}),",
        *_counts_as_code("held", numbers.held),
        ")",
    ]
    return "\n".join(lines)


def _counts_as_code(argument, held):
    """Lines of counts by leading name."""
    counts = (f'        "{name}": ({right}, {many}),' for name, (right, many) in held.items())
    return [f"    {argument}={{", *counts, "    },"]


def main(arguments=None):
    """Print the numbers; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.calibrate", description=__doc__.splitlines()[0]
    )
    parser.add_argument("results", type=Path, nargs="?", default=RESULTS, help="folder with runs.csv")
    parser.add_argument("--without", metavar="RUN", help="leave a run out, and try the numbers on it")
    parser.add_argument(
        "--histories", type=Path, nargs="*", metavar="SCORES", help="records held against histories"
    )
    options = parser.parse_args(arguments)
    try:
        runs = runs_of(options.results)
    except (OSError, ValueError) as error:
        parser.error(str(error))
    if options.without is not None and options.without not in [run["run"] for run in runs]:
        parser.error(f"--without takes one of {', '.join(run['run'] for run in runs)}")
    numbers = fitted_to(told_of([run for run in runs if run["run"] != options.without]))
    if options.histories is not None:
        print_histories(options.histories or sealed_histories(), numbers)
        return 0
    print(as_code(numbers))
    for run in runs:
        if run["run"] == options.without:
            print(reliability_report([reported_anew(line, numbers) for line in run["lines"]]), sep="\n")
    return 0


def sealed_histories():
    """Scores of the sealed draws with histories that the numbers are fitted to."""
    return to_fit(FRESH.glob(OF_HISTORIES))


def to_fit(files):
    """Files of scores, in order, without those of draws that test the numbers."""
    return sorted(file for file in files if file.parent.name not in JUDGED_BY_THEM)


def print_histories(files, numbers):
    """Print the numbers of records with histories, and how those of the other draws do on each."""
    records, draws = 0, defaultdict(list)
    for file in files:
        lines = [line for line in read_lines(file) if "found" in line]
        records += len(lines)
        # all of them were judged since stretches count
        draws[file.parent.name] += told_of([{"run": file.parent.name, "lines": lines}], since=1.0)
    print(histories_as_code(of_histories(list(chain(*draws.values())), numbers), records))
    if len(draws) > 1:
        print_left_out(draws, numbers)


def print_left_out(draws, numbers):
    """Print how numbers of the other draws do on each; what a draw holds is in no other."""
    rows, pairs = [], []
    for name, of_draw in draws.items():
        others = of_histories([x for other in draws if other != name for x in draws[other]], numbers)
        of_this = [(probability_of(x.grounds, others), x.right) for x in of_draw]
        said, true = np.mean(of_this, axis=0)
        rows.append([name, len(of_draw), f"{true:.3f}", f"{said:.3f}"])
        pairs += of_this
    print(f"\n{table(['draw', 'classes', 'true', 'mean probability, by the other draws'], rows)}")
    scores = f"log score {log_score(pairs)}, expected calibration error {expected_error(pairs, EDGES)}"
    print(f"\n{len(pairs)} classes: {scores}, of true probabilities {by_chance(pairs):.3f} by chance")


def histories_as_code(numbers, records):
    """Numbers of records with histories as `borne_out` has them."""
    offset, slope = numbers.with_history
    held = numbers.held_with_history
    right, many = (sum(counts) for counts in zip(*held.values(), strict=True))
    return "\n".join(
        [
            f"    # of {many} classes told of {records} records with a history, {right} held a true name",
            f"    with_history=({offset:.3f}, {slope:.3f}),",
            *_counts_as_code("held_with_history", held),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
