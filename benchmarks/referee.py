# SPDX-License-Identifier: BSD-3-Clause
"""How often the black box is clearly better than the simulation of a healthy valve, where nothing is missing.

    python -m benchmarks.referee FOLDER

FOLDER holds healthy records: `python -m benchmarks.concealed FOLDER --seed 7 --healthy 30 --each 0 --pairs 0
--outside 0 --defects 0 --methods` draws them. Each record is judged four times: as recorded; without the
opening, so that the command drives the flow in open and closed loops; without the pressures, whose wander
nobody measures then; and without both. Called: the black box is clearly better and every driver was recorded,
so that something would be reported as missing. Abstained: clearly better while the pressure drop is unknown.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.proof.comparison import compare
from sklvalve.mismatch.proof.forward import forward_in_time
from sklvalve.recording import InputError, read_recording, read_valve

DROPPED = {
    "as recorded": (),
    "no opening": ("opening",),
    "no pressures": ("p1", "p2"),
    "neither": ("opening", "p1", "p2"),
}


def compared(record, dropped):
    """Comparison of the calibrated nominal simulation of a record with the black box."""
    recording = read_recording(record / "recording.csv.gz", read_valve(record / "valve.toml"))
    kept = {role: values for role, values in recording.signals.items() if role not in dropped}
    problem = prepared_problem(replace(recording, signals=kept))
    problem, nominal = calibrated(problem)
    nominal = problem.least_squares(nominal)
    return compare(problem, forward_in_time(problem, nominal, nominal))


def main(folder):
    """Print the table."""
    print("| signals | channel | records | closed loops | called | abstained | median ratio | largest |")
    print("|---|---|---|---|---|---|---|---|")
    records = sorted(path.parent for path in Path(folder).glob("record_*/truth.json"))
    for name, dropped in DROPPED.items():
        found = []
        for record in records:
            try:
                found += compared(record, dropped)
            except InputError as refusal:
                print(refusal, file=sys.stderr)
        for channel in ("opening", "flow"):
            rows = [each for each in found if each.channel == channel]
            if not rows:
                continue
            ratios = np.array([each.ratio for each in rows])
            called = sum(each.clearly_better and each.exogenous for each in rows)
            abstained = sum(each.clearly_better and not each.exogenous for each in rows)
            print(
                f"| {name} | {channel} | {len(rows)} | {sum(each.closed for each in rows)} | {called} | "
                f"{abstained} | {np.median(ratios):.2f} | {ratios.max():.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1])
