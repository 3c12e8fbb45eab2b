# SPDX-License-Identifier: BSD-3-Clause
"""All methods beside each other, on the same records: by effect, by excitation, by concealment, by size."""

from collections import defaultdict

from benchmarks.concealed.report.breakdown import excitation, nasty, size
from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.scoring.lines import by_method, concealed, of_kind
from benchmarks.concealed.scoring.naming import class_right
from benchmarks.concealed.scoring.outcome import judge


def compared_by(lines, label, key):
    """Table of records with one effect: those named rightly, and how many wrongly, a column a method.

    Parameters
    ----------
    lines : list of dict
    label : str
        Head of the first column.
    key : callable
        Line -> name of its group, or a list of names.

    Returns
    -------
    text : str
        Markdown, or "-" where no line tells of it.
    """
    groups: dict = defaultdict(lambda: defaultdict(list))
    methods = by_method(lines)
    for method, some in methods.items():
        for line in of_kind(some, "single"):
            names = key(line)
            for name in [names] if isinstance(names, str) else names:
                groups[name][method].append(line)
    if set(groups) <= {"?"}:
        return "-"
    rows = [[name, *(_cell(groups[name][method]) for method in methods)] for name in sorted(groups)]
    return table([label, *methods], rows)


def _cell(lines):
    if not lines:
        return "-"
    wrong = sum(judge(line) == "wrong name" for line in lines)
    right = class_right(lines)
    return f"{right.count} of {right.of}, wrong {wrong}"


def comparison(lines):
    """Tables of `compared_by`; nothing where there is a single method."""
    if len(by_method(lines)) < 2:
        return ""
    by = (("effect", concealed), ("excitation", excitation), ("concealed by", nasty), ("size", size))
    return section("One effect, named rightly", *(compared_by(lines, *each) for each in by))
