# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the paper's experiment (needs sklvalve[plot])."""

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt

from benchmarks.paper.models import BLACK_BOXES, HYBRIDS, quiet
from benchmarks.paper.static import LAW, ROWS, TASKS, Drawn, fitted
from benchmarks.paper.tables import by_seed

COLOURS = {"measured": "#222222", "series": "#d94801", "GaussianProcess": "#2171b5"}
TRAINED_ON, SHOWN, SEED = 50, 240, 0
TICKS = {"t/h": (0.1, 0.2, 0.5, 1, 2, 5), "kPa": (10, 20, 50, 100, 200, 500)}


def draw(lines, folder):
    """Write `paper_experiment_flow.png` and `paper_experiment_rows.png` into a folder."""
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        flow().savefig(folder / "paper_experiment_flow.png", dpi=150)
        over_rows(lines).savefig(folder / "paper_experiment_rows.png", dpi=150)
    plt.close("all")


def flow():
    """As the paper's figures 4 and 5: flow of the test over time and its error, without and with T."""
    figure, axes = plt.subplots(
        2, 2, figsize=(9.6, 4.6), sharex=True, sharey="row", height_ratios=(2, 1), layout="constrained"
    )
    drawn = Drawn.of("normal", SEED)
    for column, name in enumerate(("F from P1, P2, X", "F from P1, P2, X, T")):
        top, bottom = axes[:, column]
        shown = {signal: values[:SHOWN] for signal, values in drawn.measured.items()}
        X, y = TASKS[name].table(shown)
        y, t, inside = TASKS[name].per_unit * y, np.arange(SHOWN), drawn.inside[:SHOWN]
        for axis in (top, bottom):
            axis.fill_between(t, 0, 1, where=inside, transform=axis.get_xaxis_transform(), color="#eeeeee")
        top.plot(t, y, ".", ms=3, color=COLOURS["measured"], label="measured")
        for model, line in fitted(drawn, TASKS[name], TRAINED_ON, SEED, ("GaussianProcess", "series")):
            kind = line["model"]
            with quiet():
                predicted = TASKS[name].per_unit * model.predict(X)
            top.plot(t, predicted, lw=1, color=COLOURS[kind], label=kind)
            bottom.plot(t, 100.0 * (predicted - y) / y, lw=1, color=COLOURS[kind])
        top.set_title(f"{name}; {TRAINED_ON} rows to train on", fontsize=9)
        bottom.set(xlabel="row of the test (1 s)", ylim=(-30, 30))
        bottom.axhline(0.0, color="#999999", lw=0.6)
    axes[0, 0].set_ylabel("flow [t/h]")
    axes[1, 0].set_ylabel("error [%]")
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(),
        loc="outside upper center",
        ncols=3,
        frameon=False,
        title="grey: inside the trained box",
    )
    return figure


def over_rows(lines):
    """RMSE over the rows that were trained on, normal runs, medians of the seeds."""
    figure, axes = plt.subplots(2, len(TASKS), figsize=(11, 5), sharex=True, layout="constrained")
    for column, (name, task) in enumerate(TASKS.items()):
        for axis, place in zip(axes[:, column], ("inside", "outside"), strict=True):
            _rows_of(axis, lines, name, place)
            axis.set(xscale="log", yscale="log", ylim=(TICKS[task.unit][0], TICKS[task.unit][-1]))
            axis.set_xticks(ROWS, [str(rows) for rows in ROWS])
            axis.set_yticks(TICKS[task.unit], [f"{tick:g}" for tick in TICKS[task.unit]])
            axis.minorticks_off()
            axis.set_title(f"{name}: {place}", fontsize=8)
            axis.set_ylabel(f"RMSE [{task.unit}]")
    for axis in axes[1]:
        axis.set_xlabel("rows to train on")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4, frameon=False)
    return figure


def _rows_of(axis, lines, task, place):
    kinds = {
        "best black box": (BLACK_BOXES, {"color": COLOURS["GaussianProcess"], "marker": "s"}),
        "best hybrid": (HYBRIDS, {"color": COLOURS["series"], "marker": "o"}),
        "mechanism alone": (("mechanism",), {"color": "#999999", "marker": "^"}),
        LAW: ((LAW,), {"color": COLOURS["measured"], "ls": ":"}),
    }
    for label, (names, style) in kinds.items():
        middle = []
        for rows in ROWS:
            scores = by_seed(lines, "normal", task, rows, f"measured {place}")
            best = [min(scores[n][s] for n in names) for s in scores[names[0]]] if scores else [np.nan]
            middle.append(np.median(best))
        axis.plot(ROWS, middle, ms=4, lw=1.2, label=label, **style)
