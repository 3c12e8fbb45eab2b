# SPDX-License-Identifier: BSD-3-Clause
"""Events in the last rows of drawn recordings: how many are found and dated, how many names are wrong.

``python -m benchmarks.late --seeds 100 130 --rows 3000 --out late.csv``
"""

import argparse
import csv
from time import perf_counter

import pandas as pd

from benchmarks.late_plant import ENDS, record
from sklvalve import MissingPhysicsFinder, Recording, Valve

# what begins in the last so much of a recording counts as told of its end
_END = 0.06
# a date is right within so many seconds, or so much of the recording where that is less
_NEAR = 60.0


def judged(kind, rows, seed):
    """One recording diagnosed: a row of the table."""
    columns, sheet, truth = record(kind, rows, seed)
    begun = perf_counter()
    recording = Recording.from_frame(pd.DataFrame(columns), Valve.from_dict(sheet))
    d = MissingPhysicsFinder(n_jobs=1).fit(recording).diagnosis_.content
    late = [e for e in d["effects"] if e["onset"] is not None and e["onset"] > (1.0 - _END) * rows]
    names = [m["name"] for e in late for m in e["members"]]
    change = d["location"]["change"]
    time = None if change is None else change["time"]
    return {
        "seed": seed,
        "kind": kind,
        "verdict": d["verdict"],
        "names": " ".join(names),
        "others": " ".join(e["members"][0]["name"] for e in d["effects"] if e not in late),
        "right": bool(truth["name"]) and truth["name"] in names,
        "wrong": bool(names) and truth["name"] not in names,
        "true_time": truth["time"],
        "time": time,
        "dated": time is not None and truth["time"] is not None and abs(time - truth["time"]) <= _NEAR,
        "changed": change is not None,
        "seconds": round(perf_counter() - begun, 1),
    }


def main(arguments=None):
    """Diagnose a range of seeds, the kinds in turn, and write one row each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", nargs=2, type=int, default=(100, 130))
    parser.add_argument("--rows", type=int, default=3000)
    parser.add_argument("--out", default="late.csv")
    chosen = parser.parse_args(arguments)
    kinds, writer = list(ENDS), None
    with open(chosen.out, "w", newline="", encoding="utf-8") as file:
        for seed in range(*chosen.seeds):
            # half of them are sound
            kind = "healthy" if seed % 2 else kinds[1 + (seed // 2) % (len(kinds) - 1)]
            row = judged(kind, chosen.rows, seed)
            if writer is None:
                writer = csv.DictWriter(file, list(row))
                writer.writeheader()
            writer.writerow(row)
            file.flush()


if __name__ == "__main__":
    main()
