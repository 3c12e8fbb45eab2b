# SPDX-License-Identifier: BSD-3-Clause
"""What came of the records of one file of scores or of several together, counted as README does.

python -m benchmarks.concealed.report.outcomes SCORES.jsonl [MORE.jsonl]
"""

import argparse
import sys
from collections import Counter
from pathlib import Path

from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.scoring.lines import (
    changed_names,
    classes_of,
    entries_of,
    kind_of,
    read_lines,
    size_step,
    verdict_of,
)
from benchmarks.concealed.scoring.outcome import judge, wrongly_named
from benchmarks.concealed.scoring.rates import rate_of

HEAD = ["records", "right", "wrong name", "false alarm", "missed", "left open"]
#: What `judge` says -> column; what it does not hold is left open.
COLUMNS = {
    "right": "right",
    "both found": "right",
    "wrong name": "wrong name",
    "missed": "missed",
}
WORDS = {
    "healthy": "healthy",
    "single": "with one effect",
    "pair": "with two effects",
    "outside": "with an effect of no catalogue",
    "defect": "with a defect of the data",
}


def column_of(line):
    """Column of `HEAD` that a record counts in.

    On a healthy valve all but `no_mismatch` is a false alarm, also a refusal.
    Of two effects none is missed where nothing was told to be missing; one that was found is counted apart.
    """
    word = judge(line)
    if word == "one found":
        return word
    if kind_of(line) == "healthy" and word != "right":
        return "false alarm"
    if word == "neither" and verdict_of(line) == "no_mismatch":
        return "missed"
    return COLUMNS.get(word, "left open")


def group_of(line):
    """What a record is counted with: its kind, and of one effect its size."""
    size = size_step(line) if kind_of(line) == "single" else None
    return WORDS[kind_of(line)] + (f", size {size:g}" if size else "")


def rows_of(lines):
    """Rows of the table, in the order of `WORDS`, then of size."""
    order = list(WORDS.values())
    groups = sorted({group_of(line) for line in lines}, key=lambda g: (order.index(g.split(", ")[0]), g))
    rows = []
    for group in groups:
        counts = Counter(column_of(line) for line in lines if group_of(line) == group)
        cells = [counts[column] for column in HEAD[1:]]
        cells[0] = f"{cells[0]} both, {counts['one found']} one" if group == WORDS["pair"] else cells[0]
        rows.append([f"{sum(counts.values())} {group}", *cells])
    return rows


def classes(lines):
    """Of every class of the verdict ``named`` whether it holds, its probability and how many names it has."""
    return [
        (bool(names & changed_names(line)), effect.get("probability"), len(names))
        for line in lines
        if verdict_of(line) == "named"
        for names, effect in zip(classes_of(line), entries_of(line), strict=True)
    ]


def outcomes(lines):
    """The table, the wrong names and what came of the classes, in Markdown."""
    named = classes(lines)
    told = [probability for _, probability, _ in named if probability is not None]
    text = [table(HEAD, rows_of(lines)), f"Records with a wrong name: {rate_of(map(wrongly_named, lines))}."]
    if named:
        mean = f"{sum(told) / len(told):.2f}" if told else "-"
        text.append(
            f"Named classes that hold: {rate_of(held for held, _, _ in named)}; mean probability {mean}; "
            f"{sum(many for _, _, many in named) / len(named):.2f} names on average."
        )
    return "\n\n".join(text)


def main(arguments=None):
    """Print them; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.report.outcomes", description=__doc__.splitlines()[0]
    )
    parser.add_argument("scores", type=Path, nargs="+")
    options = parser.parse_args(arguments)
    try:
        # records of several draws have the same names
        lines = [line for path in options.scores for line in read_lines(path)]
    except OSError as error:
        parser.error(str(error))
    print(outcomes(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
