# SPDX-License-Identifier: BSD-3-Clause
"""Whether the limits of detection that a diagnosis gives are where effects begin to be noticed.

    python -m benchmarks.detection_limits changed FOLDER [--records N] [--jobs N] [--history]
    python -m benchmarks.detection_limits hidden FOLDER [--jobs N] [--history]

FOLDER holds records of `benchmarks.concealed`, whose plant shares no code with the package. `changed` takes
its healthy ones and changes the recorded signals themselves: meters and sensors that read wrong, by shares of
the limit that the diagnosis of the unchanged record gives. `hidden` asks of each record in which one effect
acts throughout and nothing was found, whether its true size is among those that are said to go unnoticed.
"""

import argparse
import json
import warnings
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import InputError
from sklvalve.recording.from_file import read_recording
from sklvalve.recording.units import quantity_of, to_si

SHARES = (0.5, 0.8, 1.25, 2.0)


def _lagged(recording, lag):
    keep = np.exp(-recording.sample_time / lag)
    flow = recording["flow"]
    return lfilter([1.0 - keep], [1.0, -keep], flow, zi=[keep * flow[0]])[0]


#: Form of an effect -> what it makes of the recorded signals.
CHANGES = {
    "flow_meter_gain": lambda r, size: {"flow": r["flow"] * (1.0 + size)},
    "flow_meter_bias": lambda r, size: {"flow": r["flow"] + size},
    "flow_meter_drift": lambda r, size: {"flow": r["flow"] + size * (r.time - r.time[0]) / 3600.0},
    "sensor_lag": lambda r, size: {"flow": _lagged(r, size)},
}


def recording_of(folder):
    """The recording of a record, and a history or None."""
    valve = folder / "valve.toml"
    return read_recording(folder / "recording.csv.gz", valve), read_recording(
        folder / "history.csv.gz", valve
    )


def diagnosis_of(recording, history):
    """A diagnosis as plain data, the warnings of its fits left out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return MissingPhysicsFinder(history=history, random_state=0).fit(recording).diagnosis_.to_dict()


def changed(folder, with_history):
    """Of one healthy record each change with its share of the limit, and whether it was noticed."""
    recording, history = recording_of(folder)
    history = history if with_history else None
    rows = []
    for limit in diagnosis_of(recording, history).get("detection_limits") or []:
        for end in ("low", "high"):
            size = limit[end]
            if limit["form"] not in CHANGES or not size or (end == "low" and size > 0.0):
                continue
            rows += [_noticed(recording, history, limit["form"], size, share) for share in SHARES]
    return folder.name, [row for row in rows if row]


def _noticed(recording, history, form, size, share):
    signals = {**recording.signals, **CHANGES[form](recording, share * size)}
    try:
        found = diagnosis_of(replace(recording, signals=signals), history)
    except InputError:
        return None
    return form, share, found["verdict"] != "no_mismatch"


def hidden(folder, with_history):
    """Of one record with an effect throughout, whether its size is among those that go unnoticed."""
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    recording, history = recording_of(folder)
    found = diagnosis_of(recording, history if with_history else None)
    if found["verdict"] != "no_mismatch":
        return None
    [(_, told)], [name] = truth["parameters"].items(), truth["effects"]
    for limit in found["detection_limits"]:
        if (limit["name"], limit["parameter"]) == (name, told["parameter"]):
            low, high, size = limit["low"], limit["high"], _in_unit(told, limit["unit"])
            inside = (low is None or size >= low) and (high is None or size <= high)
            return folder.name, name, size, low, high, inside
    why = "not tested" if any(each["name"] == name for each in found["not_testable"]) else "another form"
    return folder.name, name, told["value"], why, "", None


def _in_unit(told, unit):
    """A true size in the unit of the package, where the plant has one of its own."""
    if told["unit"] == unit:
        return told["value"]
    each, per = (unit[:-2], told["unit"][:-2]) if unit.endswith("/s/h") else (unit, told["unit"])
    return float(to_si(told["value"], per, quantity_of(each)))


def _throughout(folder):
    """Whether one effect acts throughout a record, and its size is told."""
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    single = truth["kind"] == "single" and truth["course"] == "start" and len(truth["parameters"]) == 1
    return single and "value" in next(iter(truth["parameters"].values()))


def _is_healthy(folder):
    return json.loads((folder / "truth.json").read_text(encoding="utf-8"))["kind"] == "healthy"


def main():
    """Print a line a record when it is done, and the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=["changed", "hidden"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--records", type=int)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--history", action="store_true")
    options = parser.parse_args()
    wanted, work = (_is_healthy, changed) if options.part == "changed" else (_throughout, hidden)
    folders = sorted(each for each in options.folder.glob("record_????") if wanted(each))[: options.records]
    with ProcessPoolExecutor(options.jobs) as pool:
        found = pool.map(partial(work, with_history=options.history), folders)
        (_print_changed if options.part == "changed" else _print_hidden)(found)


def _print_changed(found):
    counts = defaultdict(lambda: [0, 0])
    for name, rows in found:
        print(name, rows, flush=True)
        for form, share, noticed in rows:
            for key in ((form, share), ("all", share)):
                counts[key][0] += noticed
                counts[key][1] += 1
    print("| change | " + " | ".join(f"{share:g} of the limit" for share in SHARES) + " |")
    print("|---" * (1 + len(SHARES)) + "|")
    for form in (*CHANGES, "all"):
        cells = ["{} of {}".format(*counts[form, share]) for share in SHARES]
        print(f"| {form} | " + " | ".join(cells) + " |")


def _print_hidden(found):
    found = [row for row in found if row]
    for row in found:
        print(*row, flush=True)
    told = [row[-1] for row in found if row[-1] is not None]
    print(
        f"{sum(told)} of {len(told)} true sizes are among those that go unnoticed; {len(found)} were missed"
    )


if __name__ == "__main__":
    main()
