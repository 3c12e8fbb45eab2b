# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis as a few lines for the terminal, or as Markdown."""

import re
from collections.abc import Callable
from functools import partial
from textwrap import fill

from sklvalve.report import compared, proof, rows
from sklvalve.report.headline import glance, headline
from sklvalve.report.sentence import summary_sentence
from sklvalve.report.since_history import TITLE, allowances_words, section
from sklvalve.report.unnoticed import UNNOTICED, unnoticed
from sklvalve.report.words import either, with_units

__all__ = ["summary_sentence", "to_markdown", "to_text"]

_WIDTH, _NARROWEST = 96, 40
_INDENT = 14
# hypotheses of a difference that a terminal shows
_COMPARED = 3
# what the top of a report says besides the finding, in the width of a label
_LABELS = {
    "How sure": "How sure",
    "What to do next": "Do next",
    "What correcting it brings": "Benefit",
    "What was assumed": "Assumed",
}
# what Markdown or HTML would act upon: marks, tags, entities, the address of a link
_MARKS = re.compile(r"[\\`*]|(?<!\w)_|_(?!\w)|<(?=[A-Za-z/!?])|&(?=#?\w+;)|(?<=\])\(")


def to_text(d: dict, *, width: int = _WIDTH) -> str:
    """Lay a diagnosis out as plain text for a terminal.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.
    width : int, default=96
        Characters in a line; taken for 40 where it is less, and the table of errors keeps its own width.

    Returns
    -------
    text : str
        Lines of ASCII, as far as the diagnosis itself is.

    Examples
    --------
    >>> from sklvalve.report import to_text
    >>> mismatch = {"detected": False, "p_value": 0.43, "alpha": 0.01}
    >>> print(to_text({"verdict": "no_mismatch", "mismatch": mismatch, "fit": {}}))
    Finding       Nothing is missing: simulation and recording agree within noise and data-sheet
                  tolerances.
    How sure      No sign of a fault.
    Do next       Nothing needs to be done.
    <BLANKLINE>
    Details       Test for any mismatch: p = 0.43, level 0.01.
    """
    line = partial(_line, width=max(width, _NARROWEST))
    lines = [line("Finding", headline(d))]
    lines += [line(_LABELS[what], words) for what, words in glance(d)]
    found = rows.explanations(d)
    for count, item in enumerate(found, start=1):
        label = "Candidate" if d["verdict"] == "cannot_tell" else "Explanation"
        label += f" {count}" if len(found) > 1 else ""
        lines += ["", line(label, f"{item.placed}: {item.sure}")]
        if len(item.members) > 1:
            shown = [name if p is None else f"{name} {share}" for name, p, share in item.members]
            lines.append(line("", "; ".join(shown)))
        lines += [line("", item.grade)] if item.grade else []
        lines += [line("", f"{name} {value}") for name, value in item.parameters]
        lines += [line("", words) for words in (item.sentence,) if words]
        if item.separated_by and len(item.members) > 1:
            lines.append(line("", f"To distinguish them: {item.separated_by}"))
    lines += _block(
        [
            line("Unexplained" if first else "", f"{what}: {words}")
            for first, (what, words) in _numbered(rows.unexplained(d))
        ]
    )
    lines += _block([line(label, words) for label, words in rows.places(d)])
    lines += _block(_since_lines(d, line))
    lines += _block(_error_lines(d, line))
    lines += _block([line("Not testable" if first else "", words) for first, words in _numbered(_by_need(d))])
    lines += _block(
        [line("Unnoticed" if first else "", words) for first, words in _numbered(_unnoticed_lines(d))]
    )
    lines += _block(
        [
            line("Data" if first else "", f"{role}, {finding}: {detail}")
            for first, (role, finding, detail) in _numbered(rows.data_findings(d))
        ]
    )
    lines += _block([line("Details" if first else "", w) for first, w in _numbered(rows.details(d))])
    lines += _compared_lines(d, line)
    return "\n".join(lines)


def to_markdown(d: dict) -> str:
    """Lay a diagnosis out as Markdown, with the same content as `to_text`.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.

    Returns
    -------
    text : str

    Examples
    --------
    >>> from sklvalve.report import to_markdown
    >>> mismatch = {"detected": False, "p_value": 0.43, "alpha": 0.01}
    >>> print(to_markdown({"verdict": "no_mismatch", "mismatch": mismatch, "fit": {}}))
    **Nothing is missing: simulation and recording agree within noise and data-sheet tolerances.**
    <BLANKLINE>
    - How sure: No sign of a fault.
    - What to do next: Nothing needs to be done.
    <BLANKLINE>
    ### Details
    <BLANKLINE>
    - Test for any mismatch: p = 0.43, level 0.01.
    """
    parts = [f"**{_safe(headline(d))}**"]
    besides = [f"- {what}: {_safe(words)}" for what, words in glance(d)]
    parts += ["\n".join(besides)] if besides else []
    for item in rows.explanations(d):
        lines = [f"### {_safe(item.name[:1].upper() + item.name[1:])} ({item.sure}, {_safe(item.blocks)})"]
        lines += [_safe(words) for words in (item.grade, item.sentence) if words]
        if item.parameters:
            lines.append(_table(("parameter", "value [95 % interval]"), item.parameters))
        if len(item.members) > 1:
            lines.append(
                _table(("could be", "probability"), [(name, share) for name, _, share in item.members])
            )
            if item.separated_by:
                lines.append(f"To distinguish them: {_safe(item.separated_by)}")
        parts.append("\n\n".join(lines))
    if rows.unexplained(d):
        parts.append("### What no known effect explains\n\n" + _table(("what", "words"), rows.unexplained(d)))
    if rows.places(d):
        parts.append("### Where\n\n" + _table(("what", "where"), rows.places(d)))
    parts += _since_parts(d)
    if rows.errors(d):
        cells = [(name, *values) for name, values in rows.errors(d)]
        table = _table((f"error {proof.heading(d)}", *rows.models(d).values()), cells)
        parts.append("### Error\n\n" + "\n\n".join([table, *map(_safe, rows.proof_notes(d))]))
    if rows.untestable(d):
        lines = [f"- {_safe(words)}" for words in _by_need(d)]
        parts.append("### Not testable\n\n" + "\n".join(lines))
    if _unnoticed_lines(d):
        first, *lists = map(_safe, _unnoticed_lines(d))
        parts.append("### Unnoticed\n\n" + "\n".join([first, "", *(f"- {words}" for words in lists)]))
    if rows.data_findings(d):
        table = _table(("signal", "finding", "detail"), rows.data_findings(d))
        parts.append("### Data\n\n" + table)
    if rows.details(d):
        parts.append("### Details\n\n" + "\n".join(f"- {_safe(words)}" for words in rows.details(d)))
    for place in compared.comparisons(d):
        title = f"### Why this and not that{': ' + place.title.lower() if place.title else ''}"
        parts.append(title + "\n\n" + _table(compared.HEAD, place.rows))
    if compared.rules(d):
        parts.append("### Checks\n\n" + _table(compared.RULES_HEAD, compared.rules(d)))
    return "\n\n".join(parts)


def _line(label: str, words: str, width: int) -> str:
    # a long word, such as a path, is left whole rather than broken
    # a name from a file must not command the terminal
    words = "".join(letter if letter.isprintable() else " " for letter in words)
    filled = fill(
        with_units(words),
        width,
        initial_indent=f"{label:<{_INDENT}}",
        subsequent_indent=" " * _INDENT,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return filled.replace("\N{NO-BREAK SPACE}", " ")


def _block(lines: list[str]) -> list[str]:
    return ["", *lines] if lines else []


def _numbered(items: list) -> list:
    return [(place == 0, item) for place, item in enumerate(items)]


def _by_need(d: dict) -> list[str]:
    """Effects by what would be needed to test them."""
    return [f"Without {needs}: {either(names, 'and')}." for needs, names in rows.untestable_by_need(d)]


def _unnoticed_lines(d: dict) -> list[str]:
    """What might have gone unnoticed; nothing where something was found."""
    told = [f"{each.where}: {each.words}." for each in unnoticed(d)]
    return [UNNOTICED, *told] if told else []


def _error_lines(d: dict, line: Callable[[str, str], str]) -> list[str]:
    table = rows.errors(d)
    if not table:
        return []
    heading = proof.heading(d)
    width = max(len(heading), *(len(name) for name, _ in table))
    head = " ".join(f"{name:>11}" for name in rows.models(d).values())
    lines = [f"{'Error':<{_INDENT}}{heading:<{width}} {head}"]
    for name, cells in table:
        lines.append(f"{'':<{_INDENT}}{name:<{width}} " + " ".join(f"{cell:>11}" for cell in cells))
    return lines + [line("", words) for words in rows.proof_notes(d)]


def _since_lines(d: dict, line: Callable[[str, str], str]) -> list[str]:
    """What changed since the history, and what that rests on; nothing without one."""
    since = section(d)
    if since is None:
        return []
    told = [f"{what}: {words}" for what, words in since["facts"]]
    told += [
        f"{name}: {then} then, {now} now (expected {expected}; off by {apart} times its standard deviation)"
        for name, then, expected, now, apart in since["rows"]
    ]
    told += [since["caution"]] if since["rows"] else []
    told += [f"May change without a fault. {allowances_words(d['since_history'])}", *since["cannot_say"]]
    return [line("Since history" if first else "", words) for first, words in _numbered(told)]


def _since_parts(d: dict) -> list[str]:
    """The same as Markdown."""
    since = section(d)
    if since is None:
        return []
    parts = [f"### {TITLE}", _table(("what", "words"), since["facts"])]
    if since["rows"]:
        parts += [_table(since["head"], since["rows"]), _safe(since["caution"])]
    listed = [f"- {_safe(words)}" for words in since["cannot_say"]]
    listed.append(f"- May change without a fault. {_safe(allowances_words(d['since_history']))}")
    return [*parts, "\n".join(listed)]


def _compared_lines(d: dict, line: Callable[[str, str], str]) -> list[str]:
    """The likeliest hypotheses of each difference, and the checks that a name did not pass."""
    lines = []
    for item in compared.comparisons(d):
        title = f"{item.title}: " if item.title else ""
        told = [_weighed(row) for row in item.rows[:_COMPARED]]
        lines.append(title + "; ".join(told))
    # where nothing is missing no check stopped a name
    asked = compared.rules(d) if d["verdict"] != "no_mismatch" else []
    stopped = [f"Not passed, {what}: {words}" for what, passed, words in asked if passed == "no"]
    return _block([line("Compared" if first else "", w) for first, w in _numbered(lines)]) + _block(
        [line("Checks" if first else "", w) for first, w in _numbered(stopped)]
    )


def _weighed(row: tuple[str, ...]) -> str:
    """One hypothesis of a difference, with its weight and its gain where that is known."""
    return f"{row[0]} {row[-1]}" + (f", gain {row[3]} nats" if row[3] else "")


def _table(head: tuple[str, ...], body: list) -> str:
    lines = [head, tuple("---" for _ in head), *body]
    return "\n".join("| " + " | ".join(_cell(cell) for cell in line) + " |" for line in lines)


def _cell(words: str) -> str:
    return _safe(words).replace("|", "\\|")


def _safe(words: str) -> str:
    """Words, which may hold names from a file, as Markdown shows them: no HTML, no emphasis, no links."""
    return _MARKS.sub(r"\\\g<0>", " ".join(words.split()))
