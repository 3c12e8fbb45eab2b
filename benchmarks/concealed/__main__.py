# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark in one command: draw records, seal their truths, diagnose, score, and print the tables.

    python -m benchmarks.concealed FOLDER --seed 7                      the whole of it
    python -m benchmarks.concealed FOLDER --seed 7 --small              a quick look: some 60 records
    python -m benchmarks.concealed FOLDER --methods sklvalve            records that are there, one method
    python -m benchmarks.concealed FOLDER --given                       with the user's own simulation
    python -m benchmarks.concealed FOLDER --histories                   and an hour from before each record

Stopped and started again, it goes on where it was. FOLDER then holds a folder for every record, `seal.txt`, a
file of scores for every method, `runs.log`, `tables.md`, and the curves. A method of one's own joins by one
module in `benchmarks/concealed/methods` (see its ``__init__``).
"""

import argparse
import sys
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from benchmarks.concealed.draw import HISTORY, broken_seals, seal, unsealed
from benchmarks.concealed.histories.add import add_histories
from benchmarks.concealed.methods import METHODS, WITH_HISTORY
from benchmarks.concealed.methods.random_forest import learn
from benchmarks.concealed.report.__main__ import main as report
from benchmarks.concealed.report.with_history import main as compare
from benchmarks.concealed.run import draw_all, judge_all, log

WHOLE = {"healthy": 200, "each": 6, "pairs": 60, "outside": 80, "defects": 16}
SMALL = {"healthy": 15, "each": 1, "pairs": 6, "outside": 8, "defects": 2}


def main(arguments=None):
    """Run it; returns the exit status."""
    parser = _parser()
    options = parser.parse_args(arguments)
    folder = options.folder.resolve()
    try:
        _drawn(folder, options)
    except ValueError as error:
        parser.error(str(error))
    names = _methods(folder, options)
    if not names:
        return 0
    if "random_forest" in names:
        learn(folder / "learnt")
    try:
        files = judge_all(folder, names, options.jobs, given=options.given, every=options.every)
    except BrokenProcessPool:
        parser.exit(1, "a process that judges was ended, for want of memory perhaps; start again to go on\n")
    out = folder / ("report_given" if options.given else "report")
    shown = "sklvalve" if "sklvalve" in names else names[0]
    status = report([*map(str, files), "--method", shown, "--out", str(out)])
    if {"sklvalve", "sklvalve_history"} <= set(names):
        compare([str(folder / f"scores_{name}.jsonl") for name in ("sklvalve", "sklvalve_history")])
    return status


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, help="draw the records of this seed; none are drawn without")
    parser.add_argument("--small", action="store_true", help="a tenth of the records")
    for name, many in WHOLE.items():
        parser.add_argument(
            f"--{name}", type=int, help=f"records of this kind (of each effect, if each); {many}"
        )
    parser.add_argument("--methods", nargs="*", choices=METHODS, metavar="NAME", help="all unless given")
    parser.add_argument(
        "--histories", action="store_true", help="give every record a history, and judge with it as well"
    )
    parser.add_argument(
        "--given", action="store_true", help="hold the user's own simulation against the flow"
    )
    parser.add_argument("--every", type=int, default=1, help="judge every so many records only; 1")
    parser.add_argument("--jobs", type=int, default=2, help="processes; 2")
    return parser


def _drawn(folder, options):
    """Draw what is asked for, and see to it that all records of the folder are there and sealed."""
    if (folder / "seal.txt").exists() and not (folder / "salt.txt").exists():
        raise ValueError(f"{folder} holds seal.txt, and no salt.txt by which it was made; put it back")
    if broken := broken_seals(folder):
        raise ValueError(f"the truth of {', '.join(broken)} is not the one that was sealed")
    if options.seed is not None:
        sizes = dict(SMALL if options.small else WHOLE)
        sizes |= {name: getattr(options, name) for name in WHOLE if getattr(options, name) is not None}
        draw_all(folder, options.seed, options.jobs, options.histories, **sizes)
        log(folder, f"drawn with seed {options.seed} and {sizes}; sealed as {seal(folder)}")
    if not any(folder.glob("record_*/truth.json")):
        raise ValueError(f"expected records in {folder}, or a --seed to draw them by")
    if new := unsealed(folder):
        raise ValueError(f"{len(new)} records, first {new[0]}, are not sealed: give the --seed of their draw")
    if options.histories and (added := add_histories(folder)):
        log(folder, f"{len(added)} histories added to records that were there; sealed as {seal(folder)}")


def _methods(folder, options):
    """Methods to judge: those asked for, or all that the folder's records have what they need for."""
    if options.given:
        return ["sklvalve"]
    if options.methods is not None:
        return options.methods
    known = any(folder.glob(f"record_*/{HISTORY}"))
    return [name for name in METHODS if known or name not in WITH_HISTORY]


if __name__ == "__main__":
    sys.exit(main())
