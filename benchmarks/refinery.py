# SPDX-License-Identifier: BSD-3-Clause
"""Loops of a refinery with the plant's own verdict: how many of each tag are called sticking.

    python benchmarks/refinery.py FOLDER [-v]

FOLDER holds index.csv (id, stiction, tag, loop, dup_group) and loops.csv.gz (id, t, op [%], pv, sp). Loops
named FIC are read as flow, all others as a process value. Counted by tag, because windows of one tag share
samples; with -v a line a window as well.
"""

import os
import sys
import time
from pathlib import Path

import pandas as pd

from sklvalve.mismatch.loop import diagnose_loop
from sklvalve.recording import InputError, Recording, Valve


def recording_of(rows, loop):
    """A window as a recording; flows of unknown unit are called m3/s, other values m."""
    role, unit = ("flow", "m3/s") if loop == "FIC" else ("process_value", "m")
    # two windows hold the same times twice
    rows = rows.drop_duplicates("t")
    told = {
        "command": {"column": "op", "unit": "%"},
        role: {"column": "pv", "unit": unit},
        "setpoint": {"column": "sp", "unit": unit},
    }
    return Recording.from_frame(rows, Valve.from_dict({"recording": {"time": "t", **told}}))


def judged(folder):
    """A row a window: verdict, p-value, band, errors, seconds, or the reason why it was refused."""
    index, loops = pd.read_csv(folder / "index.csv"), pd.read_csv(folder / "loops.csv.gz")
    windows = dict(list(loops.groupby("id")))
    out = []
    for window in index.itertuples():
        began = time.perf_counter()
        row = {"id": window.id, "tag": window.tag, "loop": window.loop, "sticking": window.stiction}
        try:
            found = diagnose_loop(recording_of(windows[window.id], window.loop))
        except InputError as error:
            row |= {"verdict": "refused", "reason": str(error).split(": ", 1)[1]}
        else:
            errors = found.fit["rmse"]
            row |= {
                "verdict": found.verdict,
                "p": found.p_value,
                "evidence": found.evidence,
                "held_out": errors["corrected"] / errors["nominal"],
                "reason": found.effects[0]["sentence"] if found.effects else found.reasons[0],
            }
        out.append(row | {"seconds": time.perf_counter() - began})
    return pd.DataFrame(out)


def main(folder, verbose):
    """Print the table."""
    table = judged(Path(folder))
    print(f"load {os.getloadavg()[0]:.1f}, {table.seconds.median():.1f} s a window (median)")
    if verbose:
        for row in table.itertuples():
            print(
                f"{row.id} {row.tag} {row.sticking} {row.verdict} p {row.p:.4f} evidence {row.evidence:.1f} "
                f"held out {row.held_out:.2f} {row.reason}"
            )
    print("| tag | plant says | windows | called sticking | cannot tell | refused | least evidence | most |")
    print("|---|---|---|---|---|---|---|---|")
    for (sticking, tag), rows in table.groupby(["sticking", "tag"], sort=True):
        counts = [int((rows.verdict == kind).sum()) for kind in ("named", "cannot_tell", "refused")]
        said = "sticking" if sticking else "healthy"
        spread = f"{rows.evidence.min():.1f} | {rows.evidence.max():.1f}"
        print(f"| {tag} | {said} | {len(rows)} | {' | '.join(map(str, counts))} | {spread} |")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], "-v" in sys.argv)
