# SPDX-License-Identifier: BSD-3-Clause
"""Tables of what came of the tests."""

from collections import Counter

from benchmarks.concealed.next_test import outcome as of
from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.scoring.rates import rate_of

_HEAD = ("effect", "record", "class before", "program", "to part", "D reached", "class after", "outcome")


def tables(lines):
    """Rates with exact intervals, and a row for every ambiguous record, as Markdown.

    Parameters
    ----------
    lines : list of dict
        Of `trial.line_of`.
    """
    ambiguous = [line for line in lines if line["outcome"] is not None]
    return "\n\n".join(
        [
            f"{len(lines)} records drawn, {len(ambiguous)} left ambiguous with the truth among the members.",
            table(("what", "of", "rate"), _rates(ambiguous)),
            table(_HEAD, map(_row, ambiguous)),
        ]
    ) + "\n"  # fmt: skip


def _rates(lines):
    judged = [line for line in lines if line["outcome"] in of.JUDGED]
    yield _rate("tests that split the class rightly", [line["outcome"] == of.SPLIT for line in judged])
    for name in (of.LOST, of.LEFT, of.TOO_MUCH, of.WRONG):
        yield _rate(name, [line["outcome"] == name for line in judged])
    names = [(line, n) for line in judged for n in line["promised"] if n in line["reached"]]
    kept = [line["reached"][n] >= of.APART for line, n in names]
    yield _rate("promised pairs that the plant's distances do tell apart", kept)
    without = [line for line in lines if line["outcome"] in (of.NO_PROGRAM, of.NO_PROMISE)]
    said = [line["true"] for line in without if line["true"] is not None]
    yield _rate("records told that no program parts them, and it is true", said)
    others = Counter(line["outcome"] for line in lines if line["outcome"] not in of.JUDGED)
    for name, many in sorted(others.items()):
        yield name, many, "-"


def _rate(name, answers):
    return name, len(answers), rate_of(answers)


def _row(line):
    reached = line.get("reached") or line.get("at_best") or {}
    return (
        line["effect"].replace("_", " "),
        f"{line['excitation']}, {line['step']:g}",
        _names(line["before"]),
        line.get("program", "none"),
        _names(line.get("promised", [])),
        ", ".join(f"{name.replace('_', ' ')} {d:.0f}" for name, d in reached.items()),
        " + ".join(_names(c, "/") for c in line.get("after", [])),
        line["outcome"],
    )


def _names(names, joined=", "):
    return joined.join(name.replace("_", " ") for name in names)
