# SPDX-License-Identifier: BSD-3-Clause
"""Proof on rows that no fit has seen: the calibrated nominal, a black box, and the corrected simulation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.metrics import err_max, mape, rmse
from sklvalve.mismatch.inference.refitting import lines_of, refitted
from sklvalve.mismatch.proof.black_box import black_box_ahead
from sklvalve.mismatch.residual.low_pass_residual import learn_residual
from sklvalve.mismatch.signals.model_free import model_free_noise
from sklvalve.simulation.fitting import simulate_channels
from sklvalve.simulation.simulation import learnt_rest

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.proof.forward import Forward
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.recording import Recording

_FOLDS = 4
# a learnt correction must improve this many of the folds, and all of them together
_IMPROVED = 3


@dataclass(frozen=True, eq=False)
class CrossValidated:
    """Blocks of a recording in turn, each predicted by fits to the others.

    Attributes
    ----------
    predictions : dict
        Channel -> ndarray of shape (n,), the simulation alone.
    learnt_residual : ndarray of shape (n,)
        What the correction adds to its channel, learnt from the other blocks too; zero without one.
    """

    predictions: dict
    learnt_residual: np.ndarray


def blocks(n: int) -> Iterator[tuple[slice, np.ndarray]]:
    """Contiguous quarters of n rows: slice of each, and the other rows as ndarray of bool."""
    for low, high in pairwise(np.linspace(0, n, _FOLDS + 1).astype(int)):
        others = np.ones(n, dtype=bool)
        others[low:high] = False
        yield slice(low, high), others


def cross_validated(problem: Problem, model: Model, unknown: Unknown | None = None) -> CrossValidated:
    """A hypothesis fitted again without each block, and so is the learnt rest if one is given.

    A simulation always runs through the whole recording: only the error of held-out rows is hidden from the
    fit. The fits to the others start from the fit to all and go one step: they differ by little.

    Returns
    -------
    cross_validated : CrossValidated
    """
    n = len(problem.recording)
    made, learnt = {c: np.full(n, np.nan) for c in problem.channels}, np.zeros(n)
    lines = lines_of(problem.homoscedastic(model), model)
    for held, others in blocks(n):
        again = problem.simulate(model.terms, refitted(problem, model, lines, others))
        for c in problem.channels:
            made[c][held] = again.predictions[c][held]
        part = None if unknown is None else learn_residual(problem, again, unknown, others)
        if part is not None:
            learnt[held] = learnt_rest(part, again.chain, again.values)[held]
    return CrossValidated(made, learnt)


def correction_holds_out(
    problem: Problem, tried: CrossValidated, channel: str
) -> tuple[bool, tuple[float, float]]:
    """Whether a learnt correction lowers the error of rows that it was not learnt from.

    Parameters
    ----------
    problem : Problem
    tried : CrossValidated
    channel : str
        That of the correction.

    Returns
    -------
    holds : bool
    errors : tuple of float
        Rms on held-out rows without it and with it [SI].
    """
    recorded, plain = problem.recording[channel], tried.predictions[channel]
    before, after = (recorded - plain) ** 2, (recorded - plain - tried.learnt_residual) ** 2
    better = [np.nansum(after[held]) < np.nansum(before[held]) for held, _ in blocks(len(recorded))]
    errors = float(np.sqrt(np.nanmean(before))), float(np.sqrt(np.nanmean(after)))
    return bool(sum(better) >= _IMPROVED and errors[1] < errors[0]), errors


def held_out_predictions(
    problem: Problem,
    whole: Recording,
    nominal: Model,
    model: Model,
    forward: Forward,
    correction: dict | None = None,
) -> tuple[dict[str, dict[str, np.ndarray]], np.ndarray]:
    """Predictions of rows that the fits behind them have not seen.

    With rows behind those of the problem (`whole` is longer) these; else rows ahead of each origin of the
    forecasts.

    Parameters
    ----------
    problem : Problem
    whole : Recording
    nominal, model : Model
    forward : Forward
    correction : dict, default=None
        What is learnt beside `model`, from the rows of the problem.

    Returns
    -------
    predictions : dict
        ``nominal, corrected, black_box`` -> channel -> ndarray; held : ndarray of bool.
    """
    n, used = len(whole), len(problem.recording)
    if n == used:
        return forward.predictions, forward.held
    held = np.arange(n) >= used
    made = {"nominal": run(problem, nominal, whole), "corrected": run(problem, model, whole)}
    if correction is not None:
        chain = problem.chain(model.terms, whole)
        made["corrected"][correction["channel"]] += learnt_rest(correction, chain, model.values)
    made["black_box"] = {
        c: black_box_ahead(whole, c, [slice(used, n)], closed=forward.closed[c]) for c in problem.channels
    }
    return made, held


def run(problem: Problem, model: Model, whole: Recording) -> dict[str, np.ndarray]:
    """A fitted hypothesis simulated over a whole recording: channel -> ndarray [SI]."""
    return simulate_channels(problem.chain(model.terms, whole), model.values, problem.channels)


def errors(
    whole: Recording,
    made: dict[str, dict[str, np.ndarray]],
    held: np.ndarray,
    channel: str,
    floor: float,
    *,
    random_state: int = 0,
) -> dict[str, Any]:
    """The ``fit`` entry of a channel for diagnosis.json, in the recording's own units.

    The noise floor is no larger than the least error achieved: a floor that was passed was none.
    """
    unit = whole.unit(channel)
    recorded = whole.in_recorded_units(channel, whole[channel])
    seen = {k: whole.in_recorded_units(channel, v[channel]) for k, v in made.items()}
    rows = held & np.isfinite(recorded) & np.all([np.isfinite(v) for v in seen.values()], axis=0)
    entry: dict[str, Any] = {
        "unit": unit,
        "held_out_rows": int(rows.sum()),
        "noise_floor": float(floor * abs(whole.per_si(channel))),
    }
    for name, metric in (("rmse", rmse), ("mape", mape), ("err_max", err_max)):
        entry[name] = {}
        for kind, values in seen.items():
            try:
                entry[name][kind] = float(metric(recorded[rows], values[rows]))
            except ValueError:
                entry[name][kind] = None
    achieved = [error for error in entry["rmse"].values() if error is not None]
    entry["noise_floor"] = min([entry["noise_floor"], *achieved])
    before = (recorded[rows] - seen["nominal"][rows]) ** 2
    after = (recorded[rows] - seen["corrected"][rows]) ** 2
    entry["model_free"] = model_free_noise(whole, channel, floor, entry["rmse"].get("corrected"))
    entry["skill"], entry["skill_ci95"] = _skill(before, after, entry["noise_floor"] ** 2, random_state)
    return entry


def _skill(before: np.ndarray, after: np.ndarray, floor: float, random_state: int) -> Any:
    """Skill against the noise floor, with an interval from a circular block bootstrap of paired losses."""
    room = before.mean() - floor
    # where the nominal stands at the floor already there is nothing to be explained, and no skill
    if len(before) < 40 or room < 0.1 * floor or room <= 0.0:
        return None, None
    rng = np.random.default_rng(random_state)
    length = max(round(2.0 * len(before) ** (1.0 / 3.0)), 10)
    many = int(np.ceil(len(before) / length))
    drawn = []
    for _ in range(200):
        starts = rng.integers(0, len(before), many)
        rows = ((starts[:, None] + np.arange(length)) % len(before)).ravel()[: len(before)]
        drawn.append((before[rows].mean() - after[rows].mean()) / max(before[rows].mean() - floor, 1e-30))
    # rows drawn by chance may lie below the floor, a skill above one means nothing
    low, high = np.minimum(np.quantile(drawn, [0.025, 0.975]), 1.0)
    return float((before.mean() - after.mean()) / room), [float(low), float(high)]
