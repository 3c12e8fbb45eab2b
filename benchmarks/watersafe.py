# SPDX-License-Identifier: BSD-3-Clause
"""Three valves of a real laboratory network: found on 6,000 s, judged on the 3,700 s after.

    python benchmarks/watersafe.py FOLDER

FOLDER holds recording.csv and VA_A1.toml, VA_C1.toml, VA_C3.toml. Errors are RMSE of the flow in cm3/s on
rows behind 6,000 s, which no fit has seen; the black box is an LS-SVM on the same signals with lags of the
command.
"""

import os
import sys
import time
from pathlib import Path

from sklvalve import MissingPhysicsFinder, read_recording


def main(folder):
    """Print one line a valve."""
    folder = Path(folder)
    print(f"load {os.getloadavg()[0]:.1f}")
    print("| valve | verdict | found | s | nominal | black box | corrected |")
    print("|---|---|---|---|---|---|---|")
    for name in ("VA_A1", "VA_C1", "VA_C3"):
        recording = read_recording(folder / "recording.csv", folder / f"{name}.toml")
        began = time.perf_counter()
        finder = MissingPhysicsFinder().fit(recording, until=recording.index_until(6000))
        seconds = time.perf_counter() - began
        found = finder.diagnosis_.to_dict()
        classes = " + ".join("/".join(m["name"] for m in e["members"]) for e in found["effects"]) or "-"
        errors = found["fit"]["flow"]["rmse"]
        numbers = " | ".join(f"{errors[kind]:.2f}" for kind in ("nominal", "black_box", "corrected"))
        print(f"| {name} | {found['verdict']} | {classes} | {seconds:.0f} | {numbers} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
