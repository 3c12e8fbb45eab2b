# SPDX-License-Identifier: BSD-3-Clause
"""Real recordings as a user has them, by the command line, one table.

    python -m benchmarks.real FOLDER [--out DIR] [--only NAME ...] [--jobs 1] [--limit S]
    python -m benchmarks.real --table RESULTS
    python -m benchmarks.real --page [RESULTS]

FOLDER is a copy of the shared recordings. Results go to DIR/results.jsonl (and results.csv), a line when a
recording is done; a line of the same code and arguments is not made again. NAME is the beginning of a name.
--page copies RESULTS into benchmarks/real/results and writes the block of docs/real_plants.md.
"""

import argparse
import contextlib
import json
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pandas as pd

from benchmarks.real import tables
from benchmarks.real.recordings import cases
from benchmarks.real.running import LIMIT, code_state, judge


def _kept(case, row, state):
    same = (row["label"], row["until"], row["note"], row["code"]) == (
        case.label,
        case.until,
        case.note,
        state,
    )
    return same and row["judgement"] != "failed"


def ran(folder, out, only=(), jobs=1, limit=LIMIT):
    """Rows of all recordings asked for; written to `out` as they come."""
    state, file = code_state(), Path(out) / "results.jsonl"
    file.parent.mkdir(parents=True, exist_ok=True)
    done = {row["recording"]: row for row in (tables.read(file) if file.exists() else [])}
    wanted = [c for c in cases(folder) if not only or c.name.startswith(tuple(only))]
    rows = {c.name: done[c.name] for c in wanted if c.name in done and _kept(c, done[c.name], state)}

    def one(case):
        try:
            return judge(case, Path(out) / "work", state, limit)
        except Exception as error:  # a recording that cannot be cut must not end the others
            row = {"recording": case.name, "kind": case.kind, "rows": 0, "sampling_s": 0.0, "seconds": 0.0}
            row |= {"label": case.label, "until": case.until, "note": case.note, "code": state}
            return row | {
                "verdict": "crash",
                "judgement": "failed",
                "reason": f"{type(error).__name__}: {error}",
            }

    with ThreadPoolExecutor(jobs) as pool:
        for row in pool.map(one, [c for c in wanted if c.name not in rows]):
            rows[row["recording"]] = row
            with file.open("a", encoding="utf-8") as lines:
                lines.write(json.dumps(row) + "\n")
            print(f"{row['recording']}: {row['verdict']}, {row['judgement']}, {row['seconds']} s", flush=True)
    ordered = [rows[c.name] for c in wanted]
    everything = {**done, **rows}
    file.write_text("".join(json.dumps(row) + "\n" for row in everything.values()), encoding="utf-8")
    pd.json_normalize(list(everything.values())).to_csv(file.with_suffix(".csv"), index=False)
    return ordered


def main():
    """Run, or print, or write the page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--out")
    parser.add_argument("--only", nargs="+", default=(), metavar="NAME")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--limit", type=float, default=LIMIT, metavar="S")
    parser.add_argument("--table", metavar="RESULTS")
    parser.add_argument("--page", nargs="?", const=str(tables.RESULTS), metavar="RESULTS")
    told = parser.parse_args()
    if told.table:
        print(tables.table(tables.read(told.table)))
    elif told.page:
        text = Path(told.page).read_text(encoding="utf-8")
        tables.RESULTS.write_text(text, encoding="utf-8")
        page = tables.with_block(tables.PAGE.read_text(encoding="utf-8"), tables.read(tables.RESULTS))
        tables.PAGE.write_text(page, encoding="utf-8")
    elif told.folder:
        with contextlib.ExitStack() as stack:
            out = told.out or stack.enter_context(tempfile.TemporaryDirectory())
            print(tables.table(ran(told.folder, out, told.only, told.jobs, told.limit)))
    else:
        parser.error("give the FOLDER of the recordings, --table or --page")


if __name__ == "__main__":
    main()
