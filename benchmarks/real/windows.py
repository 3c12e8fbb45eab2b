# SPDX-License-Identifier: BSD-3-Clause
"""Whether windows of one real recording get the same names: what a valve has, it has in each.

    python -m benchmarks.real.windows DATA [--only NAME ...]

DATA is a copy of the shared recordings. Every valve of watersafe and the hour of DAMADICS are diagnosed in
five windows, as if each were all that was recorded. Nobody has labelled most of them. But a name that comes
and goes says more of the window than of the valve.

Prints a row a window, and behind them how many windows of each valve have a name in their classes.
"""

import argparse
import collections
import sys
import time
import warnings
from pathlib import Path

from benchmarks.concealed.report.markdown import table
from benchmarks.real.halves import SOUND, read
from benchmarks.real.recordings import cases
from sklvalve import MissingPhysicsFinder

# shares of the rows that are sound
WINDOWS = ((0.0, 0.62), (0.0, 0.31), (0.31, 0.62), (0.155, 0.465), (0.62, 1.0))


def named_in(recording, window):
    """Verdict, classes of names, and seconds of a diagnosis of some rows."""
    began = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = MissingPhysicsFinder().fit(recording.slice(*window)).diagnosis_.to_dict()
    classes = [[member["name"] for member in effect["members"]] for effect in found["effects"]]
    return found["verdict"], classes, time.perf_counter() - began


def windows_of(rows):
    """First and last row of every window."""
    return [(round(a * rows), round(b * rows)) for a, b in WINDOWS]


def counts(classes_of_each):
    """Name -> in how many windows a class holds it, the most frequent first."""
    held = collections.Counter(
        name for classes in classes_of_each for name in {n for each in classes for n in each}
    )
    return dict(sorted(held.items(), key=lambda item: (-item[1], item[0])))


def main(argv=None):
    parser = argparse.ArgumentParser(prog="python -m benchmarks.real.windows", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="*", default=(), help="names begin with one of these")
    given = parser.parse_args(argv)
    rows, held = [], {}
    for case in cases(given.folder):
        if case.name not in SOUND or (given.only and not case.name.startswith(tuple(given.only))):
            continue
        recording = read(case)
        outcomes = {}
        for window in windows_of(SOUND[case.name] or len(recording)):
            verdict, classes, seconds = outcomes[window] = named_in(recording, window)
            names = "; ".join("/".join(each) for each in classes) or "-"
            rows.append((case.name, f"{window[0]}-{window[1]}", verdict, names, f"{seconds:.0f}"))
            print(*rows[-1], file=sys.stderr, flush=True)
        held[case.name] = counts(classes for _, classes, _ in outcomes.values())
    print(table(("valve", "rows", "verdict", "names", "s"), rows))
    print()
    said = [(name, ", ".join(f"{n} {k}" for n, k in each.items())) for name, each in held.items()]
    print(table(("valve", f"name in so many of {len(WINDOWS)} windows"), said))


if __name__ == "__main__":
    main()
