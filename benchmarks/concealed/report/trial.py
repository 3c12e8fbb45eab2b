# SPDX-License-Identifier: BSD-3-Clause
"""All tables of a trial."""

import numpy as np

from benchmarks.concealed.report.breakdown import (
    accuracy_table,
    calibration_table,
    improvement_table,
    outcomes,
    power_table,
)
from benchmarks.concealed.report.comparison import comparison
from benchmarks.concealed.report.failures import failures
from benchmarks.concealed.report.headline import headline
from benchmarks.concealed.scoring.cost import codes, cost, load
from benchmarks.concealed.scoring.lines import DEFAULT_METHOD, by_method


def expense(lines):
    """Sentence on time, memory, load, and the code that was judged."""
    seconds, memory = cost(lines), cost(lines, "peak_mb")
    parts = [f"{len(lines)} records"]
    if seconds.of:
        parts.append(f"{seconds.median:.0f} s in the median, {seconds.most:.0f} s at most")
    if memory.of:
        parts.append(f"{memory.median:.0f} MB in the median, {memory.most:.0f} MB at most")
    text = ", ".join(parts)
    if not np.isnan(load(lines)):
        text += f"; load {load(lines):.1f}"
    return text + "; code " + ", ".join(f"{code} ({n})" for code, n in codes(lines).items()) + "."


def summary(lines):
    """Text of all tables of one method but the headline."""
    makers = (outcomes, power_table, accuracy_table, improvement_table, calibration_table, failures, expense)
    return "\n\n".join(text for make in makers if (text := make(lines)))


def report(lines, method=DEFAULT_METHOD):
    """The headline and the comparison of all methods, then all tables of one.

    Raises
    ------
    ValueError
        Where there is no line of that method.
    """
    methods = by_method(lines)
    if method not in methods:
        known = ", ".join(methods) or "none"
        raise ValueError(f"expected lines of the method {method!r}, got those of: {known}; choose another")
    parts = [headline(lines), comparison(lines), f"## {method}", summary(methods[method])]
    return "\n\n".join(part for part in parts if part)
