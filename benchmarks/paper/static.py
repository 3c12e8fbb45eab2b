# SPDX-License-Identifier: BSD-3-Clause
"""Flow from [P1, P2, X] and outlet pressure from [P1, F, X], with the temperature and without."""

import time
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from benchmarks.paper.law import GeneratorsLaw
from benchmarks.paper.models import models, quiet, tuned
from benchmarks.paper.runs import HOUR, SCENARIOS, TRAINED, WHOLE, static_run
from benchmarks.paper.valve import SheetValve
from sklvalve.metrics import err_max, mape, rmse

ROWS = (50, 200, 1500)
LAW = "generator's law"
#: Seconds of a run to train on and of one to test on.
TRAINING, TEST = 4000, 3000


@dataclass(frozen=True)
class Task:
    """What is predicted from what.

    Attributes
    ----------
    inputs : tuple of str
        Columns.
    target : str
    unit : str
    per_unit : float
        Units in one SI unit of the signal.
    """

    inputs: tuple
    target: str
    unit: str
    per_unit: float

    @property
    def mechanism(self):
        """What the sheet says of it."""
        return SheetValve(self.inputs, "flow" if self.target == "flow" else "outlet_pressure")

    def table(self, signals):
        """X and y."""
        return np.column_stack([signals[name] for name in self.inputs]), signals[self.target]


_FLOW, _PRESSURE = ("flow", "t/h", HOUR), ("p2", "kPa", 1e-3)
TASKS = {
    "F from P1, P2, X": Task(("p1", "p2", "opening"), *_FLOW),
    "F from P1, P2, X, T": Task(("p1", "p2", "opening", "temperature"), *_FLOW),
    "P2 from P1, F, X": Task(("p1", "flow", "opening"), *_PRESSURE),
    "P2 from P1, F, X, T": Task(("p1", "flow", "opening", "temperature"), *_PRESSURE),
}


@dataclass(frozen=True, eq=False)
class Drawn:
    """Runs of one scenario and one seed, without rows in which the flow sensor tells little.

    Attributes
    ----------
    training : dict of ndarray of shape (n,)
        Measured signals.
    measured, clean : dict of ndarray of shape (m,)
        Signals of the test.
    inside : ndarray of bool of shape (m,)
        Rows within the box that was trained on.
    """

    training: dict
    measured: dict
    clean: dict
    inside: np.ndarray

    @classmethod
    @lru_cache(maxsize=1)
    def of(cls, name, seed, seconds=(TRAINING, TEST)):
        """Simulate the scenario, once for all tasks and rows."""
        scenario, rng = SCENARIOS[name], np.random.default_rng([seed, list(SCENARIOS).index(name)])
        first = static_run(scenario, scenario.trained, seconds[0], rng)
        second = static_run(scenario, WHOLE, seconds[1], rng)
        everywhere = scenario.trained in (None, WHOLE)
        inside = np.ones(len(second), dtype=bool) if everywhere else TRAINED.holds(second.clean)
        kept = second.metered
        return cls(
            {name: values[first.metered] for name, values in first.measured.items()},
            {name: values[kept] for name, values in second.measured.items()},
            {name: values[kept] for name, values in second.clean.items()},
            inside[kept],
        )

    def rows(self, many):
        """So many rows of the training, spread evenly over its time."""
        available = len(self.training["flow"])
        if many > available:
            raise ValueError(f"A run of {available} rows holds no {many} to train on; simulate a longer one.")
        at = np.linspace(0, available - 1, many).round().astype(int)
        return {name: values[at] for name, values in self.training.items()}


def lines_of(scenario, task_name, many, seed, seconds=(TRAINING, TEST)):
    """Results of all models and of the generator's law: one dict each, with `errors` by signals and place."""
    drawn, task = Drawn.of(scenario, seed, seconds), TASKS[task_name]
    where = {"scenario": scenario, "task": task_name, "rows": many, "seed": seed, "unit": task.unit}
    results = [*fitted(drawn, task, many, seed), (GeneratorsLaw(drawn.clean, task), {"model": LAW})]
    return [where | line | _by_place(model.predict, drawn, task) for model, line in results]


def fitted(drawn, task, many, seed, names=None):
    """Tuned models, and for each a dict of its name, error on left-out blocks, and seconds of its search."""
    X, y = task.table(drawn.rows(many))
    seen = [task.inputs.index("opening")]
    chosen = models(task.mechanism, seen, seed, log_target=task.target == "flow")
    for name in names or chosen:
        began = time.process_time()
        model, left_out = tuned(*chosen[name], X, y, seed)
        taken = round(time.process_time() - began, 2)
        yield model, {"model": name, "left_out": _number(task.per_unit * left_out), "seconds": taken}


def _by_place(predict, drawn, task):
    out = {}
    for kind in ("measured", "clean"):
        X, y = task.table(getattr(drawn, kind))
        with quiet():
            predicted = predict(X)
        for place, rows in (("inside", drawn.inside), ("outside", ~drawn.inside)):
            if rows.any():
                out[f"{kind} {place}"] = errors(y[rows], predicted[rows], task.per_unit)
    return out


def errors(y, predicted, per_unit):
    """RMSE in the task's unit, MAPE and largest relative error [%], and rows without a finite number.

    What predicts no row at all, as a mechanism whose parameter none of few rows tells, is infinitely wrong.
    """
    known = np.isfinite(predicted)
    y, predicted = per_unit * y[known], per_unit * predicted[known]
    return {
        "rmse": rmse(y, predicted) if known.any() else np.inf,
        "mape": mape(y, predicted) if known.any() else np.inf,
        "err_max": err_max(y, predicted) if known.any() else np.inf,
        "rows": len(y),
        "lost": int((~known).sum()),
    }


def _number(value):
    return float(value) if np.isfinite(value) else None
