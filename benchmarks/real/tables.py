# SPDX-License-Identifier: BSD-3-Clause
"""Results as Markdown: the failures first, then counts; and the block of the page that holds them."""

import json
from pathlib import Path

from benchmarks.concealed.report import markdown
from benchmarks.concealed.scoring.rates import Rate
from benchmarks.real.recordings import OUTSIDE, SIMULATED

BEGIN, END = "<!-- results begin -->", "<!-- results end -->"
PAGE = Path(__file__).parents[2] / "docs" / "real_plants.md"
RESULTS = Path(__file__).parent / "results" / "results.jsonl"
_ORDER = ("wrong", "failed", "abstained", "unjudged", "right")
#: Of several recordings of one valve the first of these that any has is the valve's.
_OF_A_VALVE = ("wrong", "right", "abstained")
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


def right_sizes(row):
    """Numbers of names in the classes that hold a label; empty where no name was right."""
    label = row.get("label") or {}
    labelled = {*label.get("faults", ()), *label.get("properties", ())}
    classes = [effect["members"] for effect in row.get("names", ())] if row["judgement"] == "right" else []
    return [len(members) for members in classes if labelled & set(members)]


def valve_of(row):
    """What was recorded: the refinery's tag, the motor, the valve of a network, or the recording itself."""
    name = row["recording"]
    if name.startswith("refinery_"):
        return row["note"].split(";")[0]
    if name.startswith("belimo_"):
        return "motor"
    return name.removesuffix("_all") if name.startswith("watersafe_") else name


def _judgement(row):
    sizes = right_sizes(row)
    if sizes:
        return f"right, of {', '.join(map(str, sizes))} name{'' if sizes == [1] else 's'}"
    return row["judgement"] + (", sure" if row["judgement"] == "wrong" and row.get("sure") else "")


def _line(row):
    errors, judgement = row.get("errors") or {}, _judgement(row)
    cells = [row["recording"], row["kind"], row["rows"], f"{row['sampling_s']:g}", _label(row.get("label"))]
    cells += [row["verdict"], "; ".join(map(_name, row.get("names", ()))) or "-", judgement]
    cells += [_number(errors.get(kind)) for kind in ("nominal", "black_box", "corrected")]
    cells += [errors.get("proof") or "-", ", ".join(row.get("referee", ())) or "-", f"{row['seconds']:.0f}"]
    return cells


def table(rows):
    """The whole table and the counts, as Markdown."""
    place = {judgement: k for k, judgement in enumerate(_ORDER)}

    def key(row):
        return place[row["judgement"]], not row.get("sure"), not row.get("referee"), row["recording"]

    return "\n".join([counts(rows), "", markdown.table(_HEAD, map(_line, sorted(rows, key=key)))])


def counts(rows):
    """Counts by kind of recording, and by valve, those of a simulator apart from the real ones."""
    head = ["recordings", "right", "wrong", "of these sure", "abstained", "unjudged", "failed"]
    head += ["referee's flags", "names in a right class"]
    real = [row for row in rows if row["kind"] != SIMULATED]
    kinds = dict.fromkeys(row["kind"] for row in real)
    groups = [(kind, [row for row in real if row["kind"] == kind]) for kind in kinds]
    groups += [("all real", real), (SIMULATED, [row for row in rows if row["kind"] == SIMULATED])]
    lines = [markdown.table(head, [_counted(name, part) for name, part in groups if part])]
    valves = valves_of(real)
    by_recording, by_valve = _share_wrong(row["judgement"] for row in real), _share_wrong(valves.values())
    lines += ["", f"Wrong answers of real recordings, in brackets the 95 % interval: {by_recording};"]
    lines += [f"counted by valve {by_valve}.", ""]
    said = ("right", "wrong", "abstained")
    by_kind = []
    for kind in [*(kind for kind in kinds if kind != OUTSIDE), "all real"]:
        words = [word for (of, _), word in valves.items() if kind in (of, "all real")]
        by_kind.append([kind, *map(words.count, said)])
    return "\n".join([*lines, markdown.table(["valves", *said], by_kind)])


def _share_wrong(words):
    """How many answers are wrong, of how many, with the interval."""
    words = list(words)
    rate = Rate(words.count("wrong"), words.count("wrong") + words.count("right"))
    return f"{rate.count} of {rate.of}, {rate}" if rate.of else "none"


def valves_of(rows):
    """(Kind, valve) -> what came of the valve: wrong if any of its recordings is, else right if any is."""
    words = {}
    for row in rows:
        if row["judgement"] in _OF_A_VALVE:
            words.setdefault((row["kind"], valve_of(row)), []).append(row["judgement"])
    return {valve: min(several, key=_OF_A_VALVE.index) for valve, several in words.items()}


def _counted(name, part):
    said = {j: sum(row["judgement"] == j for row in part) for j in _ORDER}
    sure = sum(row["judgement"] == "wrong" and bool(row.get("sure")) for row in part)
    flags = sum(bool(row.get("referee")) for row in part)
    sizes = sorted({max(right_sizes(row)) for row in part if right_sizes(row)})
    named = " to ".join(map(str, dict.fromkeys((sizes[0], sizes[-1])))) if sizes else "-"
    cells = [name, said["right"], said["wrong"], sure]
    return [*cells, said["abstained"], said["unjudged"], said["failed"], flags, named]


def with_block(page, rows):
    """Text of a page with the results between its two markers replaced."""
    before, _, left = page.partition(BEGIN)
    _, found, after = left.partition(END)
    if not found:
        raise SystemExit(f"the page needs the two markers {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{table(rows)}\n{END}{after}"
