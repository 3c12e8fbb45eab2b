# SPDX-License-Identifier: BSD-3-Clause
"""One word for what came of a record."""

from itertools import permutations

from benchmarks.concealed.scoring.lines import (
    changed_names,
    classes_of,
    failed,
    held_classes,
    kind_of,
    refused,
    true_names,
    verdict_of,
)

HEALTHY = ("right", "alarm", "failed")
SINGLE = ("right", "wrong name", "cannot tell", "none of these", "missed", "failed")
PAIR = ("both found", "one found", "neither", "wrong name", "failed")
OUTSIDE = ("right", "cannot tell", "missed", "wrong name", "failed")
DEFECT = ("right", "wrong name", "missed", "failed")
WORDS = {"healthy": HEALTHY, "single": SINGLE, "pair": PAIR, "outside": OUTSIDE, "defect": DEFECT}
# findings about the data by which a defect of the columns is told
TELLING = ("swapped", "unit_suspect")


def wrongly_named(line):
    """Whether any class holds no true name, also where the verdict is that it cannot tell.

    On a healthy record, and on one whose effect no catalogue holds, every name is a wrong one. Held against
    a history that had another effect, the name of that is true of the change.
    """
    true = changed_names(line)
    # what a history held is told of the time before
    earlier = set((line["truth"].get("history") or {}).get("effects") or ())
    return any(not names & true for names in classes_of(line)) or any(
        not names & earlier for names in held_classes(line)
    )


def told_classes(line):
    """Names by class of what is told for sure: by the verdict ``named``, or as in the history already.

    What a history had already is no change since, and is told beside ``no_mismatch``.
    """
    return {"named": classes_of, "no_mismatch": held_classes}.get(verdict_of(line), lambda _: [])(line)


def found_names(line):
    """True names that are held by classes told for sure, each by a class of its own."""
    true, classes = sorted(true_names(line)), told_classes(line)
    best: set = set()
    # few names and few classes: every way of giving each name a class can be tried
    slots = classes + [set()] * len(true)
    for given in permutations(range(len(slots)), len(true)):
        held = {name for name, slot in zip(true, given, strict=True) if name in slots[slot]}
        best = max(best, held, key=len)
    return best


def judge(line):
    """One word for what came of a record: of `WORDS`, those of its kind.

    Healthy: ``right`` without mismatch, else ``alarm``. One effect: ``right`` where a class told for sure
    (`told_classes`) holds it and no class beside it is wrong, ``wrong name`` where any class holds no true
    name, and else what was said instead: ``cannot tell``, ``none of these``, ``missed``. Several effects:
    ``both found`` where each is held by a class of its own, ``one found``, ``neither``. Outside the
    catalogue: ``right`` is ``none_of_these`` without any name. Exchanged or mislabelled columns: ``right``
    where that is said, or no name is given. ``failed`` where the diagnosis broke.
    """
    kind, verdict = kind_of(line), verdict_of(line)
    if kind == "defect":
        return _of_defect(line)
    if failed(line):
        return "failed"
    if kind == "healthy":
        return "right" if verdict == "no_mismatch" else "alarm"
    if wrongly_named(line):
        return "wrong name"
    true = true_names(line)
    if not true:
        plain = {"none_of_these": "right", "cannot_tell": "cannot tell", "no_mismatch": "missed"}
        # a name that is not wrong is that of what a history held
        return plain.get(verdict, "missed" if classes_of(line) else "wrong name")
    found = found_names(line)
    if len(true) > 1:
        return "both found" if found == true else "one found" if found else "neither"
    if found:
        return "right"
    return {"cannot_tell": "cannot tell", "none_of_these": "none of these"}.get(verdict, "missed")


def _of_defect(line):
    """Of exchanged or mislabelled columns: ``right`` where that is said, or no name is given."""
    if failed(line):
        return "right" if refused(line) else "failed"
    told = {item.get("finding") for item in line["found"].get("data") or ()}
    if told & set(TELLING):
        return "right"
    if classes_of(line):
        return "wrong name"
    return "missed" if verdict_of(line) == "no_mismatch" else "right"
