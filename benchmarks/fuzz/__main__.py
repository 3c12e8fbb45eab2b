# SPDX-License-Identifier: BSD-3-Clause
"""Mutated inputs of every kind that the package reads, one table.

    python -m benchmarks.fuzz [--inputs N] [--seed N] [--only KIND ...] [--keep DIR]

N inputs of each kind are made from seeds that are made here too: valve.toml, recordings as CSV, packed CSV
and Parquet, exports of historians, model files of finders and of estimators with a right checksum. Nothing
but the package's own error may come of them, in one printable sentence; nothing that is accepted may hold an
infinity; nothing may take more than 10 s or a GiB of memory. --keep writes the first input of each kind of
failure into a folder. Ends with 1 where something failed. Needs a POSIX system.
"""

import argparse
import sys
from pathlib import Path

from benchmarks.fuzz.running import LONGEST, MOST_MEMORY, run
from benchmarks.fuzz.seeds import KINDS
from benchmarks.fuzz.targets import NAMES


def table(outcomes):
    """Rows of text, a kind each, and under them what failed."""
    head = ("kind", "inputs", "refused", "accepted", "other exceptions", "slowest [s]", "peak memory [MiB]")
    rows = [
        (
            each.kind,
            str(each.inputs),
            str(each.refused),
            str(each.accepted),
            str(sum(each.escaped.values())),
            f"{each.slowest:.2f}",
            f"{each.memory:.0f}",
        )
        for each in outcomes
    ]
    widths = [max(len(row[k]) for row in (head, *rows)) for k in range(len(head))]
    lines = []
    for kind, *numbers in (head, *rows):
        cells = [cell.rjust(width) for cell, width in zip(numbers, widths[1:], strict=True)]
        lines.append("  ".join([kind.ljust(widths[0]), *cells]))
    failed = [
        f"{each.kind}: {count} x {what!r}" for each in outcomes for what, count in each.escaped.most_common()
    ]
    return "\n".join([*lines, *failed])


def main(argv=None):
    """Run and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, prog="benchmarks.fuzz"
    )
    parser.add_argument("--inputs", type=int, default=2000, metavar="N", help="of each kind (default: 2000)")
    parser.add_argument("--seed", type=int, default=0, metavar="N")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=KINDS, metavar="KIND")
    parser.add_argument("--keep", type=Path, metavar="DIR")
    args = parser.parse_args(argv)
    outcomes = [run(kind, args.inputs, args.seed) for kind in args.only]
    print(table(outcomes))
    if args.keep is not None:
        args.keep.mkdir(parents=True, exist_ok=True)
        for each in outcomes:
            for k, content in enumerate(each.examples.values()):
                (args.keep / f"{k}-{NAMES[each.kind]}").write_bytes(content)
    return int(any(each.escaped or each.slowest > LONGEST or each.memory > MOST_MEMORY for each in outcomes))


if __name__ == "__main__":
    sys.exit(main())
