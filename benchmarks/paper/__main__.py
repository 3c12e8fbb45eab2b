# SPDX-License-Identifier: BSD-3-Clause
"""The paper's experiment in one command: simulate, tune, test, and print the tables.

    python -m benchmarks.paper FOLDER                       20 seeds
    python -m benchmarks.paper FOLDER --seeds 5             fewer
    python -m benchmarks.paper FOLDER --quick               one seed, no 1,500 rows: a look
    python -m benchmarks.paper FOLDER --seeds 0 --figures docs    tables and figures of what is there

Stopped and started again, it goes on where it was. FOLDER then holds `results.jsonl`, a line for every task,
number of rows and seed, and `tables.md`.
"""

import argparse
import json
import sys
import time
from pathlib import Path

from benchmarks.paper import dynamic, static
from benchmarks.paper.runs import SCENARIOS
from benchmarks.paper.tables import read, tables, whole_lines

#: Rows to train on; all there are in normal runs and in the dynamic form.
ROWS = {"whole": (50, 200), "standard": (200,), "f2": (200,), "f18": (200,)}


def cells(seeds, quick=False):
    """Scenario, task, rows and seed of everything to do, seed by seed; quickly no more than 200 rows."""
    for seed in seeds:
        for scenario, tasks in {**dict.fromkeys(SCENARIOS, static.TASKS), "dynamic": ("X and F",)}.items():
            many = ROWS.get(scenario, static.ROWS)
            yield from (
                (scenario, task, rows, seed) for task in tasks for rows in many if rows <= 200 or not quick
            )


def measure(folder, wanted, report=print):
    """Append the lines of every cell that is not in the folder's results yet."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "results.jsonl"
    whole = whole_lines(file)
    if file.exists():
        # what a stopped run has left of a line, be it the first, would spoil the next one
        file.write_text("".join(whole))
    done = {tuple(json.loads(line)["cell"]) for line in whole}
    left = [cell for cell in wanted if cell not in done]
    began = time.perf_counter()
    for at, cell in enumerate(left, 1):
        scenario, task, rows, seed = cell
        if scenario == "dynamic":
            lines = dynamic.lines_of(rows, seed)
        else:
            lines = static.lines_of(scenario, task, rows, seed)
        with file.open("a") as out:
            out.write(json.dumps({"cell": cell, "lines": lines}) + "\n")
        report(f"{at} of {len(left)}, {time.perf_counter() - began:.0f} s: {cell}")
    return file


def main(arguments=None):
    """Run it; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.paper", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="results are kept here")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--quick", action="store_true", help="one seed, 50 and 200 rows only")
    parser.add_argument("--figures", type=Path, help="draw the figures into this folder as well")
    options = parser.parse_args(arguments)
    seeds = range(1 if options.quick else options.seeds)
    file = measure(options.folder, list(cells(seeds, options.quick)))
    lines = read(file)
    if not lines:
        parser.error(f"{options.folder} holds no results, and --seeds {options.seeds} asks for none")
    text = tables(lines)
    (options.folder / "tables.md").write_text(text)
    print(text)
    if options.figures:
        from benchmarks.paper.figures import draw

        draw(lines, options.figures)
    return 0


if __name__ == "__main__":
    sys.exit(main())
