# SPDX-License-Identifier: BSD-3-Clause
"""The next test, judged: ambiguous records are drawn, tested as they ask for, and diagnosed again.

    python -m benchmarks.concealed.next_test FOLDER --seed 7 --records 50

A record is ambiguous where the diagnosis leaves a class of several with the truth in it. Its test moves the
same plant behind the same recording, and both are diagnosed together. It splits rightly where the truth is
still named and none is left of those that the test was to set apart and that the plant's own distances tell.
FOLDER gets a line of `next_test.jsonl` for every record drawn, and `next_test.md`; stopped, it goes on.
"""

import argparse
import json
import multiprocessing
import sys
from pathlib import Path

from benchmarks.concealed.next_test.tables import tables
from benchmarks.concealed.next_test.trial import line_of
from benchmarks.concealed.plant import NAMED
from benchmarks.concealed.run import code, plain_lines

# of so many records drawn, one at least should be ambiguous
_MOST_DRAWN = 8


def main(arguments=None):
    """Run it; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.next_test", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--records", type=int, default=50, help="ambiguous records; 50")
    parser.add_argument("--kinds", nargs="*", choices=NAMED, default=[], metavar="EFFECT")
    parser.add_argument("--jobs", type=int, default=1, help="processes; 1")
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    file, commit = options.folder / "next_test.jsonl", code()
    lines = plain_lines(file)
    if other := {line["seed_of_draw"] for line in lines} - {options.seed}:
        parser.error(f"{file} holds records of seed {other.pop()}; give that seed, or another folder")
    with multiprocessing.get_context("spawn").Pool(options.jobs, maxtasksperchild=20) as pool:
        while _open(lines) < options.records and len(lines) < _MOST_DRAWN * options.records:
            known = {line["number"] for line in lines}
            new = [k for k in range(len(lines) + 2 * options.jobs) if k not in known][: options.jobs]
            work = [(options.seed, k, options.kinds) for k in new]
            for line in pool.starmap(line_of, work):
                lines.append(line | {"seed_of_draw": options.seed, "code": commit})
                with file.open("a", encoding="utf-8") as stream:
                    stream.write(json.dumps(lines[-1], default=float) + "\n")
                print(_said(line), flush=True)
    text = tables(sorted(lines, key=lambda line: line["number"]))
    (options.folder / "next_test.md").write_text(text, encoding="utf-8")
    print(text)
    return 0


def _open(lines):
    return sum(line["outcome"] is not None for line in lines)


def _said(line):
    said = line.get("failed") or line.get("why") or line["outcome"] or f"{line['verdict']} {line['classes']}"
    return f"{line['number']} {line['effect']} {line['excitation']} {line['step']:g}: {said}"


if __name__ == "__main__":
    sys.exit(main())
