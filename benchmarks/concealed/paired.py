# SPDX-License-Identifier: BSD-3-Clause
"""Two judgements of the same records beside each other, and how likely chance made them differ.

python -m benchmarks.concealed.paired BEFORE.jsonl AFTER.jsonl
"""

import argparse
import sys
from pathlib import Path

from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.scoring.agreement import mcnemar, paired
from benchmarks.concealed.scoring.lines import distinguishable, kind_of, read_lines
from benchmarks.concealed.scoring.outcome import judge

#: What is counted -> (kind of record, whether only distinguishable ones, outcome).
COUNTED = {
    "healthy, no alarm": ("healthy", False, "right"),
    "one effect, class right": ("single", False, "right"),
    "- distinguishable by the generator": ("single", True, "right"),
    "one effect, wrong name": ("single", False, "wrong name"),
    "two effects, both found": ("pair", False, "both found"),
    "no catalogue, recognised": ("outside", False, "right"),
    "no catalogue, called by a name": ("outside", False, "wrong name"),
    "defect of the data, said": ("defect", False, "right"),
}


def main(arguments=None):
    """Print the table; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.paired", description=__doc__.splitlines()[0]
    )
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    options = parser.parse_args(arguments)
    print(table_of(read_lines(options.before), read_lines(options.after)))
    return 0


def table_of(before, after):
    """Markdown: a row for each thing counted, of the records that both files hold.

    Parameters
    ----------
    before, after : sequence of dict
        Lines of scores.

    Returns
    -------
    table : str
    """
    pairs = paired(before, after)
    rows = []
    for what, (kind, only_distinguishable, outcome) in COUNTED.items():
        some = [
            (judge(a) == outcome, judge(b) == outcome)
            for a, b in pairs
            if kind_of(a) == kind and (distinguishable(a) or not only_distinguishable)
        ]
        if some:
            rows.append(row_of(what, some))
    return table(["", "before", "after", "only before", "only after", "McNemar p"], rows)


def row_of(what, answers):
    """Cells of one thing counted.

    Parameters
    ----------
    what : str
    answers : list of tuple of bool
        Of each record, whether it holds before and after.
    """
    lost, won, by_chance = mcnemar(answers)
    counts = [f"{sum(pair[k] for pair in answers)} of {len(answers)}" for k in (0, 1)]
    return [what, *counts, lost, won, f"{by_chance:.2f}"]


if __name__ == "__main__":
    sys.exit(main())
