# SPDX-License-Identifier: BSD-3-Clause
"""Lines of scores: reading them, and what each says, whatever it leaves out."""

import gzip
import json
from collections import defaultdict
from pathlib import Path

from benchmarks.concealed.methods import WITH_HISTORY

KINDS = ("healthy", "single", "pair", "outside", "defect")
DEFAULT_METHOD = "sklvalve"
# Distance from the truth above which the generator calls another explanation distinguishable.
DISTINGUISHABLE = 14.0


def read_lines(*paths):
    """Lines of files of scores, in the order read; a file whose name ends in .gz is unpacked.

    A line that was cut off counts as not written; of two of one record by one method the later one counts.

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    """
    lines = {}
    for text in (text for path in paths for text in _text_of(Path(path)).splitlines()):
        try:
            line = json.loads(text)
        except json.JSONDecodeError:
            continue
        if isinstance(line, dict) and isinstance(line.get("truth"), dict):
            key = (method_of(line), line.get("folder"), line.get("record"))
            lines.pop(key, None)
            lines[key] = line
    return list(lines.values())


def _text_of(path):
    content = path.read_bytes()
    return (gzip.decompress(content) if path.suffix == ".gz" else content).decode("utf-8")


def method_of(line):
    """Name of the method that was judged."""
    return line.get("method") or DEFAULT_METHOD


def by_method(lines):
    """Lines of each method, in the order in which the methods come."""
    return grouped(lines, method_of)


def grouped(lines, key):
    """Lines by what `key` says of them; those of which it says None are left out."""
    groups = defaultdict(list)
    for line in lines:
        name = key(line)
        if name is not None:
            groups[name].append(line)
    return dict(groups)


# ---- the truth


def true_names(line):
    """Names in the catalogue of what was concealed."""
    return set(line["truth"].get("effects") or ())


def changed_names(line):
    """Names of what is not as it was: those of `true_names`, and of what a history held and has gone since.

    A recording held against a history tells of changes, and the end of a fault is one.
    """
    history = line["truth"].get("history") or {}
    gone = method_of(line) in WITH_HISTORY and history.get("holds") == "another"
    return true_names(line) | (set(history.get("effects") or ()) if gone else set())


def concealed(line):
    """The generator's own names of what was concealed, joined; "nothing" of a healthy record."""
    truth = line["truth"]
    return " + ".join(truth.get("concealed") or truth.get("effects") or ()) or "nothing"


def kind_of(line):
    """One of `KINDS`."""
    truth = line["truth"]
    if truth.get("kind") in KINDS:
        return truth["kind"]
    few = len(true_names(line))
    if few:
        return "single" if few == 1 else "pair"
    return "healthy" if truth.get("verdict", "no_mismatch") == "no_mismatch" else "outside"


def of_kind(lines, *kinds):
    """Lines of these kinds."""
    return [line for line in lines if kind_of(line) in kinds]


def excitation_of(line):
    """How the valve was moved; None where it is not told."""
    return line["truth"].get("excitation") or line["truth"].get("loop")


def size_step(line):
    """Size as so many times the detectable one, as planned; None where it is not told."""
    return line["truth"].get("size_step")


def times_of(line):
    """Size as so many times the detectable one, as drawn; of two effects, that of the smaller."""
    truth = line["truth"]
    if truth.get("times") is not None:
        return float(truth["times"])
    drawn = [d.get("times") for d in (truth.get("detectable") or {}).values() if isinstance(d, dict)]
    known = [float(times) for times in drawn if times is not None]
    return min(known) if known else size_step(line)


def distances_of(line):
    """Generator's distances (to nothing, least to any other effect, least of all); None where unknown."""
    told = line["truth"].get("distances") or {}
    nothing = told.get("nothing")
    others = [d for d in (told.get("others") or {}).values() if d is not None]
    other = min(others, default=None)
    return nothing, other, min((d for d in (nothing, other) if d is not None), default=None)


def distinguishable(line):
    """Whether the generator can tell the truth from all else; None where it does not say."""
    return line["truth"].get("distinguishable")


def distinguishable_only(lines):
    """Lines of which the generator says so."""
    return [line for line in lines if distinguishable(line) is True]


# ---- what was found


def failed(line):
    """Whether there is no diagnosis: it broke, or what there was to read was refused."""
    return "failed" in line or not line.get("found")


def refused(line):
    """Whether the recording was refused as bad input, with a sentence that says why."""
    return str(line.get("failed", "")).startswith("InputError")


def verdict_of(line):
    """Verdict; None where the diagnosis broke."""
    return None if failed(line) else line["found"].get("verdict")


def told_mismatch(line):
    """Whether any mismatch is told; None where the diagnosis broke."""
    return None if failed(line) else verdict_of(line) != "no_mismatch"


def held_classes(line):
    """Names by class of what is told as there in the history already, and not as gone since."""
    held = () if failed(line) else line["found"].get("held") or ()
    return [set(each["names"]) for each in held if each["change"] in ("none", "changed")]


def entries_of(line):
    """What was found, the strongest first: one entry a thing."""
    return [] if failed(line) else line["found"].get("effects") or []


def names_of(entry):
    """Names of a class, the most probable first."""
    return [member["name"] for member in entry.get("members") or ()]


def classes_of(line):
    """Names by class, the strongest class first."""
    return [set(names_of(entry)) for entry in entries_of(line)]


def location_of(line):
    """Where and when; empty where nothing is told."""
    return {} if failed(line) else line["found"].get("location") or {}
