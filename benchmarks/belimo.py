# SPDX-License-Identifier: BSD-3-Clause
"""An electric actuator known by command and position alone: found on two runs, judged on the nine others.

    python benchmarks/belimo.py FOLDER [FIRST SECOND]

FOLDER holds campaign_20hz.csv.gz. Two runs that follow each other in time are diagnosed, by default the last
square wave and the first triangle; each other run is then simulated from its command alone. Errors are RMSE
of the position in percent of travel. Nominal is the calibrated simulation held against the recording.
"""

import csv
import gzip
import os
import sys
import time
from datetime import datetime
from pathlib import Path

import numpy as np

from sklvalve import MissingPhysicsFinder, Recording
from sklvalve.metrics import rmse

FITTED = ("P2_HIGH_SQUARE_001", "P3_LOW_TRIANGLE_001")


def runs_of(path):
    """Run -> array of time [s], command and position [1], in the order of time."""
    runs = {}
    with gzip.open(path, "rt", newline="") as file:
        for row in csv.DictReader(file):
            moment = datetime.fromisoformat(row["timestamp"]).timestamp()
            wanted, seen = float(row["setpoint_position_%"]), float(row["feedback_position_%"])
            runs.setdefault(row["test_id"], []).append((moment, wanted / 100.0, seen / 100.0))
    runs = {name: np.array(rows) for name, rows in runs.items()}
    return dict(sorted(runs.items(), key=lambda item: item[1][0, 0]))


def recording_of(runs):
    """Recording of runs that follow each other; where they overlap, the earlier one holds."""
    rows = runs[0]
    for later in runs[1:]:
        rows = np.concatenate([rows, later[later[:, 0] > rows[-1, 0] + 0.02]])
    return Recording.from_frame({"time": rows[:, 0], "command": rows[:, 1], "opening": rows[:, 2]})


def main(folder, fitted):
    """Print what is found, and one line a run."""
    runs = runs_of(Path(folder) / "campaign_20hz.csv.gz")
    recording = recording_of([runs[name] for name in fitted])
    began = time.perf_counter()
    finder = MissingPhysicsFinder().fit(recording)
    seconds = time.perf_counter() - began
    found = finder.diagnosis_.to_dict()
    print(f"load {os.getloadavg()[0]:.1f}; {len(recording)} rows of {' and '.join(fitted)}: {seconds:.0f} s")
    print(f"verdict {found['verdict']}")
    for effect in found["effects"]:
        members = ", ".join(m["name"] for m in effect["members"])
        values = ", ".join(f"{k} {v['value']:.4g} {v['ci95']}" for k, v in effect["parameters"].items())
        print(f"- {members} ({effect['grade']['level']}): {values}")
    print("| run | nominal | corrected |")
    print("|---|---|---|")
    errors = []
    for name in (name for name in runs if name not in fitted):
        other = recording_of([runs[name]])
        made = [
            s.simulate(other)["opening"] for s in (finder.nominal_simulation_, finder.corrected_simulation_)
        ]
        errors.append([100.0 * rmse(other["opening"], opening) for opening in made])
        print(f"| {name} | {errors[-1][0]:.2f} | {errors[-1][1]:.2f} |")
    nominal, corrected = np.mean(errors, axis=0)
    print(f"| mean | {nominal:.2f} | {corrected:.2f} |")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 4):
        sys.exit(__doc__)
    main(sys.argv[1], tuple(sys.argv[2:]) or FITTED)
