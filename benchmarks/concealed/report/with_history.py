# SPDX-License-Identifier: BSD-3-Clause
"""What a history of the plant is worth: the same records judged without it and with it.

python -m benchmarks.concealed.report.with_history WITHOUT.jsonl WITH.jsonl
"""

import argparse
import sys
from pathlib import Path

from benchmarks.concealed.paired import row_of
from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.scoring.agreement import paired
from benchmarks.concealed.scoring.detection import uniformity
from benchmarks.concealed.scoring.lines import (
    distinguishable,
    failed,
    kind_of,
    of_kind,
    read_lines,
    size_step,
    told_mismatch,
)
from benchmarks.concealed.scoring.outcome import found_names, judge, wrongly_named
from benchmarks.concealed.scoring.rates import rate_of

HEAD = ["", "without", "with", "only without", "only with", "McNemar p"]


def _single(line):
    return kind_of(line) == "single"


def _healthy(line):
    return kind_of(line) == "healthy"


def _noticed(line):
    return bool(told_mismatch(line) or found_names(line))


def _judged(word):
    return lambda line: judge(line) == word


def _of_size(step):
    return lambda line: _single(line) and size_step(line) == step


def history_of(line):
    """What the truth tells of a record's history; nothing where it has none."""
    return line["truth"].get("history") or {}


def _plain(line):
    """Whether the history is clean and nothing was changed since."""
    return bool(history_of(line).get("clean")) and not history_of(line).get("allowed_change")


def change_of(line):
    """Name of the allowed change between history and record; None without."""
    return (history_of(line).get("allowed_change") or {}).get("change")


def other_excitation(line):
    """Whether the history was excited in another way than the record."""
    return history_of(line).get("excitation") not in (None, line["truth"].get("excitation"))


#: What is counted: label -> (which records, what of them).
COUNTED = {
    **{
        f"one effect noticed, {step:g} times the detectable size": (_of_size(step), _noticed)
        for step in (1.0, 2.0, 3.0)
    },
    "class right, distinguishable by the generator": (
        lambda line: _single(line) and distinguishable(line),
        _judged("right"),
    ),
    "class right, all with one effect": (_single, _judged("right")),
    "two effects, both found": (lambda line: kind_of(line) == "pair", _judged("both found")),
    "no catalogue, recognised": (lambda line: kind_of(line) == "outside", _judged("right")),
    "defect of the data, said": (lambda line: kind_of(line) == "defect", _judged("right")),
    "wrong name, of all records": (lambda line: True, wrongly_named),
    "the diagnosis broke, or was refused": (lambda line: True, failed),
}
#: The same of healthy records, where all that is told is an alarm.
ALARMS = {
    "alarm, all healthy": (_healthy, _noticed),
    "- clean history, nothing changed": (lambda line: _healthy(line) and _plain(line), _noticed),
    "-- of them excited in another way": (
        lambda line: _healthy(line) and _plain(line) and other_excitation(line),
        _noticed,
    ),
    "- by an allowed change alone": (lambda line: _healthy(line) and bool(change_of(line)), _noticed),
    "- history not clean": (
        lambda line: _healthy(line) and not history_of(line).get("clean", True),
        _noticed,
    ),
}
#: Of one effect, by what the history is.
BY_HISTORY = {
    "clean, excited as the record": lambda line: _plain(line) and not other_excitation(line),
    "clean, excited in another way": lambda line: _plain(line) and other_excitation(line),
    "allowed change since": lambda line: bool(change_of(line)),
    "holds the same": lambda line: history_of(line).get("holds") == "same",
    "holds another effect": lambda line: history_of(line).get("holds") == "another",
}


def rows_of(pairs, counted):
    """Rows of a table, of what any record is there for.

    Parameters
    ----------
    pairs : list of tuple of dict
        Lines of one record, without and with a history; which it is counted as is read from the latter.
    counted : dict
        Label -> (which records, what of them).
    """
    rows = []
    for label, (which, what) in counted.items():
        some = [(what(a), what(b)) for a, b in pairs if which(b)]
        if some:
            _, *counts, lost, won, by_chance = row_of(label, some)
            rates = [rate_of(answer[k] for answer in some) for k in (0, 1)]
            cells = [f"{count}, {rate}" for count, rate in zip(counts, rates, strict=True)]
            rows.append([label, *cells, lost, won, by_chance])
    return rows


def with_history_report(without, with_):
    """All tables, in Markdown, of the records that both files hold.

    Parameters
    ----------
    without, with_ : sequence of dict
        Lines of scores.

    Returns
    -------
    text : str
    """
    pairs = paired(without, with_)
    changes = sorted({change for _, line in pairs if (change := change_of(line))})
    by_change = {
        change: (lambda line, change=change: _healthy(line) and change_of(line) == change, _noticed)
        for change in changes
    }
    by_history = {
        f"{label}: {words}": (lambda line, which=which: _single(line) and which(line), what)
        for label, which in BY_HISTORY.items()
        for words, what in (
            ("noticed", _noticed),
            ("class right", _judged("right")),
            ("wrong", wrongly_named),
        )
    }
    laws = [[name, uniformity(of_kind(lines, "healthy"))] for name, lines in _sides(pairs)]
    parts = [
        section("Something concealed", table(HEAD, rows_of(pairs, COUNTED))),
        section("Healthy", table(HEAD, rows_of(pairs, ALARMS)), table(HEAD, rows_of(pairs, by_change))),
        section("One effect, by history", table(HEAD, rows_of(pairs, by_history))),
        section(
            "p-values of healthy records against the uniform law", table(["", "Kolmogorov-Smirnov"], laws)
        ),
    ]
    return "\n\n".join([f"{len(pairs)} records judged without and with a history.", *filter(None, parts)])


def _sides(pairs):
    """Lines without a history, with it, and with one that is clean and of an unchanged plant."""
    first, second = [a for a, _ in pairs], [b for _, b in pairs]
    plain = [line for line in second if _plain(line)]
    return ("without", first), ("with", second), ("with, clean and nothing changed", plain)


def main(arguments=None):
    """Print the tables; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.report.with_history", description=__doc__.splitlines()[0]
    )
    parser.add_argument("without", type=Path, help="scores of `sklvalve`")
    parser.add_argument("with_", type=Path, metavar="with", help="scores of `sklvalve_history`")
    options = parser.parse_args(arguments)
    try:
        lines = [read_lines(path) for path in (options.without, options.with_)]
    except OSError as error:
        parser.error(str(error))
    print(with_history_report(*lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
