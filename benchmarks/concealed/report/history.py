# SPDX-License-Identifier: BSD-3-Clause
"""Print every sealed run beside the others: which code it judged, what was promised, every figure."""

import argparse
import csv
import hashlib
import sys
from collections import Counter
from pathlib import Path

from benchmarks.concealed.report.headline import FIGURES
from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.scoring.lines import kind_of, read_lines

RESULTS = Path(__file__).parent.parent / "results"
SCORES = "scores_sklvalve.jsonl.gz"
KINDS = {
    "healthy": "nothing concealed",
    "single": "one effect",
    "pair": "two effects",
    "outside": "something of no catalogue",
    "defect": "columns exchanged or mislabelled",
}


def runs_of(results):
    """The runs that `runs.csv` of a folder lists, as dicts with their lines.

    Raises
    ------
    ValueError
        Where a seal is not the one that was published.
    """
    runs = []
    with (results / "runs.csv").open(encoding="utf-8", newline="") as listed:
        for run in csv.DictReader(listed):
            folder = results / f"seed_{run['seed']}"
            sealed = hashlib.sha256((folder / "seal.txt").read_bytes()).hexdigest()
            if sealed != run["seal_sha256"]:
                raise ValueError(f"expected the seal {run['seal_sha256']} in {folder}, found {sealed}")
            runs.append({**run, "lines": read_lines(folder / SCORES)})
    return runs


def provenance(runs):
    """Table of what was drawn, by which plant, and judged by which tool."""
    counts = [Counter(map(kind_of, run["lines"])) for run in runs]
    rows = [
        ["seed", *(run["seed"] for run in runs)],
        ["plant frozen", *(run["plant"] for run in runs)],
        ["tool frozen", *(run["tool"] for run in runs)],
        *([words, *(count[kind] for count in counts)] for kind, words in KINDS.items()),
        ["records", *(len(run["lines"]) for run in runs)],
    ]
    return table(["", *(f"{run['run']} run" for run in runs)], rows)


def figures(runs, chosen=FIGURES):
    """Table of figures that any run has, a column a run."""
    rows = [(f, [f.cell(run["lines"]) for run in runs]) for f in chosen]
    told = [[f.label, f.target, *cells] for f, cells in rows if set(cells) != {"-"}]
    return table(["", "aimed at", *(f"{run['run']} run" for run in runs)], told)


def promises(runs):
    """Table of the figures for which something was aimed at, of the latest two runs."""
    return figures(runs[-2:], [figure for figure in FIGURES if figure.target])


def main(arguments=None):
    """Print the tables; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.report.history", description=__doc__
    )
    parser.add_argument("results", type=Path, nargs="?", default=RESULTS, help="folder with runs.csv")
    try:
        runs = runs_of(parser.parse_args(arguments).results)
    except (OSError, ValueError) as error:
        parser.error(str(error))
    print(provenance(runs), promises(runs), figures(runs), sep="\n\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
