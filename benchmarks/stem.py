# SPDX-License-Identifier: BSD-3-Clause
"""How long a run of the stem takes, and one with its derivatives, in turns on the same runs.

    python -m benchmarks.stem [--rows 5760] [--repeats 15]

Sound actuators with parameters drawn around where fits begin, and a command that steps, ramps and wanders.
"""

import argparse
import os
import statistics
import time

import numpy as np

from sklvalve.simulation.faults import FAULTS
from sklvalve.simulation.stem import NARROW, WIDE, positioner_and_actuator, stem_with_slopes

AIR, SPRING, SUPPLY = 101.325 / 80.0, (101.325 + 20.0) / 80.0, (101.325 + 140.0) / 80.0
#: Where fits begin: filter, gain, reset, rate, feedback, vent, lag, and sliding friction.
NUMBERS, FRICTION = np.array([0.1, 15.0, 0.3, 1.0, 0.1, 1.0, 0.06]), 0.008


def main(arguments=None):
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rows", type=int, default=5760)
    parser.add_argument("--repeats", type=int, default=15)
    asked = parser.parse_args(arguments)
    runs = [_run(asked.rows, seed) for seed in range(6)]
    ways = {"opening": _plain, f"and {NARROW} derivatives": _with(NARROW), f"and {WIDE}": _with(WIDE)}
    for way in ways.values():
        way(*runs[0])
    took = {name: [] for name in ways}
    print(f"load before {os.getloadavg()[0]:.1f}, {asked.rows} rows, {asked.repeats} repeats\n")
    for _ in range(asked.repeats):
        for name, way in ways.items():
            began = time.process_time()
            for run in runs:
                way(*run)
            took[name].append((time.process_time() - began) / (asked.rows * len(runs)) * 1e9)
    plain = statistics.median(took["opening"])
    print("| what | ns a row, median | least | runs without derivatives |\n|---|---|---|---|")
    for name, each in took.items():
        median = statistics.median(each)
        print(f"| {name} | {median:.0f} | {min(each):.0f} | {median / plain:.2f} |")


def _run(rows, seed):
    """A command, and the numbers of a positioner with its actuator."""
    rng = np.random.default_rng(seed)
    steps = np.repeat(rng.uniform(0.1, 0.9, rows // 60 + 1), 60)[:rows]
    wander = np.cumsum(rng.normal(0.0, 0.004, rows))
    command = np.clip(np.where(np.arange(rows) % 1200 < 600, steps, 0.5 + 0.4 * np.sin(wander)), 0.0, 1.0)
    return command, NUMBERS * np.exp(rng.normal(0.0, 0.3, len(NUMBERS)))


def _common(command):
    n = len(command)
    rows = np.full(n, SUPPLY), np.full(n, FRICTION), np.zeros(n), np.zeros(n)
    return command, np.ones(n), command[0], SPRING, AIR, *rows


def _plain(command, numbers):
    return positioner_and_actuator(*_common(command), np.empty((0, len(FAULTS))), *numbers)


def _with(width):
    none, like, towards = np.zeros((1, width)), (0,) * width, np.zeros((len(NUMBERS), width))
    towards[:, : len(NUMBERS)] = np.eye(len(NUMBERS))
    rows = (none,) * (5 + len(FAULTS))

    def run(command, numbers):
        return stem_with_slopes(*_common(command), np.zeros((1, len(FAULTS))), numbers, rows, towards, like)

    return run


if __name__ == "__main__":
    main()
