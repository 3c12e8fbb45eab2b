# SPDX-License-Identifier: BSD-3-Clause
"""The paper's equations 14 and 15: opening as the state, its speed learnt inside the difference equation.

One step ahead, x(k+1) from the measured x(k); and free, for a minute from one measured opening on, each step
from what the model itself gave before, with the flow y(k) = g(x(k)) of such an opening.
"""

import time

import numpy as np

from benchmarks.paper.models import models, quiet, tuned
from benchmarks.paper.runs import HOUR, simulated, stepped
from benchmarks.paper.static import TASKS, errors
from benchmarks.paper.stem import SlewingStem

#: Openings that the commands ask for in training, and beyond.
INSIDE, BEYOND = (0.25, 0.5), (0.12, 0.8)
TRAINING, TEST = 2400, 1200
#: Steps of a free run [s].
FREE = 60
#: Ways to look at a model, and their units.
LOOKS = {"X one step ahead": "%", "X in free run": "%", "F in free run": "t/h"}
_FLOW = TASKS["F from P1, P2, X"]


def lines_of(many, seed, seconds=(TRAINING, TEST)):
    """Results of all models as `static.lines_of` gives them, for the three ways to look at them."""
    rng = np.random.default_rng([seed, 1000])
    training = _run(seconds[0], INSIDE, rng)
    tests = {
        "inside": _run(seconds[1], INSIDE, rng),
        "outside": _run(seconds[1], BEYOND, rng),
    }
    X, y = transitions(training.measured["opening"], training.measured["command"])
    at = np.linspace(0, len(X) - 1, many).round().astype(int)
    flow_model = _flow_model(training, many, seed)
    lines = []
    where = {"scenario": "dynamic", "rows": many, "seed": seed}
    chosen = models(SlewingStem(), [0, 2], seed, log_target=False)
    for name, (estimator, space) in chosen.items():
        began = time.process_time()
        predict, left_out = _learnt(estimator, space, X[at], y[at], seed)
        line = where | {"model": name, "left_out": None if np.isnan(left_out) else 100.0 * left_out}
        line["seconds"] = round(time.process_time() - began, 2)
        looks = {look: {} for look in LOOKS}
        for place, test in tests.items():
            for look, found in _looked_at(predict, test, flow_model).items():
                looks[look][f"measured {place}"] = found
        lines += [line | {"task": look, "unit": LOOKS[look]} | found for look, found in looks.items()]
    return lines


def transitions(opening, command):
    """X and y of one step: opening now, command now, its direction, command before; opening then."""
    return columns(opening[1:-1], command[1:-1], command[:-2]), opening[2:]


def columns(opening, command, before):
    """Columns of X from the state and the inputs."""
    return np.column_stack([opening, command, np.sign(command - opening), before])


def free_run(predict, opening, command):
    """Openings [1] of every minute from its first measured one on; NaN where nothing is predicted.

    Parameters
    ----------
    predict : callable
        Of X; opening one step later.
    opening, command : ndarray of shape (n,)

    Returns
    -------
    free : ndarray of shape (n,)
    """
    starts = np.arange(1, len(opening) - FREE, FREE)
    free = np.full(len(opening), np.nan)
    state = opening[starts]
    for step in range(FREE):
        at = starts + step
        state = predict(columns(state, command[at], command[at - 1]))
        # a stem stays between its stops, whatever a model says
        state = np.clip(np.nan_to_num(state, nan=0.5), 0.0, 1.0)
        free[at + 1] = state
    return free


def _run(seconds, openings, rng):
    return simulated(stepped(60 + seconds, openings, rng), seconds, (), rng)


def _flow_model(training, many, seed):
    """The output g of equation 14: the series hybrid of the flow, on as many rows of the same run."""
    kept = np.flatnonzero(training.metered)
    at = kept[np.linspace(0, len(kept) - 1, many).round().astype(int)]
    X, y = _FLOW.table({name: values[at] for name, values in training.measured.items()})
    estimator, space = models(_FLOW.mechanism, [2], seed)["series"]
    return tuned(estimator, space, X, y, seed)[0]


def _learnt(estimator, space, X, y, seed):
    """What a tuned model predicts: nothing where in none of its few rows the stem is on its way."""
    try:
        model, left_out = tuned(estimator, space, X, y, seed)
    except ValueError:
        if np.isfinite(SlewingStem().invert(X, y)).any():
            raise
        return (lambda X: np.full(len(X), np.nan)), np.nan
    return model.predict, left_out


def _looked_at(predict, test, flow_model):
    signals = test.measured
    opening = signals["opening"]
    X, y = transitions(opening, signals["command"])
    with quiet():
        ahead = predict(X)
        if not np.isfinite(ahead).any():
            return dict.fromkeys(LOOKS, errors(y, ahead, 100.0))
        free = free_run(predict, opening, signals["command"])
    ran = np.isfinite(free)
    seen = ran & test.metered
    inputs, flow = _FLOW.table(signals | {"opening": np.where(ran, free, 0.5)})
    found = (
        errors(y, ahead, 100.0),
        errors(opening[ran], free[ran], 100.0),
        errors(flow[seen], flow_model.predict(inputs[seen]), HOUR),
    )
    return dict(zip(LOOKS, found, strict=True))
