# SPDX-License-Identifier: BSD-3-Clause
"""A detector on the 44 scenarios of the DAMADICS benchmark.

    python -m benchmarks.damadics FOLDER                             ours, simulation learnt on a sound run
    python -m benchmarks.damadics FOLDER --simulation nominal        with the generator's own sound run
    python -m benchmarks.damadics FOLDER --detector module:function  any: what the function returns has fit
                                                                     and predict, see detector.py
    python -m benchmarks.damadics FOLDER --seed 8 --watch-only       other noise, and the finder is not asked
    python -m benchmarks.damadics FOLDER --tables                    tables of what is there

Stopped and started again, it goes on where it was. FOLDER then holds `NAME.jsonl`, a line a scenario and one
of ten sound hours, for each detector and seed.
"""

import argparse
import importlib
import json
import sys
from pathlib import Path

from joblib import Parallel, delayed

from benchmarks.damadics.detector import ValveDetector
from benchmarks.damadics.runner import SOUND, false_alarms, fitted, score
from benchmarks.damadics.simulations import SIMULATIONS
from benchmarks.damadics.tables import tables
from sklvalve.damadics import SCENARIOS

#: Seeds of the noise: of the sound run that a detector learns from, of the scenarios, of other sound hours.
LEARNT_FROM, SCENARIO_SEED, SOUND_HOURS = 101, 7, range(201, 211)


def lines_of(file):
    """Lines that a run has left in a file, whole ones only, by scenario."""
    if not file.exists():
        return {}
    whole = [line for line in file.read_text().splitlines(keepends=True) if line.endswith("\n")]
    return {line["scenario"]: line for line in map(json.loads, whole)}


def measure(make, file, wanted, seed=SCENARIO_SEED, jobs=1, report=print):
    """Add the lines of a detector that its file lacks.

    Parameters
    ----------
    make : callable
        Makes an unfitted detector.
    file : Path
    wanted : sequence of str
        Names of scenarios.
    seed : int
        Of their noise.
    jobs : int
        Processes.
    """
    done = lines_of(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    # what a stopped run has left of a line would spoil the next one
    file.write_text("".join(json.dumps(line) + "\n" for line in done.values()))
    # those of a day last
    wanted = sorted(wanted, key=lambda name: SCENARIOS[name].horizon)
    left = [name for name in (SOUND, *wanted) if name not in done]
    if not left:
        return
    detector = fitted(make(), LEARNT_FROM)
    lines = Parallel(jobs, return_as="generator")(delayed(_line)(detector, name, seed) for name in left)
    with file.open("a") as out:
        for at, line in enumerate(lines, 1):
            out.write(json.dumps(line) + "\n")
            out.flush()
            report(f"{at} of {len(left)}: {line['scenario']}")


def _line(detector, name, seed):
    if name == SOUND:
        return {"scenario": SOUND, "false": [false_alarms(detector, seed) for seed in SOUND_HOURS]}
    return score(detector, name, seed)


def _made_by(parser, detector):
    """Function by the name that was given; what is none is one sentence and an exit."""
    module, _, function = detector.partition(":")
    try:
        make = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError, ValueError, TypeError) as error:
        parser.error(f"--detector {detector}: expected MODULE:FUNCTION that can be imported ({error})")
    if not callable(make):
        parser.error(f"--detector {detector}: expected a function that makes a detector, got {make!r}")
    return make


def main(arguments=None):
    """Run it; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.damadics", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path, help="results are kept here")
    parser.add_argument("--simulation", choices=SIMULATIONS, default="learnt")
    parser.add_argument("--detector", metavar="MODULE:FUNCTION", help="of another detector")
    parser.add_argument("--only", nargs="+", choices=SCENARIOS, default=list(SCENARIOS), metavar="SCENARIO")
    parser.add_argument(
        "--seed", type=int, default=SCENARIO_SEED, help="of the scenarios' noise (default: 7)"
    )
    parser.add_argument("--watch-only", action="store_true", help="ours, without the finder")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default: 1)")
    parser.add_argument("--tables", action="store_true", help="measure nothing, print what is there")
    options = parser.parse_args(arguments)
    if options.folder.exists() and not options.folder.is_dir():
        parser.error(f"{options.folder} is a file; name a folder")
    name, make = options.simulation, lambda: ValveDetector(options.simulation, not options.watch_only)
    if options.detector:
        name, make = options.detector.replace(":", "."), _made_by(parser, options.detector)
    if options.seed != SCENARIO_SEED:
        name = f"{name}-{options.seed}"
    if not options.tables:
        file = options.folder / f"{name}{'-watch' if options.watch_only else ''}.jsonl"
        measure(make, file, options.only, options.seed, options.jobs)
    files = sorted(options.folder.glob("*.jsonl"))
    if not files:
        parser.error(f"{options.folder} holds no results; name the folder of a run, or leave --tables out")
    for file in files:
        print(tables(file.stem, lines_of(file)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
