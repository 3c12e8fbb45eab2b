# SPDX-License-Identifier: BSD-3-Clause
"""One record as one method sees it: a line of scores. The truth is read after the diagnosis is done."""

import json
import os
import resource
import time
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

import numpy as np

from benchmarks.concealed.draw import HISTORY
from benchmarks.concealed.methods import learner, method, public
from benchmarks.concealed.methods.rows import spans_of
from sklvalve import read_recording

# a row counts as touched from a fifth of what the most touched rows see
_TOUCHED = 0.2


def line_of(place, name, *, valve="valve.toml", cache=None):
    """Line of scores of one record by one method.

    Parameters
    ----------
    place : Path
        Folder of the record.
    name : str
        Of `methods.METHODS`.
    valve : str, default="valve.toml"
        File of what the engineer knows.
    cache : Path, default=None
        Where a method may keep what it has learnt before.

    Returns
    -------
    line : dict
        Of plain data; ``failed`` in place of ``found`` where the diagnosis broke.
    """
    place = Path(place)
    line = {
        "record": place.name,
        "folder": place.parent.name,
        "method": name,
        "load": round(os.getloadavg()[0], 1),
    }
    _forget_peak()
    try:
        more = _learnt(place, name, valve, line)
        began, worked = time.perf_counter(), time.process_time()
        recording = read_recording(place / "recording.csv.gz", place / valve)
        found = method(name)(recording, folder=cache, **more)
        _timed(line, "", began, worked)
        line["found"] = public(found)
        # what it has found is judged by it as well: a simulation that breaks is its own
        line["peak_mb"] = _peak()
        behind = _behind(place)
        truth = json.loads((place / "truth.json").read_text(encoding="utf-8"))
        if behind:
            line["rows"] = _rows(found, truth, behind)
            line["errors"] = _errors(found, place, valve, truth, behind)
    except Exception as error:
        # a diagnosis that breaks is an outcome too, and no reason to leave the others undone
        line["failed"] = f"{type(error).__name__}: {error}".replace(f"{place}{os.sep}", "")
    line["truth"] = json.loads((place / "truth.json").read_text(encoding="utf-8"))
    return line


def _learnt(place, name, valve, line):
    """History for a method that takes one; what that takes is told apart, as it is a command of its own."""
    learn = learner(name)
    if learn is None:
        return {}
    began, worked = time.perf_counter(), time.process_time()
    history = learn([read_recording(place / HISTORY, place / valve)])
    _timed(line, "learn_", began, worked)
    line["rehearsals"] = [asdict(each) for each in history.rehearsals_]
    return {"history": history}


def _timed(line, prefix, began, worked):
    line[f"{prefix}seconds"] = round(time.perf_counter() - began, 2)
    line[f"{prefix}cpu_seconds"] = round(time.process_time() - worked, 2)


def _forget_peak():
    """Begin to count the peak of memory anew, where the system can."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def _peak():
    """Peak of memory since then [MB]; since the process began where the system cannot tell."""
    with suppress(OSError, StopIteration):
        status = Path("/proc/self/status").read_text().splitlines()
        kilobytes = next(row for row in status if row.startswith("VmHWM")).split()[1]
        return round(float(kilobytes) / 1024.0, 1)
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, 1)


def _behind(place):
    if not (place / "behind.csv.gz").exists():
        return {}
    table = np.genfromtxt(place / "behind.csv.gz", delimiter=",", names=True)
    return {name: table[name] for name in table.dtype.names}


def truly_acting(truth, behind):
    """Rows in which the effect moves a signal, by what is behind the noise; none of a healthy record."""
    rows = truth["rows"]
    acting = np.zeros(rows, dtype=bool)
    if not truth["concealed"]:
        return acting
    largest = {}
    for channel in ("flow", "opening"):
        change = np.abs(behind[channel] - behind[f"healthy_{channel}"])[:rows]
        top = float(np.quantile(change, 0.99))
        # less than the quiet half of the channel's noise shows nowhere
        if top > 0.5 * truth["noise_rms"].get(channel, np.inf):
            largest[channel] = change, top
    for change, top in largest.values():
        acting |= change > _TOUCHED * top
    return acting


def _rows(found, truth, behind):
    told = {"of": truth["rows"], "true": spans_of(truly_acting(truth, behind))}
    for name, key in (("told", "flagged"), ("boxes", "boxes")):
        rows = found.get(key)
        told[name] = None if rows is None else spans_of(np.asarray(rows)[: truth["rows"]])
    return told


def _errors(found, place, valve, truth, behind):
    """Mean squares on later rows against what is behind the noise, as squared shares of span and travel."""
    if "simulate" not in found or "simulate_nominal" not in found:
        return {}
    later = read_recording(place / "later.csv.gz", place / valve)
    tail = slice(truth["rows"], None)
    errors: dict = {}
    for which, simulate in (("corrected", found["simulate"]), ("nominal", found["simulate_nominal"])):
        made = simulate(later)
        for channel in ("flow", "opening"):
            if channel not in made or channel not in later:
                continue
            span = np.ptp(behind["flow"]) if channel == "flow" else 100.0
            wrong = later.in_recorded_units(channel, made[channel]) - behind[channel][tail]
            errors.setdefault(channel, {"floor": 0.0})[which] = float(np.nanmean((wrong / span) ** 2))
    return errors
