# SPDX-License-Identifier: BSD-3-Clause
"""What came of the records: by effect, by excitation, by way of concealing, by size."""

from collections import Counter, defaultdict

from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.scoring import calibration, detection, improvement, parameters
from benchmarks.concealed.scoring.lines import (
    concealed,
    distinguishable_only,
    excitation_of,
    of_kind,
    size_step,
)
from benchmarks.concealed.scoring.naming import mean_class_size
from benchmarks.concealed.scoring.outcome import WORDS, judge
from benchmarks.concealed.scoring.rates import Rate

LABELS = {
    "healthy": "nothing",
    "single": "one effect with a name",
    "pair": "several effects",
    "outside": "an effect of no catalogue",
    "defect": "columns exchanged or mislabelled",
}


def excitation(line):
    """How the valve was moved, and how noisy it was where that is told."""
    noise = line["truth"].get("noise")
    return (excitation_of(line) or "?") + ("" if noise is None else f", noise {noise:g}")


def nasty(line):
    """Ways of concealing, each of them a group of its own."""
    ways = line["truth"].get("nasty")
    return ["?"] if ways is None else sorted(set(ways)) or ["none"]


def size(line):
    """Planned size."""
    return "?" if size_step(line) is None else f"{size_step(line):g}"


def begins(line):
    """When it begins."""
    onset = line["truth"].get("onset")
    if not onset:
        return "?" if onset is None and "onset" not in line["truth"] else "from the start"
    abrupt = line["truth"].get("abrupt")
    return "later" if abrupt is None else "later, abrupt" if abrupt else "later, slowly"


def outcomes_by(lines, kind, label, key, clear=False):
    """Table of outcomes.

    Parameters
    ----------
    lines : list of dict
    kind : {"healthy", "single", "pair", "outside"}
        Which of them to count.
    label : str
        Head of the first column.
    key : callable
        Line -> name of its group, or a list of names where it is in several.
    clear : bool
        Adds the rate of what the generator calls distinguishable.

    Returns
    -------
    text : str
        Markdown, or "-" where there is no such record or only "?" to tell of it.
    """
    some = of_kind(lines, kind)
    groups = defaultdict(list)
    for line in some:
        names = key(line)
        for name in [names] if isinstance(names, str) else names:
            groups[name].append(line)
    if set(groups) <= {"?"}:
        return "-"
    words = WORDS[kind]
    shown = ("alarm",) if kind == "healthy" else (words[0], "wrong name")
    rows = []
    for name, group in [*sorted(groups.items()), ("all", some)]:
        counted = Counter(judge(line) for line in group)
        cells = [name, len(group), *(counted[word] for word in words)]
        cells += [Rate(counted[word], len(group)) for word in shown]
        if clear:
            cells.append(_clear_rate(group, words[0]))
        if kind == "single":
            held = mean_class_size(group)
            cells.append(f"{held.value:.1f}" if held.of else "-")
        rows.append(cells)
    head = [label, "records", *words, *(f"{word} (95 %)" for word in shown)]
    head += ["of distinguishable"] if clear else []
    return table(head + (["mean class"] if kind == "single" else []), rows)


def _clear_rate(lines, word):
    clear = distinguishable_only(lines)
    return Rate(sum(judge(line) == word for line in clear), len(clear))


def overview(lines):
    """Table of outcomes by kind of record."""
    rows = []
    for kind, label in LABELS.items():
        some = of_kind(lines, kind)
        counted = Counter(judge(line) for line in some)
        first, *others = WORDS[kind]
        words = ", ".join(f"{word} {counted[word]}" for word in others if counted[word]) or "-"
        if some:
            rows.append(
                [label, len(some), f"{first} {counted[first]}", Rate(counted[first], len(some)), words]
            )
    return table(["concealed", "records", "as it should be", "(95 %)", "else"], rows)


def outcomes(lines):
    """All tables of outcomes, of one method."""
    clear = any(line["truth"].get("distinguishable") is not None for line in lines)
    single = [
        outcomes_by(lines, "single", label, key, clear)
        for label, key in (
            ("effect", concealed),
            ("excitation", excitation),
            ("begins", begins),
            ("concealed by", nasty),
            ("size", size),
        )
    ]
    healthy = [outcomes_by(lines, "healthy", *by) for by in (("excitation", excitation), ("nasty by", nasty))]
    parts = [
        section("All", overview(lines)),
        section("Healthy", *healthy),
        section("One effect with a name", *single),
        section("One effect that no catalogue holds", outcomes_by(lines, "outside", "effect", concealed)),
        section("Two effects", outcomes_by(lines, "pair", "effects", concealed)),
    ]
    return "\n\n".join(part for part in parts if part)


def power_table(lines):
    """Power against size: as planned, and as drawn."""
    planned, drawn = detection.power(lines), detection.power_by_times(lines)
    head = ["times the detectable size", "records", "mismatch told", "named rightly"]
    parts = [
        table(head, [[p.label, p.detected.of, p.detected, p.right] for p in rows])
        for rows in (planned, drawn)
    ]
    return section("Power against size", *parts)


def accuracy_table(lines):
    """Main parameters, by effect and by size."""
    head = ["found first", "no interval", "holds it", "coverage (95 %)", "median error", "nine in ten below"]
    by_effect = [*parameters.accuracy_by_effect(lines), ("all", parameters.accuracy(lines))]
    by_size = [(f"{step:g}", a) for step, a in parameters.accuracy_by_size(lines)]
    words = "Whether the 95 % interval of the main parameter holds the true size. Not looked at:\n\n"
    words += "\n".join(f"- {reason}" for reason in parameters.NOT_ONE_QUANTITY)
    parts = [
        table([label, *head], [[name, *_accuracy(a)] for name, a in rows])
        for label, rows in (("effect", by_effect), ("size", by_size))
    ]
    return section("Main parameters", words, *parts)


def _accuracy(a):
    held = a.coverage
    return [a.of, a.of - held.of, held.count, held, a.median, a.ninth]


def improvement_table(lines):
    """Skill on later rows, by channel."""
    rows = [[i.channel, i.skill, i.oracle, i.no_harm] for i in improvement.improvement(lines)]
    if all(str(cell) == "-" for row in rows for cell in row[1:]):
        return ""
    head = ["channel", "pooled skill", "share of the oracle's gain", "no harm"]
    return section("Agreement with the truth without noise", table(head, rows))


def calibration_table(lines):
    """Reliability of the probabilities of classes."""
    rows = [
        [f"{b.low:.1f}-{b.high:.1f}", b.true.of, f"{b.mean:.3f}", b.true]
        for b in calibration.calibration(lines).bins
    ]
    head = ["probability told", "classes", "mean told", "true (95 %)"]
    return section("Probabilities of classes", table(head, rows))
