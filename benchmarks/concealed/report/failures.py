# SPDX-License-Identifier: BSD-3-Clause
"""What still fails, by name."""

from collections import Counter

from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.scoring.lines import (
    changed_names,
    concealed,
    entries_of,
    excitation_of,
    failed,
    grouped,
    kind_of,
    names_of,
    size_step,
    verdict_of,
)
from benchmarks.concealed.scoring.outcome import judge, wrongly_named

GOOD = ("right", "both found")
INSTEAD = ("one found", "neither", "cannot tell", "none of these", "missed", "failed")


def told(line):
    """Classes told, as "a/b + c"."""
    return " + ".join("/".join(names_of(entry)) for entry in entries_of(line)) or "-"


def wrong_classes(line):
    """Classes without a true name, as "a/b"."""
    return ["/".join(names_of(e)) for e in entries_of(line) if not set(names_of(e)) & changed_names(line)]


def by_name(lines):
    """Table of what is concealed and not found, the worst first: what was said instead."""
    rows = []
    for name, group in grouped(lines, concealed).items():
        counted = Counter(judge(line) for line in group)
        bad = len(group) - sum(counted[word] for word in GOOD)
        if bad:
            called = Counter(c for line in group for c in wrong_classes(line))
            words = ", ".join(f"{c} ({n})" for c, n in called.most_common()) or "-"
            cells = [counted[word] for word in INSTEAD]
            rows.append((bad / len(group), [name, len(group), bad, *cells, words]))
    rows.sort(key=lambda item: (-item[0], item[1][0]))
    return table(
        ["concealed", "records", "not right", *INSTEAD, "called instead"], [cells for _, cells in rows]
    )


def wrong_records(lines):
    """Table of every record with an alarm or a wrong name."""
    rows = [
        [
            line.get("record", "?"),
            concealed(line),
            excitation_of(line) or "-",
            "-" if size_step(line) is None else f"{size_step(line):g}",
            ", ".join(line["truth"].get("nasty") or ()) or "-",
            verdict_of(line),
            told(line),
        ]
        for line in lines
        if judge(line) == "alarm" or wrongly_named(line)
    ]
    return table(["record", "concealed", "excitation", "size", "concealed by", "verdict", "told"], rows)


def broken(lines):
    """Table of diagnoses that broke."""
    messages = Counter(str(line.get("failed", "no result")) for line in lines if failed(line))
    return table(["no diagnosis", "records"], messages.most_common())


def doubtful(lines):
    """Sentence on wrong names that are candidates only."""
    some = [line for line in lines if kind_of(line) == "single" and judge(line) == "wrong name"]
    few = sum(verdict_of(line) == "cannot_tell" for line in some)
    return f"Of the wrong names of one effect, {few} are candidates only, under the verdict cannot_tell."


def failures(lines):
    """All of these, of one method."""
    parts = [by_name(lines), wrong_records(lines), broken(lines), doubtful(lines)]
    return section("What fails", *parts)
