# SPDX-License-Identifier: BSD-3-Clause
"""Print how often classes and names were true, by the probability that was reported of them.

python -m benchmarks.concealed.report.reliability SCORES...
"""

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.scoring.calibration import (
    brier,
    expected_error,
    log_score,
    reliability,
    told_classes,
    told_names,
)
from benchmarks.concealed.scoring.lines import (
    DEFAULT_METHOD,
    entries_of,
    method_of,
    names_of,
    read_lines,
    true_names,
)
from benchmarks.concealed.scoring.rates import rate_of

#: Edges of the bins: tenths, and the last one halved, where most classes are.
EDGES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0)
#: Between these the bins are counted that hold anything.
LOW, HIGH = 0.3, 0.95
_LACKS = ("no_opening", "no_p1", "no_p2")
_DRAWS = 2000


def few_signals(line):
    """Whether the opening or a pressure was kept from the record."""
    return any(way in _LACKS for way in line["truth"].get("nasty") or ())


def by_chance(told, seed=0):
    """Expected calibration error that true probabilities would show, by chance alone: mean of draws."""
    p = np.array([probability for probability, _ in told])
    drawn = np.random.default_rng(seed).random((_DRAWS, len(p))) < p
    place = np.clip(np.searchsorted(EDGES, p, side="right") - 1, 0, len(EDGES) - 2)
    off = np.stack([np.abs((drawn - p)[:, place == k].sum(axis=1)) for k in range(len(EDGES) - 1)])
    return float(off.sum(axis=0).mean() / len(p))


def reliability_table(title, told):
    """Bins of probabilities with the share that was true, and the errors of all, below a title."""
    if not told:
        return ""
    bins = reliability(told, EDGES)
    rows = [[f"{b.low:g}-{b.high:g}", b.true.of, f"{b.mean:.3f}", b.true] for b in bins]
    filled = sum(b.low >= LOW and b.high <= HIGH + 1e-9 for b in bins)
    chance = by_chance(told)
    told_of = (
        f"{len(told)} of them; {filled} bins filled between {LOW:g} and {HIGH:g}; expected calibration error "
        f"{expected_error(told, EDGES)}, of true probabilities it would be {chance:.3f} by chance; Brier "
        f"score {brier(told)}, log score {log_score(told)}."
    )
    return section(title, table(["probability", "number", "mean", "true (95 %)"], rows), told_of)


def grade_table(lines):
    """How often classes of each grade held a true name; those without a probability apart."""
    told = [
        (
            entry["grade"]["level"],
            entry.get("probability") is None,
            bool(set(names_of(entry)) & true_names(line)),
        )
        for line in lines
        for entry in entries_of(line)
        if entry.get("grade")
    ]
    found = Counter((level, bare) for level, bare, _ in told)
    rows = [
        [level, "no" if bare else "yes", rate_of(right for lv, b, right in told if (lv, b) == (level, bare))]
        for level in ("strong", "moderate", "weak")
        for bare in (False, True)
        if found[level, bare]
    ]
    return section("Grades", table(["grade", "with a probability", "true (95 %)"], rows))


def reliability_report(lines):
    """All tables of some lines, as Markdown."""
    few = [line for line in lines if few_signals(line)]
    full = [line for line in lines if not few_signals(line)]
    parts = [
        reliability_table("Classes", told_classes(lines)),
        reliability_table("Names", told_names(lines)),
        reliability_table("Classes and names together", told_classes(lines) + told_names(lines)),
        reliability_table("Classes, full recordings", told_classes(full)),
        reliability_table("Classes, opening or a pressure not recorded", told_classes(few)),
        grade_table(lines),
    ]
    return "\n\n".join(part for part in parts if part)


def main(arguments=None):
    """Print the tables; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.report.reliability", description=__doc__.splitlines()[0]
    )
    parser.add_argument("scores", type=Path, nargs="+", help="files of scores, one line of JSON a record")
    options = parser.parse_args(arguments)
    missing = [str(path) for path in options.scores if not path.is_file()]
    if missing:
        parser.error(f"expected files of scores, but there is no {', '.join(missing)}")
    lines = [line for line in read_lines(*options.scores) if method_of(line) == DEFAULT_METHOD]
    print(reliability_report(lines) or "no class was reported with a probability")
    return 0


if __name__ == "__main__":
    sys.exit(main())
