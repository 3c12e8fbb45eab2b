# SPDX-License-Identifier: BSD-3-Clause
"""Curves of a trial: power against size, and how far probabilities can be trusted."""

import numpy as np

from benchmarks.concealed.scoring.calibration import calibration
from benchmarks.concealed.scoring.detection import power, power_by_times
from benchmarks.concealed.scoring.lines import by_method

COLOURS = ("#1b5e8c", "#c2571a", "#3f8f4f", "#8a4f9e", "#6b6b6b", "#b8a11e")
# Methods stand beside each other, so that no interval hides another.
SHIFT = 0.03


def _figure(width, height, rows=1, columns=1, **settings):
    """A figure with its axes; needs no screen."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError('curves need matplotlib; install it with pip install "sklvalve[plot]"') from None
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **settings)
    for axis in axes.flat:
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(color="#dddddd", linewidth=0.6)
        axis.set_axisbelow(True)
    return figure, axes


def _with_intervals(axis, at, rates, colour, label):
    """Rates in percent with their exact intervals."""
    values = 100.0 * np.array([rate.value for rate in rates])
    ends = 100.0 * np.array([rate.ends for rate in rates]).T
    # rounding may put an end a hair on the wrong side of its rate
    reach = np.maximum(np.abs(ends - values), 0.0)
    axis.errorbar(at, values, yerr=reach, color=colour, label=label, marker="o", ms=4, lw=1.4, capsize=2.5)


def power_curve(lines, path):
    """Draw how often a mismatch is told, and named rightly, against size.

    Parameters
    ----------
    lines : list of dict
        Of any number of methods. Sizes are the planned ones where lines tell them, else as drawn.
    path : path-like
        File to write; its suffix chooses the format (.png, .svg).

    Returns
    -------
    drawn : bool
        False, and no file, where no line has a size.
    """
    rows = {name: power(some) or power_by_times(some) for name, some in by_method(lines).items()}
    rows = {name: points for name, points in rows.items() if points}
    if not rows:
        return False
    figure, ((left, right),) = _figure(8.0, 3.4, columns=2, sharex=True, sharey=True)
    middle = (len(rows) - 1) / 2.0
    for i, (name, points) in enumerate(rows.items()):
        at = np.array([point.size for point in points]) + SHIFT * (i - middle)
        colour = COLOURS[i % len(COLOURS)]
        _with_intervals(left, at, [point.detected for point in points], colour, name)
        _with_intervals(right, at, [point.right for point in points], colour, name)
    left.set(title="a mismatch is told", ylabel="records with one effect [%]", ylim=(-3.0, 103.0))
    right.set(title="the effect is named rightly")
    for axis in (left, right):
        axis.set_xlabel("size, times what the record can just tell")
    right.legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=150)
    return True


def reliability_curve(lines, path):
    """Draw how many classes hold a true name, against the probability told of them.

    Parameters and return as those of `power_curve`; False where no line tells a probability.
    """
    rows = {name: calibration(some).bins for name, some in by_method(lines).items()}
    rows = {name: bins for name, bins in rows.items() if bins}
    if not rows:
        return False
    ratios = {"height_ratios": (3.0, 1.0)}
    figure, ((above,), (below,)) = _figure(4.4, 5.0, rows=2, sharex=True, gridspec_kw=ratios)
    above.plot([0.0, 100.0], [0.0, 100.0], color="#999999", lw=1.0, ls="--")
    width = 8.0 / len(rows)
    for i, (name, bins) in enumerate(rows.items()):
        colour = COLOURS[i % len(COLOURS)]
        _with_intervals(above, [100.0 * b.mean for b in bins], [b.true for b in bins], colour, name)
        lefts = [100.0 * b.low + 1.0 + i * width for b in bins]
        below.bar(lefts, [b.true.of for b in bins], width=width, align="edge", color=colour)
    above.set(ylabel="classes that hold a true name [%]", ylim=(-3.0, 103.0), xlim=(-3.0, 103.0))
    above.legend(frameon=False, fontsize=8)
    below.set(xlabel="probability told [%]", ylabel="classes", yscale="log")
    # a single class is no empty bin
    below.set_ylim(bottom=0.5)
    figure.savefig(path, dpi=150)
    return True
