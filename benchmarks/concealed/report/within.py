# SPDX-License-Identifier: BSD-3-Clause
"""Tables of effects inside the sheet's tolerance, judged without a history and with one."""

import numpy as np

from benchmarks.concealed.distances.detectable import DISTANCE
from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.report.with_history import other_excitation, rows_of
from benchmarks.concealed.scoring.agreement import paired
from benchmarks.concealed.scoring.lines import by_method, concealed, failed, grouped, told_mismatch
from benchmarks.concealed.scoring.naming import class_size
from benchmarks.concealed.scoring.outcome import judge, wrongly_named
from benchmarks.concealed.scoring.rates import rate_of

#: A longer class says too little to count as a name.
MOST_NAMES = 3


def noticed(line):
    """Whether a mismatch is told."""
    return bool(told_mismatch(line))


def named(line):
    """Whether the effect is named rightly, in a class of at most three names."""
    return judge(line) == "right" and class_size(line) <= MOST_NAMES


WHAT = {"noticed": noticed, f"named, at most {MOST_NAMES} names": named, "wrong name": wrongly_named}


def within_report(lines):
    """All tables, in Markdown.

    Parameters
    ----------
    lines : sequence of dict
        Lines of scores of one method or of two, the first of them without a history.

    Returns
    -------
    text : str
    """
    methods = by_method(lines)
    parts = [section(name, _overall(some), _by_effect(some)) for name, some in methods.items()]
    if len(methods) == 2:
        pairs = paired(*methods.values())
        head = ["", *methods, "only the first", "only the second", "McNemar p"]
        every = {label: (lambda line: True, what) for label, what in WHAT.items()}
        parts.append(section("The same records", table(head, rows_of(pairs, every))))
    return "\n\n".join(parts)


def _rates(lines):
    return [rate_of(what(line) for line in lines) for what in WHAT.values()]


def _overall(lines):
    groups = {
        "all": lines,
        "history excited as the record": [line for line in lines if not other_excitation(line)],
        "history excited in another way": [line for line in lines if other_excitation(line)],
        f"sheet leaves it open (D below {DISTANCE:g})": [
            line for line in lines if _of_sheet(line) < DISTANCE
        ],
    }
    rows = [
        [label, len(some), *_rates(some), sum(map(failed, some))] for label, some in groups.items() if some
    ]
    return table(["", "records", *WHAT, "broke"], rows)


def _by_effect(lines):
    rows = []
    for name, some in sorted(grouped(lines, concealed).items()):
        moved = 100.0 * _median(line["truth"].get("moved_share", np.nan) for line in some)
        apart = [f"{_median(line_of(line) for line in some):.0f}" for line_of in (_of_sheet, _of_known)]
        rows.append([name, len(some), f"{moved:.2f} %", *apart, *_rates(some)])
    return table(["effect", "records", "moves (median)", "D, sheet", "D, valve known", *WHAT], rows)


def _of_sheet(line):
    return (line["truth"].get("distances") or {}).get("nothing", np.nan)


def _of_known(line):
    return line["truth"].get("known_distance", np.nan)


def _median(values):
    return float(np.median(list(values)))
