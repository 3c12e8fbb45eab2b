# SPDX-License-Identifier: BSD-3-Clause
"""Published methods for sticking valves beside `diagnose_loop`, on drawn and on real loops.

    python -m benchmarks.loop_methods FOLDER [LOOPS] [SEED]

FOLDER holds `isdb` and `refinery_loops` with a README each. LOOPS loops are drawn (100 unless given), half of
them healthy, from SEED on (880000 unless given). Columns: drawn healthy loops called sticking; drawn sticking
loops found (band of 25 % or more of the command's span); how often a drawn sticking loop has the larger
statistic than a healthy one (AUC); the three sticking loops of `isdb` found, and the sound one called; the
refinery's tags, each with the share of its windows that are called; seconds a loop. A method that does not
apply has called nothing.
"""

import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import rankdata

from benchmarks.loop_plant import HEALTHY, KINDS, draw_loop
from sklvalve.mismatch.loop import diagnose_loop
from sklvalve.mismatch.loop.methods import published_methods
from sklvalve.recording import InputError, Recording

OURS = "diagnose_loop"
_STICK = ("CHEM2", "CHEM23", "PAP2")
_SOUND = ("PAP7",)


def judged(what, command, value, sample_time, setpoint=None, is_flow=None, ours=True):
    """A row for each method: verdict, statistic, seconds; the command in percent."""
    out = []
    began = time.perf_counter()
    results = published_methods(command, value, sample_time, setpoint=setpoint, is_flow=is_flow)
    each = (time.perf_counter() - began) / len(results)
    for found in results:
        out.append(
            what | {"method": found.method, "says": found.says, "statistic": found.statistic, "seconds": each}
        )
    if ours:
        began = time.perf_counter()
        columns = {"time": sample_time * np.arange(len(command)), "command": np.asarray(command) / 100.0}
        columns["flow" if is_flow else "process_value"] = value
        if setpoint is not None:
            columns["setpoint"] = setpoint
        try:
            found = diagnose_loop(Recording.from_frame(columns))
            says = {"named": "stiction", "no_mismatch": "no stiction"}.get(found.verdict, "undecided")
            statistic = found.evidence
        except InputError:
            says, statistic = "not applicable", None
        spent = time.perf_counter() - began
        out.append(what | {"method": OURS, "says": says, "statistic": statistic, "seconds": spent})
    return out


def drawn(loops, seed):
    """Rows for drawn loops, healthy and sticking in turn, of every kind and scene."""
    cases = [
        (kind, scene, sticking)
        for kind in KINDS
        for scene in HEALTHY
        for sticking in (False, True)
        if not (sticking and scene == "small_play")
    ]
    order = np.random.default_rng(seed).permutation(len(cases))
    for place in range(loops):
        kind, scene, sticking = cases[order[place % len(cases)]]
        loop = draw_loop(seed + place, kind, scene, sticking)
        if sticking and loop.share < 0.25:
            continue
        what = {"set": "drawn", "sticking": sticking, "tag": f"{kind} {scene}"}
        flow = kind == "flow"
        yield from judged(what, 100.0 * loop.command, loop.process_value, 10.0, loop.setpoint, flow)


def isdb(folder):
    """Rows for four loops of the International Stiction Data Base."""
    for name in _STICK + _SOUND:
        loop = pd.read_csv(folder / f"{name}.csv.gz")
        time_, command, value = (loop.iloc[:, place].to_numpy(float) for place in range(3))
        what = {"set": "isdb", "sticking": name in _STICK, "tag": name}
        yield from judged(what, command, value, float(np.median(np.diff(time_))), is_flow=True)


def refinery(folder):
    """Rows for the refinery's windows; windows that are the same samples again are left out."""
    index, loops = pd.read_csv(folder / "index.csv"), pd.read_csv(folder / "loops.csv.gz")
    windows = dict(list(loops.groupby("id")))
    for window in index.drop_duplicates("dup_group").itertuples():
        rows = windows[window.id].drop_duplicates("t")
        what = {"set": "refinery", "sticking": bool(window.stiction), "tag": window.tag}
        signals = (rows[name].to_numpy(float) for name in ("op", "pv", "sp"))
        command, value, setpoint = signals
        yield from judged(what, command, value, float(window.dt_s), setpoint, window.loop == "FIC")


def auc(ill, healthy):
    """How often a value of the first is above one of the second."""
    ill, healthy = ill.dropna().to_numpy(float), healthy.dropna().to_numpy(float)
    if not len(ill) or not len(healthy):
        return np.nan
    ranks = rankdata(np.concatenate([ill, healthy]))[: len(ill)].sum()
    return (ranks - len(ill) * (len(ill) + 1) / 2) / (len(ill) * len(healthy))


def summary(table):
    """A row for each method."""
    table = table.assign(called=table.says == "stiction")
    for method, rows in table.groupby("method", sort=False):
        sets = dict(list(rows.groupby(["set", "sticking"])))

        def count(name, sticking, sets=sets):
            found = sets.get((name, sticking))
            return "" if found is None else f"{found.called.sum()} of {len(found)}"

        def tags(sticking, sets=sets):
            found = sets.get(("refinery", sticking))
            if found is None:
                return ""
            shares = found.groupby("tag").called.mean()
            return f"{shares.sum():.1f} of {len(shares)}"

        plants = rows[rows.set == "drawn"]
        yield {
            "method": method,
            "drawn healthy called": count("drawn", False),
            "drawn sticking found": count("drawn", True),
            "AUC": f"{auc(plants.statistic[plants.sticking], plants.statistic[~plants.sticking]):.2f}",
            "isdb found": count("isdb", True),
            "isdb sound called": count("isdb", False),
            "refinery tags found": tags(True),
            "refinery sound tags called": tags(False),
            "seconds": f"{rows.seconds.mean():.3f}",
        }


def main(folder, loops=100, seed=880000):
    """Print the table."""
    folder = Path(folder)
    rows = [*drawn(loops, seed), *isdb(folder / "isdb"), *refinery(folder / "refinery_loops")]
    table = pd.DataFrame(rows)
    lines = list(summary(table))
    print("| " + " | ".join(lines[0]) + " |")
    print("|" + "---|" * len(lines[0]))
    for line in lines:
        print("| " + " | ".join(line.values()) + " |")
    return table


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], *map(int, sys.argv[2:]))
