# SPDX-License-Identifier: BSD-3-Clause
"""python -m benchmarks.concealed.inject FOLDER DATA --seed N"""

import argparse
import json
from collections import Counter
from pathlib import Path

from benchmarks.concealed.inject.make import make


def main(arguments=None):
    """Write a set of records and print what it holds."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.inject",
        description="Put effects by physics into real healthy recordings.",
    )
    parser.add_argument("folder", type=Path, help="gets the records")
    parser.add_argument("data", type=Path, help="holds watersafe, damadics and refinery_loops")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    names = make(options.folder, options.data, options.seed)
    truths = [
        json.loads((options.folder / name / "truth.json").read_text(encoding="utf-8")) for name in names
    ]
    counted = Counter((truth["generator"], truth["kind"]) for truth in truths)
    for (generator, kind), count in sorted(counted.items()):
        print(f"{generator:20s} {kind:8s} {count}")
    apart = [truth["distinguishable"] for truth in truths if truth["kind"] == "single"]
    print(f"{len(names)} records; {sum(apart)} of {len(apart)} effects can be told apart from all others")


if __name__ == "__main__":
    main()
