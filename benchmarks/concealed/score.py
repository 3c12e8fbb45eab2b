# SPDX-License-Identifier: BSD-3-Clause
"""Diagnose every record of a folder, compare with its truth, and print a table.

    python benchmarks/concealed/score.py FOLDER [NAME ...]

Each record is a folder with recording.csv.gz, valve.toml, truth.json, and later.csv.gz with
flow_without_noise.csv.gz for the error on later rows, as make.py beside this file writes them. The truth is
read after the diagnosis is done. Errors of flow are against the flow without noise, as a multiple of the rms
of the recording's own noise; errors of the opening, a free run from the command, are in percent of travel.
"""

import json
import os
import sys
import time
from pathlib import Path

import numpy as np

from sklvalve import MissingPhysicsFinder, read_recording


def rms(values):
    """Root mean square, gaps left out."""
    return float(np.sqrt(np.nanmean(np.square(values))))


def later_errors(folder, finder, valve):
    """Errors on later rows, corrected and nominal: flow in multiples of the noise, opening in percent."""
    later = read_recording(folder / "later.csv.gz", valve)
    truth = np.genfromtxt(folder / "flow_without_noise.csv.gz", delimiter=",", skip_header=1)[
        -len(later) :, 1
    ]
    noise = rms(later.in_recorded_units("flow", later["flow"]) - truth)
    errors = []
    for simulation in (finder.corrected_simulation_, finder.nominal_simulation_):
        made = simulation.simulate(later)
        flow = rms(later.in_recorded_units("flow", made["flow"]) - truth) / noise
        errors += [flow, 100.0 * rms(made["opening"] - later["opening"])]
    return errors


def judge(diagnosis, truth):
    """`right`, `wrong name`, or `missed`."""
    classes = [{m["name"] for m in e["members"]} for e in diagnosis["effects"]]
    true = set(truth["effects"])
    if any(not names & true for names in classes):
        return "wrong name"
    whole = all(any(name in names for names in classes) for name in true)
    return "right" if whole and diagnosis["verdict"] == truth["verdict"] else "missed"


def main(folder, names):
    """Print one line a record, and the sums."""
    folder, tally = Path(folder), {}
    print(f"load {os.getloadavg()[0]:.1f}")
    head = ("record", "truth", "verdict", "found", "s", "flow", "nominal", "opening", "nominal")
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for name in names or sorted(p.name for p in folder.iterdir() if (p / "truth.json").exists()):
        place = folder / name
        recording = read_recording(place / "recording.csv.gz", place / "valve.toml")
        began = time.perf_counter()
        finder = MissingPhysicsFinder().fit(recording)
        seconds = time.perf_counter() - began
        found = finder.diagnosis_.to_dict()
        errors = later_errors(place, finder, recording.valve)
        truth = json.loads((place / "truth.json").read_text())
        outcome = judge(found, truth)
        tally[outcome] = tally.get(outcome, 0) + 1
        classes = " + ".join("/".join(m["name"] for m in e["members"]) for e in found["effects"]) or "-"
        cells = [name, " + ".join(truth["effects"]) or truth["verdict"], found["verdict"], classes]
        cells += [
            f"{seconds:.0f}",
            f"{errors[0]:.2f}",
            f"{errors[2]:.2f}",
            f"{errors[1]:.2f}",
            f"{errors[3]:.2f}",
        ]
        print("| " + " | ".join(cells) + f" | {outcome}", flush=True)
    print(tally)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
