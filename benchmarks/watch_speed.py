# SPDX-License-Identifier: BSD-3-Clause
"""What a morning of watching costs: valve-days of 86,400 rows in which nothing happens.

    python -m benchmarks.watch_speed FOLDER [--valves 4] [--days 125] [--jobs 2]

Valves are learnt from 7 short days first; 7 whole ones are their reference. Then days of six signals, one row
a second, as Parquet, are watched in one run; half as many valves in another, to show how time grows with
them. `bytes` is the time that pandas needs to read the same files, `reading` that of `read_day`, `scoring`
that of `scored`, both by themselves. Seconds of this machine; the load is printed beside them.
"""

import argparse
import datetime as dt
import os
import resource
import shutil
import time
from pathlib import Path

import numpy as np
import pandas as pd

from sklvalve.datasets import make_valve_recording
from sklvalve.recording.valve import Valve
from sklvalve.watch import watch
from sklvalve.watch.days import days_of, read_day
from sklvalve.watch.plant import Commissioning, Plant, Watched
from sklvalve.watch.score import scored
from sklvalve.watch.standing import epochs_of
from sklvalve.watch.store import Store

FIRST, COMMISSIONED, LEARNT, SHORT, ROWS = dt.date(2026, 1, 1), 14, 7, 1800, 86_400
# so many days are drawn; further ones are the same again
DRAWN = 5
HOUR = 3600


def drawn(folder):
    """Short days and whole ones of one sound valve, as files, and its sheet."""
    rows = LEARNT * SHORT
    made = make_valve_recording(None, n_samples=rows + ROWS, n_later=0, loop="closed", random_state=5)
    folder.mkdir(parents=True)
    for k in range(LEARNT):
        _write(made.frame.iloc[k * SHORT : (k + 1) * SHORT], folder / f"short_{k}.parquet")
    day = made.frame.iloc[rows:]
    for k in range(DRAWN):
        # the same day begun at another hour: another day of the same valve
        _write(day.iloc[np.roll(np.arange(ROWS), -k * HOUR)], folder / f"whole_{k}.parquet")
    return Valve.from_dict(made.valve)


def _write(frame, path):
    frame.assign(time=range(len(frame))).to_parquet(path, index=False)


def laid_out(folder, drawn_files, valves, days):
    """Folders of valves, each file once on the disk."""
    for k in range(valves):
        place = folder / f"FV-{k}"
        place.mkdir(parents=True, exist_ok=True)
        for d in range(days):
            name = f"short_{d}" if d < LEARNT else f"whole_{(d + k) % DRAWN}"
            target = place / f"{FIRST + dt.timedelta(days=d)}.parquet"
            if not target.exists():
                os.link(drawn_files / f"{name}.parquet", target)


def timed(plant, data, state, jobs):
    began = time.perf_counter()
    ends = watch(plant, data, state, n_jobs=jobs)
    return time.perf_counter() - began, ends


def parts(watched, data, state, many=5):
    """Seconds a valve-day of bytes alone, of reading and of scoring, in one process."""
    store = Store(state)
    history = store.history(watched.tag, epochs_of(watched.tag, store)[-1])
    files = days_of(data, watched).days[-many:]
    spent = {"bytes": 0.0, "reading": 0.0, "scoring": 0.0}
    for each in files:
        began = time.perf_counter()
        pd.read_parquet(each.files[0])
        read = time.perf_counter()
        recording = read_day(each, watched)
        ready = time.perf_counter()
        scored(recording, history)
        done = time.perf_counter()
        for name, seconds in zip(spent, (read - began, ready - read, done - ready), strict=True):
            spent[name] += seconds / many
    return spent


def main(arguments=None):
    """Run it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--valves", type=int, default=4)
    parser.add_argument("--days", type=int, default=125, help="whole days of each valve")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args(arguments)
    shutil.rmtree(options.folder, ignore_errors=True)
    sheet = drawn(options.folder / "drawn")
    data, state = options.folder / "data", options.folder / "state"
    valves = tuple(
        Watched(f"FV-{k}", sheet, f"FV-{k}", Commissioning(COMMISSIONED)) for k in range(options.valves)
    )
    laid_out(data, options.folder / "drawn", options.valves, COMMISSIONED)
    learnt, _ = timed(Plant("speed", valves), data, state, options.jobs)
    halves = options.folder / "state_of_half"
    shutil.copytree(state, halves)
    laid_out(data, options.folder / "drawn", options.valves, COMMISSIONED + options.days)
    load = os.getloadavg()[0]
    half, _ = timed(Plant("speed", valves[: options.valves // 2]), data, halves, options.jobs)
    whole, ends = timed(Plant("speed", valves), data, state, options.jobs)
    again, _ = timed(Plant("speed", valves), data, state, options.jobs)
    spent = parts(valves[0], data, state)
    # of this process, which has read and scored days as the workers do
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    many = options.valves * options.days
    rows = [
        (f"{many} valve-days of {ROWS} rows, {options.jobs} processes", f"{whole:.0f} s"),
        (f"- of half the valves ({many // 2})", f"{half:.0f} s"),
        ("- once more, nothing new", f"{again:.1f} s"),
        ("- a valve-day: bytes alone, pandas", f"{spent['bytes']:.3f} s"),
        ("- a valve-day: reading", f"{spent['reading']:.3f} s"),
        ("- a valve-day: scoring", f"{spent['scoring']:.3f} s"),
        (
            f"learning a valve from {LEARNT} short days, with its reference",
            f"{learnt * options.jobs / options.valves:.0f} s",
        ),
        ("memory of a process that reads and scores", f"{peak / 1024:.0f} MiB"),
        ("valves that called", str(sum(w.state == "calls" for w in ends))),
        ("load before", f"{load:.1f}"),
    ]
    for what, told in rows:
        print(f"| {what} | {told} |")


if __name__ == "__main__":
    main()
