# SPDX-License-Identifier: BSD-3-Clause
"""python -m benchmarks.concealed.inject.judge FOLDER [--method sklvalve]: diagnose, and tell what came of it.

Lines of JSON go to scores_<method>.jsonl in FOLDER as soon as a record is diagnosed; started again, it goes
on where it stopped. A record is judged against its untouched twin: a name counts as right where the twin has
it not, and only names that the twin has not are wrong ones. A method that is given a history gets the
untouched other stretches of the same valve; loops of the refinery have none, and are left out.
"""

import argparse
import json
import time
from collections import Counter, defaultdict
from pathlib import Path

from benchmarks.concealed.methods import WITH_HISTORY
from benchmarks.concealed.run import whole_lines

OUTCOMES = ("right", "wrong name", "cannot tell", "none of these", "missed", "in the base already", "failed")


def diagnosed(folder, method, history=()):
    """One line of scores; `history` are folders of records of the same valve."""
    from benchmarks.concealed.methods import method as of
    from benchmarks.concealed.methods import public
    from sklvalve import read_recording

    line = {"record": folder.name, "folder": folder.parent.name, "method": method}
    began = time.process_time()
    try:
        recording = read_recording(folder / "recording.csv.gz", folder / "valve.toml")
        more = {}
        if history:
            # by the sheet of the record: each stretch of a valve without one has its own
            more["history"] = [read_recording(h / "recording.csv.gz", folder / "valve.toml") for h in history]
        line["found"] = public(of(method)(recording, folder=folder.parent / "learnt", **more))
    except Exception as error:
        # a diagnosis that breaks is an outcome too, and no reason to leave the others undone
        line["failed"] = f"{type(error).__name__}: {error}"
    line["seconds"] = round(time.process_time() - began, 1)
    line["truth"] = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    return line


def other_stretches(truths):
    """Folder of a record -> folders of the untouched other stretches of its valve, those that have any.

    Parameters
    ----------
    truths : dict
        Folder -> truth of the record.
    """
    untouched = {folder: truth["base"] for folder, truth in truths.items() if truth["kind"] == "healthy"}
    found = {}
    for folder, truth in truths.items():
        valve = truth["base"].split(",")[0]
        others = [f for f, base in untouched.items() if base.split(",")[0] == valve and base != truth["base"]]
        if others and truth["generator"] != "injected/refinery":
            found[folder] = sorted(others)
    return found


def names_of(line):
    """Sets of names, a class each."""
    effects = line.get("found", {"effects": []})["effects"]
    return [{member["name"] for member in effect["members"]} for effect in effects]


def outcome(line, twin=None):
    """What came of one record, given the line of its untouched twin."""
    truth = line["truth"]
    if "failed" in line:
        return "failed"
    verdict, classes = line["found"]["verdict"], names_of(line)
    if truth["kind"] == "healthy":
        return "right" if verdict == "no_mismatch" else "wrong name" if classes else verdict.replace("_", " ")
    true = set(truth["effects"])
    before = set().union(*names_of(twin)) if twin is not None else set()
    if true & before:
        return "in the base already"
    if any(not names & (true | before) for names in classes):
        return "wrong name"
    if verdict == "named" and any(names & true for names in classes):
        return "right"
    return {"cannot_tell": "cannot tell", "none_of_these": "none of these"}.get(verdict, "missed")


def table(lines):
    """Counts by source, by size and by what the distances say, as Markdown."""
    by_name = {line["record"]: line for line in lines}
    groups = defaultdict(Counter)
    for line in lines:
        truth = line["truth"]
        what = outcome(line, by_name.get(truth.get("twin")))
        source = truth["generator"].split("/")[-1]
        if truth["kind"] == "healthy":
            groups[f"{source}, untouched"][what] += 1
            continue
        groups[f"{source}, one effect"][what] += 1
        groups[f"all, {truth['size_step']:g} times the detectable size"][what] += 1
        groups["all, can be told apart" if truth["distinguishable"] else "all, cannot be told apart"][
            what
        ] += 1
        groups["all, one effect"][what] += 1
    out = ["| | records | " + " | ".join(OUTCOMES) + " |", "|---" * (len(OUTCOMES) + 2) + "|"]
    for name in sorted(groups):
        counts = groups[name]
        cells = [name, sum(counts.values()), *(counts[what] for what in OUTCOMES)]
        out.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(out)


def sentence(line, twin=None):
    """One record in one line."""
    truth = line["truth"]
    what = outcome(line, twin)
    found = " + ".join("/".join(sorted(names)) for names in names_of(line)) or "-"
    verdict = line["found"]["verdict"] if "found" in line else line["failed"]
    step = "" if truth["size_step"] is None else f" x{truth['size_step']:g} from {truth['onset']:g} s"
    concealed = " + ".join(truth["concealed"]) or "-"
    return f"{line['record']} {truth['base']}: {concealed}{step}; {verdict}: {found}; {what}"


def main(arguments=None):
    """Diagnose what is not diagnosed yet, then print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.concealed.inject.judge", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--method", default="sklvalve")
    options = parser.parse_args(arguments)
    out = options.folder / f"scores_{options.method}.jsonl"
    lines = whole_lines(out)
    done = {line["record"] for line in lines}
    # the untouched ones first, against which the others are judged
    kind = lambda path: json.loads(path.read_text(encoding="utf-8"))["kind"] != "healthy"  # noqa: E731
    truths = sorted(options.folder.glob("*/truth.json"), key=lambda path: (kind(path), path))
    if options.method == "random_forest":
        from benchmarks.concealed.methods.random_forest import learn

        learn(options.folder / "learnt")
    others = {}
    if options.method in WITH_HISTORY:
        others = other_stretches(
            {path.parent: json.loads(path.read_text(encoding="utf-8")) for path in truths}
        )
        truths = [path for path in truths if path.parent in others]
    for folder in (path.parent for path in truths):
        if folder.name not in done:
            lines.append(diagnosed(folder, options.method, others.get(folder, ())))
            with out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(lines[-1]) + "\n")
    by_name = {line["record"]: line for line in lines}
    for line in sorted(lines, key=lambda one: one["record"]):
        print(sentence(line, by_name.get(line["truth"].get("twin"))))
    print("\n" + table(lines))


if __name__ == "__main__":
    main()
