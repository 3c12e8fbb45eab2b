# SPDX-License-Identifier: BSD-3-Clause
"""Diagnose every record of a folder, compare with its truth, and print tables.

    python benchmarks/trial/score.py FOLDER [NAME ...] [--out FILE] [--part 1/2]
    python benchmarks/trial/score.py --combine FILE [FILE ...]

Each record is a folder with recording.csv.gz, valve.toml, truth.json, and later.csv.gz with
flow_without_noise.csv.gz for the error on later rows, as make.py beside this file writes them. The truth is
read after the diagnosis is done. Errors of flow are against the flow without noise, as a multiple of the rms
of the recording's own noise; errors of the opening, a free run from the command, are in percent of travel.

A line of JSON a record goes to FILE (scores.jsonl in FOLDER, unless told otherwise) as soon as it is judged.
Started again, the same command goes on where it was stopped: what FILE holds is not diagnosed anew. Two
processes share the work with --part 1/2 and --part 2/2, each with a file of its own; --combine prints the
tables of several files together.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))
from benchmarks.concealed.report.trial import summary
from benchmarks.concealed.run import code
from benchmarks.concealed.scoring.lines import read_lines
from benchmarks.concealed.scoring.outcome import judge

TOLD = ("effects", "verdict", "concealed", "loop", "noise", "onset", "strengths", "detectable", "parameters")


def rms(values):
    """Root mean square, gaps left out."""
    return float(np.sqrt(np.nanmean(np.square(values))))


def later_errors(folder, finder, valve):
    """Errors on later rows, corrected and nominal: flow in multiples of the noise, opening in percent."""
    from sklvalve import read_recording

    later = read_recording(folder / "later.csv.gz", valve)
    truth = np.genfromtxt(folder / "flow_without_noise.csv.gz", delimiter=",", skip_header=1)[
        -len(later) :, 1
    ]
    noise = rms(later.in_recorded_units("flow", later["flow"]) - truth)
    errors = {}
    for name in ("corrected", "nominal"):
        made = getattr(finder, f"{name}_simulation_").simulate(later)
        flow = rms(later.in_recorded_units("flow", made["flow"]) - truth) / noise
        errors[name] = [flow, 100.0 * rms(made["opening"] - later["opening"])]
    return errors


def score(place):
    """One record: what was found, then what is true."""
    from sklvalve import MissingPhysicsFinder, read_recording

    row = {"folder": place.parent.name, "record": place.name, "load": round(os.getloadavg()[0], 1)}
    began = time.perf_counter()
    try:
        recording = read_recording(place / "recording.csv.gz", place / "valve.toml")
        finder = MissingPhysicsFinder().fit(recording)
        row["seconds"] = round(time.perf_counter() - began, 1)
        found = finder.diagnosis_.to_dict()
        row["found"] = {key: found[key] for key in ("verdict", "mismatch", "location", "effects")}
        row["errors"] = later_errors(place, finder, recording.valve)
    except Exception as error:
        # a diagnosis that breaks is an outcome too, and no reason to leave the others undone
        row["failed"] = f"{type(error).__name__}: {error}"
    truth = json.loads((place / "truth.json").read_text(encoding="utf-8"))
    # records of other simulators tell less of themselves
    truth = {"concealed": truth["effects"], "loop": "?", "noise": 1.0, "onset": 0.0} | truth
    truth["onset"] = truth["onset"] or 0.0
    row["truth"] = {key: truth[key] for key in TOLD if key in truth}
    return row


def line_of(row):
    """A row of the table of records."""
    truth = row["truth"]
    cells = [row["record"], " + ".join(truth["concealed"]) or truth["verdict"]]
    if "failed" in row:
        cells += [row["failed"]] + 6 * [""]
    else:
        found, errors = row["found"], row["errors"]
        classes = " + ".join("/".join(m["name"] for m in e["members"]) for e in found["effects"]) or "-"
        cells += [found["verdict"], classes, f"{row['seconds']:.0f}"]
        cells += [f"{errors[name][i]:.2f}" for i in (0, 1) for name in ("corrected", "nominal")]
    return "| " + " | ".join([*cells, judge(row)]) + " |"


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Diagnose records with concealed effects and judge.")
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("names", nargs="*", help="records; all of the folder where none is named")
    parser.add_argument("--out", type=Path, help="file of scores, one line of JSON a record")
    parser.add_argument("--part", default="1/1", help="which part of the records, as in 1/2")
    parser.add_argument("--combine", type=Path, nargs="+", help="print the tables of these files and stop")
    options = parser.parse_args(arguments)
    head = ("record", "truth", "verdict", "found", "s", "flow", "nominal", "opening", "nominal", "judged")
    head = "| " + " | ".join(head) + " |\n|" + "---|" * len(head)
    if options.combine:
        rows = sorted(read_lines(*options.combine), key=lambda row: (row["folder"], row["record"]))
        print("\n".join([head, *map(line_of, rows)]) + "\n\n" + summary(rows))
        return
    if options.folder is None:
        parser.error("expected a FOLDER of records, or --combine with files of scores")
    part, of = (int(number) for number in options.part.split("/"))
    names = options.names or sorted(p.parent.name for p in options.folder.glob("*/truth.json"))
    name_of = "scores.jsonl" if of == 1 else f"scores_{part}_of_{of}.jsonl"
    out = options.out or options.folder / name_of
    rows, commit = read_lines(out) if out.exists() else [], code()
    done = {row["record"] for row in rows}
    # a line that was cut off goes
    out.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    print(head, flush=True)
    for name in names[part - 1 :: of]:
        if name in done:
            continue
        row = score(options.folder.resolve() / name) | {"code": commit}
        with out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        rows.append(row)
        print(line_of(row), flush=True)
    print("\n" + summary(rows))


if __name__ == "__main__":
    main()
