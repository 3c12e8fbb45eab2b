# SPDX-License-Identifier: BSD-3-Clause
"""Results as Markdown: the failures first, then counts; and the block of the page that holds them."""

import json
from pathlib import Path

BEGIN, END = "<!-- results begin -->", "<!-- results end -->"
PAGE = Path(__file__).parents[2] / "docs" / "real_plants.md"
RESULTS = Path(__file__).parent / "results" / "results.jsonl"
_ORDER = ("wrong", "failed", "abstained", "unjudged", "right")
_HEAD = [
    "recording",
    "kind",
    "rows",
    "sampling [s]",
    "label",
    "verdict",
    "names",
    "judgement",
    "nominal",
    "black box",
    "corrected",
    "proof",
    "referee",
    "s",
]


def read(file):
    """Rows of a results file, the last of each recording; a line cut off by a crash is left out."""
    rows = {}
    for line in Path(file).read_text(encoding="utf-8").splitlines():
        try:
            row = json.loads(line)
        except json.JSONDecodeError:
            continue
        rows[row["recording"]] = row
    return list(rows.values())


def _name(effect):
    chance, grade = effect.get("probability"), effect.get("grade") or {}
    sure = f"{chance:.2f}" if chance is not None else grade.get("level", "?")
    kind = f" {effect['kind']}" if effect.get("kind") else ""
    return f"{'/'.join(effect['members'])} ({sure}{kind})"


def _label(label):
    if not label:
        return "-"
    names = "/".join([*label.get("faults", ()), *label.get("properties", ())])
    return ("sound" if label.get("sound") else "") + (": " if label.get("sound") and names else "") + names


def _number(value):
    return "-" if value is None else f"{value:.3g}"


def _line(row):
    errors = row.get("errors") or {}
    judgement = row["judgement"] + (", sure" if row["judgement"] == "wrong" and row.get("sure") else "")
    cells = [row["recording"], row["kind"], row["rows"], f"{row['sampling_s']:g}", _label(row.get("label"))]
    cells += [row["verdict"], "; ".join(map(_name, row.get("names", ()))) or "-", judgement]
    cells += [_number(errors.get(kind)) for kind in ("nominal", "black_box", "corrected")]
    cells += [errors.get("proof") or "-", ", ".join(row.get("referee", ())) or "-", f"{row['seconds']:.0f}"]
    return f"| {' | '.join(map(str, cells))} |"


def table(rows):
    """The whole table and the counts, as Markdown."""
    place = {judgement: k for k, judgement in enumerate(_ORDER)}

    def key(row):
        return place[row["judgement"]], not row.get("sure"), not row.get("referee"), row["recording"]

    head = [f"| {' | '.join(_HEAD)} |", "|---" * len(_HEAD) + "|"]
    return "\n".join([counts(rows), "", *head, *map(_line, sorted(rows, key=key))])


def counts(rows):
    """Counts by kind of recording."""
    lines = ["| kind | right | wrong | of these sure | abstained | unjudged | failed | referee's flags |"]
    lines.append("|---|---|---|---|---|---|---|---|")
    for kind in [*dict.fromkeys(row["kind"] for row in rows), "all"]:
        part = [row for row in rows if kind in (row["kind"], "all")]
        said = {j: sum(row["judgement"] == j for row in part) for j in _ORDER}
        sure = sum(row["judgement"] == "wrong" and bool(row.get("sure")) for row in part)
        flags = sum(bool(row.get("referee")) for row in part)
        cells = [
            said["right"],
            said["wrong"],
            sure,
            said["abstained"],
            said["unjudged"],
            said["failed"],
            flags,
        ]
        lines.append(f"| {kind} | {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def with_block(page, rows):
    """Text of a page with the results between its two markers replaced."""
    before, _, left = page.partition(BEGIN)
    _, found, after = left.partition(END)
    if not found:
        raise SystemExit(f"the page needs the two markers {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{table(rows)}\n{END}{after}"
