# SPDX-License-Identifier: BSD-3-Clause
"""Whether the test that a diagnosis asks for keeps its promise: the plant makes it, and is diagnosed again.

    python -m benchmarks.next_test [FIRST LAST]

A plant with an effect is recorded; where the diagnosis leaves a class of several, the plant is moved by the
program that `plan_next_test` gives, behind the same recording, and both rows together are diagnosed again.
A row for each: the program, the members before and after, whether the concealed effect is still among them,
and of its pairs that the test was to set apart the distance D now, as expected, and as reached.
"""

import sys
import time

import numpy as np
import pandas as pd

from sklvalve.datasets._plant_draw import WARM_UP
from sklvalve.datasets._plant_effects import EFFECTS
from sklvalve.datasets._plant_rig import Plant
from sklvalve.mismatch import MissingPhysicsFinder, plan_next_test
from sklvalve.mismatch.advice import reopened
from sklvalve.recording import Recording, Valve

# (loop, effect) and the sizes in the plant's unit: those whose classes are the largest
CASES = (
    ("wide", "seat_leakage", 0.0375),
    ("wide", "bypass_open", 0.0375),
    ("mixed", "seat_leakage", 0.0375),
    ("wide", "flow_meter_bias", 0.0325),
    ("mixed", "flow_meter_bias", -0.0325),
    ("wide", "piping_reducers", 1.65),
    ("closed", "actuator_lag", 14.0),
    ("closed", "positioner_deadband", 0.026),
    ("wide", "friction", 500.0),
)


class Stand:
    """A drawn plant that is recorded, and then moved by a program.

    Parameters
    ----------
    strengths : dict
        Effect -> its size in the plant's unit; they act from the start.
    seed : int
    loop : {"wide", "closed", "mixed"}
    rows, test_rows : int, default=1500 and 900
        Of the recording, and at most of the test behind it.
    """

    def __init__(self, strengths, seed, *, loop="wide", rows=1500, test_rows=900):
        self.strengths, self.seed, self.rows = dict(strengths), seed, rows
        self.plant = Plant(np.random.default_rng(seed), list(strengths), loop, 1.0, rows + test_rows)
        self.valve = Valve.from_dict(self.plant.valve_table(("choked_flow",)))
        out, self.command = self.plant.run(self.strengths, 0.0, seed)
        self.recording = self._read(out, rows)

    def _read(self, out, rows):
        return Recording.from_frame(pd.DataFrame(self.plant.record(out)).iloc[:rows], self.valve)

    def tested(self, plan):
        """The recording and, behind it, what it goes on with when a plan is carried out.

        The pressures of source and tank are moved, so that those at the valve follow less far.
        """
        begin = WARM_UP + self.rows
        rows, command = slice(begin, begin + len(plan.command)), self.command.copy()
        command[rows] = plan.command
        source, tank = self.plant.source, self.plant.tank
        self.plant.source, self.plant.tank = source.copy(), tank.copy()
        self.plant.source[rows] += plan.moved.get("p1", 0.0)
        self.plant.tank[rows] += plan.moved.get("p2", 0.0)
        out, _ = self.plant.run(self.strengths, 0.0, self.seed, replay=command)
        self.plant.source, self.plant.tank = source, tank
        return self._read(out, self.rows + len(plan.command))


def measured(loop, name, size, seed):
    """A row for one case; None where nothing is open that a test of the command could tell."""
    stand = Stand({name: size}, seed, loop=loop)
    finder = MissingPhysicsFinder().fit(stand.recording)
    before = [c for c in finder.diagnosis_.effects if len(c) > 1]
    told = EFFECTS[name].told
    if not before:
        return None
    began = time.perf_counter()
    plan = plan_next_test(finder, stand.recording)
    row = {"loop": loop, "effect": name, "seed": seed, "before": "/".join(before[0])}
    if plan is None or plan.sensor or not plan.pairs:
        return row | {"program": "none"}
    row |= {"program": plan.name, "seconds": round(time.perf_counter() - began, 1)}
    both = stand.tested(plan)
    again = MissingPhysicsFinder().fit(both)
    classes = again.diagnosis_.effects
    row["verdict"] = again.diagnosis_.verdict
    row |= {"after": " + ".join("/".join(c) for c in classes), "held": any(told in c for c in classes)}
    pairs = [p for p in plan.pairs if told in p.names and p.expected > p.now + 1.0]
    _, findings = reopened(again, both, names=[n for p in pairs for n in p.names])
    reached = {r.term.effect.name: r.distance for f in findings for r in reversed(f.rivals)}
    for pair in pairs:
        other = next(n for n in pair.names if n != told)
        row.setdefault("D now", []).append(round(pair.now, 1))
        row.setdefault("expected", []).append(round(pair.if_true[pair.names.index(told)], 1))
        row.setdefault("reached", []).append(round(reached.get(other, np.nan), 1))
    return row


def main(first=31, last=34):
    """Print the table for seeds from `first` up to, not including, `last`."""
    rows = []
    for case in CASES:
        for seed in range(first, last):
            row = measured(*case, seed)
            if row is not None:
                rows.append(row)
                print(row, flush=True)
    table = pd.DataFrame(rows).fillna("")
    print(table.to_string(index=False))
    made = table[table.program != "none"]
    held = made[made.held.astype(bool)]
    fewer = [
        len(a.replace(" + ", "/").split("/")) < len(b.split("/"))
        for a, b in zip(held.after, held.before, strict=True)
    ]
    print(f"classes open: {len(table)}, tests planned: {len(made)}, smaller with the truth in: {sum(fewer)}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
