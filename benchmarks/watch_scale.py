# SPDX-License-Identifier: BSD-3-Clause
"""What a morning costs in a plant of many valves that have been watched for long.

    python -m benchmarks.watch_scale FOLDER [--valves 50 200] [--days 365] [--jobs 2]

One sound valve is simulated, learnt and watched for so many short days. Every valve of the plant is this
valve under a tag of its own: the files of its days are the same files (hard links), all others are copies.
Then one more day comes for all of them, and the table says what that morning takes: the watch with its
tables, and the pages; what a second run on the same day takes; and how large the state and the pages are.
`watch_speed` has what long days cost: here valves and days of the past count.
"""

import argparse
import datetime as dt
import os
import resource
import shutil
import time
from pathlib import Path

import numpy as np

from benchmarks.watch_speed import timed
from sklvalve.datasets import make_valve_recording
from sklvalve.recording.valve import Valve
from sklvalve.watch import watch, write_site
from sklvalve.watch.plant import Commissioning, Plant, Watched

FIRST, COMMISSIONED, ROWS = dt.date(2026, 1, 1), 14, 900
# so many days are simulated; later ones are the same again
DRAWN = 30


def valves_of(sheet, many):
    """Valves of a plant, all of one sheet."""
    tags = (f"FV-{k:05d}" for k in range(many))
    return tuple(Watched(tag, sheet, tag, Commissioning(COMMISSIONED)) for tag in tags)


def drawn(folder, days):
    """Days of one sound valve as files, one a day, and its sheet."""
    made = make_valve_recording(None, n_samples=DRAWN * ROWS, n_later=0, loop="closed", random_state=5)
    folder.mkdir(parents=True)
    for k in range(days):
        part = made.frame.iloc[(k % DRAWN) * ROWS : (k % DRAWN + 1) * ROWS]
        date = FIRST + dt.timedelta(days=k)
        stamps = np.datetime64(f"{date}T06:00:00") + np.arange(ROWS).astype("timedelta64[s]")
        part.assign(time=np.datetime_as_string(stamps)).to_parquet(folder / f"{date}.parquet", index=False)
    return Valve.from_dict(made.valve)


def linked(source, target):
    """A folder of the same files."""
    target.mkdir(parents=True, exist_ok=True)
    for file in source.iterdir():
        if not (target / file.name).exists():
            os.link(file, target / file.name)


def as_many(one, folder, valves, old_days):
    """State and data of a plant, from those of one valve."""
    data, state = folder / "data", folder / "state"
    state.mkdir(parents=True)
    shutil.copy(one / "state" / "watch.json", state)
    for each in valves:
        linked(old_days, data / each.tag)
        linked(one / "state" / "days" / "valve=FV-00000", state / "days" / f"valve={each.tag}")
        shutil.copytree(one / "state" / "histories" / "FV-00000", state / "histories" / each.tag)
        for kept in ("calls", "inspections"):
            file = one / "state" / kept / "FV-00000.json"
            if file.exists():
                (state / kept).mkdir(exist_ok=True)
                shutil.copy(file, state / kept / f"{each.tag}.json")
    return data, state


def size_of(folder):
    """Files and bytes below a folder, without following links."""
    sizes = [entry.stat().st_size for entry in folder.rglob("*") if entry.is_file()]
    return len(sizes), sum(sizes)


def morning(one, folder, sheet, many, today, jobs):
    """Figures of one plant, as rows of the table."""
    shutil.rmtree(folder, ignore_errors=True)
    valves = valves_of(sheet, many)
    plant = Plant("scale", valves)
    data, state = as_many(one, folder, valves, one / "old")
    for each in valves:
        os.link(one / "drawn" / today, data / each.tag / today)
    load = os.getloadavg()[0]
    first, ends = timed(plant, data, state, jobs)
    began = time.perf_counter()
    write_site(folder / "site", plant, ends, state, n_jobs=jobs)
    pages = time.perf_counter() - began
    again, _ = timed(plant, data, state, jobs)
    kept, site = size_of(state), size_of(folder / "site")
    peak = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    shutil.rmtree(folder)
    return {
        "watched [s]": f"{first:.0f}",
        "- a valve [s]": f"{first / many:.3f}",
        "pages [s]": f"{pages:.0f}",
        "again, nothing new [s]": f"{again:.0f}",
        "state: files": f"{kept[0]:,}",
        "- MB": f"{kept[1] / 1e6:,.0f}",
        "pages: MB": f"{site[1] / 1e6:,.0f}",
        "largest process [MiB]": f"{peak / 1024:,.0f}",
        "days read": str(sum(w.read for w in ends)),
        "calls": str(sum(w.state == "calls" for w in ends)),
        "load before": f"{load:.1f}",
    }


def main(arguments=None):
    """Run it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--valves", type=int, nargs="+", default=[50, 200])
    parser.add_argument("--days", type=int, default=365, help="days of the past")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args(arguments)
    shutil.rmtree(options.folder, ignore_errors=True)
    one = options.folder / "one"
    sheet = drawn(one / "drawn", options.days + 1)
    days = sorted(file.name for file in (one / "drawn").iterdir())
    linked(one / "drawn", one / "old")
    (one / "old" / days[-1]).unlink()
    linked(one / "old", one / "data" / "FV-00000")
    watch(Plant("scale", valves_of(sheet, 1)), one / "data", one / "state", n_jobs=1)
    rows = {
        many: morning(one, options.folder / "plant", sheet, many, days[-1], options.jobs)
        for many in options.valves
    }
    print(
        f"| valves, {options.days} days each, {options.jobs} processes | "
        + " | ".join(f"{m:,}" for m in rows)
        + " |"
    )
    print("|---|" + "---|" * len(rows))
    for what in next(iter(rows.values())):
        print(f"| {what} | " + " | ".join(row[what] for row in rows.values()) + " |")


if __name__ == "__main__":
    main()
