# SPDX-License-Identifier: BSD-3-Clause
"""The lines of a detector as tables of Markdown."""

from benchmarks.damadics.runner import INVISIBLE, SOUND, visibility
from sklvalve.damadics import SCENARIOS
from sklvalve.damadics.indices import UNDEFINED

_INDICES = {
    "t_dt": ".0f",
    "fs_d": ".3g",
    "r_fd": ".3g",
    "r_td": ".3f",
    "t_it": ".0f",
    "r_ti": ".3f",
    "r_mi": ".2f",
    "dacc": ".2f",
}
_HEAD = (
    "scenario",
    "dX'",
    "dF'",
    "detected",
    *_INDICES,
    "faults pointed at last",
    "lacked the true one",
    "finder's last answer",
)


def tables(name, lines):
    """Table of the scenarios, and what sums it up.

    Parameters
    ----------
    name : str
        Of the detector.
    lines : dict
        Scenario -> line of `runner.score`, and the sound hours.

    Returns
    -------
    text : str
    """
    known = [lines[scenario] for scenario in SCENARIOS if scenario in lines]
    rows = [_row(line) for line in known]
    return "\n".join([f"### {name}", "", *_summary(known, lines.get(SOUND)), "", _table(_HEAD, rows), ""])


def detected(line):
    """Whether the decision was high while the fault was there."""
    return line["indices"]["r_td"] > 0.0


def visible(scenario):
    """Whether a fault at its largest changes a signal by more than the noise hides."""
    return max(visibility(scenario).values()) >= INVISIBLE


def missed(line):
    """Seconds for which faults were pointed at and the true one was not among them."""
    return sum(seconds for faults, seconds in line["pointed"].items() if line["fault"] not in faults.split())


def _row(line):
    change, found = visibility(line["scenario"]), line["indices"]
    medium = [
        f"{signal}' {change[signal]:.2g}" for signal in ("P1", "P2", "T1") if change[signal] >= INVISIBLE
    ]
    named = list(line["pointed"])[-1] if line["pointed"] else "-"
    return (
        line["scenario"],
        f"{change['X']:.4f}",
        " ".join([f"{change['F']:.4f}", *medium]),
        "yes" if detected(line) else "no" if visible(line["scenario"]) else "invisible",
        *(_index(found[index], digits) for index, digits in _INDICES.items()),
        named,
        f"{missed(line)} s" if missed(line) else "-",
        _answer(line["told"][-1]) if line["told"] else "-",
    )


def _index(value, digits):
    """An index; the one that cannot be had as the benchmark writes it."""
    return "-1" if value == UNDEFINED else format(value, digits)


def _answer(told):
    """What the finder said when it was asked last; in brackets where its simulation did not prove it."""
    named = " + ".join("/".join(names) for names in told.get("classes", []))
    if not named:
        return told["verdict"]
    return named if told["proven"] else f"({named})"


def _summary(known, sound):
    """Counts as sentences."""
    seen = [line for line in known if visible(line["scenario"])]
    unseen = [line for line in known if not visible(line["scenario"])]
    caught = [line for line in known if detected(line)]
    yield f"{len(known)} scenarios, seed {', '.join(sorted({str(line['seed']) for line in known}))}."
    yield _count("Detected of those that exceed the noise", [line for line in seen if detected(line)], seen)
    yield _count("Detected of those that do not", [line for line in unseen if detected(line)], unseen)
    right = [line for line in caught if line["fault"] in list(line["pointed"] or [""])[-1].split()]
    yield _count("Of the detected, the true fault among those pointed at last", right, caught)
    yield _count("Of the detected, never without it", [line for line in caught if not missed(line)], caught)
    sizes = [len(list(line["pointed"])[-1].split()) for line in right]
    if sizes:
        mean = sum(sizes) / len(sizes)
        yield f"- Faults pointed at last, where the true one is among them: {mean:.1f} in the mean."
    yield f"- Processor time {sum(line['seconds'] for line in known):.0f} s."
    if sound:
        high = sound["false"]
        yield f"- Sound hours with an alarm: {sum(share > 0.0 for share in high)} of {len(high)}."


def _count(what, some, of):
    short = [line["scenario"] for line in of if line not in some]
    return f"- {what}: {len(some)} of {len(of)}" + (f" (not {', '.join(short)})." if short else ".")


def _table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
