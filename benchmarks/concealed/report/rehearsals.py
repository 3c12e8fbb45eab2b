# SPDX-License-Identifier: BSD-3-Clause
"""Whether p is uniform on healthy valves of another plant than that of the null reference.

python -m benchmarks.concealed.report.rehearsals SCORES...

When a history is learnt its second half is compared with the first, by the whole search. Lines of a method
with a history keep what came of it. Halves of a sound history are healthy, and nobody has named them.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from scipy.stats import kstest

from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.scoring.lines import read_lines
from benchmarks.concealed.scoring.rates import rate_of
from sklvalve.history.rehearsal import Rehearsal
from sklvalve.mismatch.decide.rehearsing import p_value_of_rehearsal

LEVELS = (0.01, 0.05, 0.1)


def p_values_of(lines):
    """Sorted p-values of halves of sound histories."""
    sound = [line for line in lines if line["truth"].get("history", {}).get("clean")]
    found = [
        p_value_of_rehearsal(Rehearsal.from_dict(each))
        for line in sound
        for each in line.get("rehearsals", ())
    ]
    return np.sort(found)


def rehearsals_report(lines):
    """Table of rates in Markdown, or a sentence where the lines hold no rehearsals."""
    p_values = p_values_of(lines)
    if not len(p_values):
        return "No line holds a rehearsal of a sound history."
    rows = [[f"p at most {level:g}", rate_of(p_values <= level)] for level in LEVELS]
    uniform = kstest(p_values, "uniform").pvalue
    rows.append(["Kolmogorov-Smirnov p", f"{uniform:.2f} of {len(p_values)}"])
    return table(["halves of sound histories", "measured"], rows)


def main(arguments=None):
    """Read and print; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.report.rehearsals", description=__doc__.splitlines()[0]
    )
    parser.add_argument("scores", nargs="+", type=Path)
    print(rehearsals_report(read_lines(*parser.parse_args(arguments).scores)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
