# SPDX-License-Identifier: BSD-3-Clause
"""Real recordings held against earlier rows of themselves: what has not changed must raise no alarm.

    python -m benchmarks.real.halves DATA

DATA is a copy of the shared recordings. The hour of DAMADICS and every valve of watersafe are cut into parts;
an earlier part is the history of a later one, learnt as `sklvalve learn` does it. Nobody has labelled the
valves: some have play or a slow motor, but they have it in all parts, so that nothing new is there to be
told. VA_C4 no longer follows its command from 9,757 s on, and is held against its first 6,000 s.

Prints a table, a row a comparison.
"""

import argparse
import sys
import time
import warnings
from pathlib import Path
from typing import NamedTuple

from benchmarks.concealed.report.markdown import table
from benchmarks.real.recordings import cases
from sklvalve import MissingPhysicsFinder, Recording, Valve

# shares of a recording: of its history, and of what is held against it
PARTS = (((0.0, 1 / 3), (1 / 3, 2 / 3)), ((1 / 3, 2 / 3), (2 / 3, 1.0)), ((0.0, 0.5), (0.5, 1.0)))
#: Of these so many rows are sound; VA_C4 as a whole is the one that breaks.
SOUND = {
    "damadics_hour": None,
    "watersafe_VA_A1": 9_700,
    "watersafe_VA_B4": 9_700,
    "watersafe_VA_C1": 9_700,
    "watersafe_VA_C3": 9_700,
    "watersafe_VA_C4": 9_700,
}
BROKEN, HEALTHY_ROWS = "watersafe_VA_C4_all", 6_000
NAMES = {"stuck_valve", "clogging"}


class Outcome(NamedTuple):
    """One comparison."""

    name: str
    history: str
    rows: str
    verdict: str
    names: str
    p_value: float | None
    seconds: float
    right: bool


def compared(name, recording, before, now, expected=frozenset()):
    """Outcome of rows `now` held against rows `before`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        history = MissingPhysicsFinder().history_of(recording.slice(*before))
        began = time.perf_counter()
        finder = MissingPhysicsFinder(history=history).fit(recording.slice(*now))
        found = finder.diagnosis_.to_dict()
    classes = [{member["name"] for member in entry["members"]} for entry in found["effects"]]
    right = found["verdict"] == "no_mismatch"
    if expected:
        right = found["verdict"] == "named" and any(names & expected for names in classes)
    told = " + ".join("/".join(sorted(names)) for names in classes)
    span = "{} to {}".format
    seconds = time.perf_counter() - began
    p_value = found["mismatch"]["p_value"]
    return Outcome(name, span(*before), span(*now), found["verdict"], told, p_value, seconds, right)


def outcomes(data):
    """All comparisons of a folder of recordings."""
    known = {case.name: case for case in cases(data) if case.name in {*SOUND, BROKEN}}
    for name, case in known.items():
        recording = read(case)
        if name == BROKEN:
            rows = (HEALTHY_ROWS, len(recording))
            yield compared(name, recording, (0, HEALTHY_ROWS), rows, frozenset(NAMES))
            continue
        n = SOUND[name] or len(recording)
        for before, now in PARTS:
            yield compared(
                name, recording, *(tuple(int(share * n) for share in part) for part in (before, now))
            )


def read(case):
    """The whole recording of a case, by the sheet that a user would write of it."""
    import tomllib

    return Recording.from_frame(case.table(), Valve.from_dict(tomllib.loads(case.sheet)))


def main(arguments=None):
    """Print the table; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.real.halves", description=__doc__)
    parser.add_argument("data", type=Path)
    options = parser.parse_args(arguments)
    rows, sound, named = [], [], 0
    for each in outcomes(options.data):
        p_value = "-" if each.p_value is None else f"{each.p_value:.2g}"
        cells = [each.name, each.history, each.rows, each.verdict, each.names or "-", p_value]
        rows.append([*cells, f"{each.seconds:.1f}", "yes" if each.right else "no"])
        if each.name != BROKEN:
            sound.append(each.right)
            named += each.verdict == "named"
    print(table(["recording", "history", "rows", "verdict", "names", "p", "seconds", "right"], rows))
    alarms = len(sound) - sum(sound)
    print(
        f"\n{alarms} alarms in {len(sound)} comparisons of parts that are alike, {named} of them with a name"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
