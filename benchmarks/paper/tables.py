# SPDX-License-Identifier: BSD-3-Clause
"""Medians over seeds, and how often physics pays, from the lines of results."""

import json

import numpy as np

from benchmarks.paper.models import BLACK_BOXES, HYBRIDS
from benchmarks.paper.static import LAW

#: By which the best hybrid's RMSE shall be under the best black box's.
AIM = 0.3
MODELS = ("mechanism", *HYBRIDS, *BLACK_BOXES)
PLACES = ("measured inside", "measured outside", "clean inside", "clean outside")


def whole_lines(file):
    """Lines of a file of results, but the last where a run was stopped amid it; none without a file."""
    if not file.exists():
        return []
    return [line for line in file.read_text().splitlines(keepends=True) if line.endswith("\n")]


def read(file):
    """Results of all models, one dict each."""
    return [line for text in whole_lines(file) for line in json.loads(text)["lines"]]


def by_seed(lines, scenario, task, rows, place, score="rmse"):
    """Scores by model, and by seed within, of one cell and place."""
    found = {}
    for line in lines:
        if (line["scenario"], line["task"], line["rows"]) == (scenario, task, rows) and place in line:
            found.setdefault(line["model"], {})[line["seed"]] = line[place][score]
    return found


def ratios(scores, by=None):
    """Best hybrid's score over the best black box's, one a seed; the best by other scores where given."""
    by = scores if by is None else by
    out = []
    for seed in sorted(scores[HYBRIDS[0]]):
        hybrid, box = (min(kind, key=lambda name: by[name][seed]) for kind in (HYBRIDS, BLACK_BOXES))
        out.append(scores[hybrid][seed] / scores[box][seed])
    return np.array(out)


def tables(lines):
    """All tables in Markdown; of signals without noise only the ratios."""
    cells = list(dict.fromkeys((line["scenario"], line["task"], line["rows"]) for line in lines))
    units = {(line["scenario"], line["task"]): line["unit"] for line in lines}
    seeds = {line["seed"] for line in lines}
    text = [f"{len(seeds)} seeds.\n"]
    for place in PLACES[:2]:
        found = {cell: by_seed(lines, *cell, place) for cell in cells}
        found = {cell: scores for cell, scores in found.items() if scores}
        if found:
            text += [f"\n## RMSE, {place}, medians\n", *_medians(found, units)]
    text += ["\n## Best hybrid over best black box\n", *_paying(lines, cells)]
    text += ["\n## Percentages, measured inside\n", *_percentages(lines, cells)]
    return "\n".join(text) + "\n"


def _medians(found, units):
    names = (*MODELS, LAW)
    yield f"| scenario | task | rows | {' | '.join(names)} |"
    yield "|---" * (3 + len(names)) + "|"
    for (scenario, task, rows), scores in found.items():
        middle = {name: float(np.median(list(values.values()))) for name, values in scores.items()}
        shown = " | ".join(f"{middle[name]:.3g}" if name in middle else "" for name in names)
        yield f"| {scenario} | {task} [{units[scenario, task]}] | {rows} | {shown} |"


def _paying(lines, cells):
    yield f"Median ratio of the RMSE, and seeds in which it is {1 - AIM:g} or less; last the best of either"
    yield "kind by its error on left-out blocks of the training, not by the test.\n"
    chosen = [f"{place}, chosen before" for place in PLACES[:2]]
    yield f"| scenario | task | rows | {' | '.join((*PLACES, *chosen))} |"
    yield "|---" * (3 + len(PLACES) + len(chosen)) + "|"
    for cell in cells:
        left_out = {}
        for line in lines:
            if (line["scenario"], line["task"], line["rows"]) == cell:
                # what could not be learnt is not chosen
                error = line.get("left_out")
                left_out.setdefault(line["model"], {})[line["seed"]] = np.inf if error is None else error
        shown = [_paid(by_seed(lines, *cell, place)) for place in PLACES]
        shown += [_paid(by_seed(lines, *cell, place), left_out) for place in PLACES[:2]]
        yield f"| {' | '.join(map(str, cell))} | {' | '.join(shown)} |"


def _paid(scores, by=None):
    if not scores:
        return ""
    ratio = ratios(scores, by)
    return f"{np.median(ratio):.2f}, {(ratio <= 1.0 - AIM).sum()} of {len(ratio)}"


def _percentages(lines, cells):
    yield "MAPE and largest relative error [%], medians.\n"
    names = ("mechanism", "series", "mixed", "LS-SVM", "GaussianProcess", LAW)
    yield f"| scenario | task | rows | {' | '.join(names)} |"
    yield "|---" * (3 + len(names)) + "|"
    for cell in cells:
        mean, most = (by_seed(lines, *cell, PLACES[0], score) for score in ("mape", "err_max"))
        shown = [
            " / ".join(
                f"{np.median(list(scores[name].values())):.3g}" for scores in (mean, most) if name in mean
            )
            for name in names
        ]
        yield f"| {' | '.join(map(str, cell))} | {' | '.join(shown)} |"
