# SPDX-License-Identifier: BSD-3-Clause
"""Print the tables of files of scores, and draw their curves."""

import argparse
import sys
from pathlib import Path

from benchmarks.concealed.report.curves import power_curve, reliability_curve
from benchmarks.concealed.report.trial import report
from benchmarks.concealed.scoring.lines import DEFAULT_METHOD, read_lines


def main(arguments=None):
    """Print the tables; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.concealed.report", description=__doc__)
    parser.add_argument("scores", type=Path, nargs="+", help="files of scores, one line of JSON a record")
    parser.add_argument("--method", default=DEFAULT_METHOD, help="whose tables to print below the headline")
    parser.add_argument("--folder", nargs="+", help="count only records of these folders")
    parser.add_argument("--out", type=Path, help="folder for tables.md, power.svg and .png, reliability.*")
    options = parser.parse_args(arguments)
    missing = [str(path) for path in options.scores if not path.is_file()]
    if missing:
        parser.error(f"expected files of scores, but there is no {', '.join(missing)}")
    lines = read_lines(*options.scores)
    if options.folder:
        lines = [line for line in lines if line.get("folder") in options.folder]
    try:
        text = report(lines, options.method)
    except ValueError as error:
        parser.error(str(error))
    print(text)
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
        (options.out / "tables.md").write_text(text + "\n", encoding="utf-8")
        for suffix in ("svg", "png"):
            power_curve(lines, options.out / f"power.{suffix}")
            reliability_curve(lines, options.out / f"reliability.{suffix}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
