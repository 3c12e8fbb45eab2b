# SPDX-License-Identifier: BSD-3-Clause
"""How often a diagnosis of several days, joined as one recording, is right.

    python -m benchmarks.joined_days FOLDER --valves 40 --days 1 2 7

Valves and days are those of `benchmarks.watch_years`: every day another programme, 900 rows. Of each valve so
many sound days are joined and diagnosed against its data sheet, and so many days on which something is
missing throughout, of twice the size that an hour could just tell. A line of JSON a diagnosis is kept in
FOLDER; started again it goes on.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import kstest

from benchmarks.concealed.plant import EFFECTS
from benchmarks.concealed.record import valve_of
from benchmarks.concealed.run import plain_lines
from benchmarks.watch_years import GROWS, Days, made_side_by_side, share
from sklvalve import MissingPhysicsFinder
from sklvalve.recording import InputError, Recording, join_recordings
from sklvalve.recording.valve import Valve

ROWS, LONGEST = 900, 80


def joined(valve, first, many):
    """So many days of a valve as one recording."""
    table = valve.table(first)
    sheet = Valve.from_dict(valve_of(valve.plant, table, valve.case))
    tables = [table, *(valve.table(day) for day in range(first + 1, first + many))]
    # the set-point of a loop and the simulation are not for the tool
    return join_recordings(
        Recording.from_frame(pd.DataFrame({k: v for k, v in t.items() if k not in ("F_sim", "SP")}), sheet)
        for t in tables
    )


def diagnosed(seed, many, faulty):
    """What came of one diagnosis, as a line of the file."""
    began = time.process_time()
    valve = Days(seed, LONGEST, ROWS, True)
    recording = joined(valve, valve.onset + GROWS if faulty else 0, many)
    line = {"seed": seed, "many": many, "effect": valve.effect if faulty else None}
    line["told"] = EFFECTS[valve.effect].told if faulty else None
    try:
        content = MissingPhysicsFinder(n_jobs=1, random_state=0).fit(recording).diagnosis_.to_dict()
    except InputError as refused:
        return line | {"verdict": "refused", "said": str(refused)}
    line |= {"verdict": content["verdict"], "p_value": content["mismatch"].get("p_value")}
    line["names"] = [[m["name"] for m in effect["members"]] for effect in content["effects"]]
    return line | {"seconds": time.process_time() - began}


def outcome(line):
    """Of a line: what a table counts."""
    verdict, named = line["verdict"], line["names"] if line["verdict"] == "named" else []
    if line["told"] is None:
        return "silent" if verdict == "no_mismatch" else "named" if named else "abstains"
    if any(line["told"] in names for names in named):
        return "right"
    return "wrong" if named else "missed" if verdict == "no_mismatch" else "abstains"


def rows_of_table(lines):
    """What is printed."""
    told = [line for line in lines if line["verdict"] != "refused"]
    for many in sorted({line["many"] for line in told}):
        sound = [line for line in told if line["many"] == many and line["told"] is None]
        other = [line for line in told if line["many"] == many and line["told"] is not None]
        for group, kinds in ((sound, ("silent", "abstains", "named")), (other, ("right", "wrong", "missed"))):
            if group:
                counts = [share(sum(outcome(line) == kind for line in group), len(group)) for kind in kinds]
                what = "sound" if group is sound else "faulty"
                yield f"| {what}, {many} days | " + " | ".join(map(" ".join, zip(kinds, counts, strict=True)))
        p = [line["p_value"] for line in sound if line["p_value"] is not None]
        if p:
            uniform = kstest(p, "uniform").pvalue
            low = sum(np.array(p) < 0.05)
            yield f"| p of {len(p)} sound, {many} days | uniform {uniform:.2f} | below 0.05: {low}"


def main(arguments=None):
    """Run it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--valves", type=int, default=40)
    parser.add_argument("--first", type=int, default=801, help="first seed")
    parser.add_argument("--days", type=int, nargs="+", default=[1, 2, 7])
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    file = options.folder / "joined.jsonl"
    lines = plain_lines(file)
    done = {(line["seed"], line["many"], line["told"] is not None) for line in lines}
    seeds = range(options.first, options.first + options.valves)
    work = [(s, many, faulty) for s in seeds for many in options.days for faulty in (False, True)]
    made_side_by_side(diagnosed, [each for each in work if each not in done], options.jobs, file, lines)
    for row in rows_of_table(lines):
        print(row)


if __name__ == "__main__":
    main()
