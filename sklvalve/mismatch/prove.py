# SPDX-License-Identifier: BSD-3-Clause
"""Proof on rows that no fit has seen: the calibrated nominal, a black box, and the corrected simulation."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sklvalve.metrics import err_max, mape, rmse
from sklvalve.mismatch.black_box import black_box_prediction
from sklvalve.mismatch.linearised import Linearised
from sklvalve.mismatch.model_free import model_free_noise
from sklvalve.mismatch.slow_rest import learn_rest
from sklvalve.simulation.fitting import left_of, simulate_channels
from sklvalve.simulation.robust import robust_cost
from sklvalve.simulation.simulation import learnt_rest

_FOLDS = 4
# so often a fold of the veto comes back in the recording
_TURNS = 4
# a learnt correction must improve this many of the folds, and all of them together
_IMPROVED = 3
# of a step to first order so much is tried, as long as it makes the rows worse that it should make better
_SHARES = (1.0, 0.3, 0.1, 0.03)


@dataclass(frozen=True, eq=False)
class Folded:
    """Blocks of a recording in turn, each predicted by fits to the others.

    Attributes
    ----------
    predictions : dict
        Channel -> ndarray of shape (n,), the simulation alone.
    rest : ndarray of shape (n,)
        What the correction adds to its channel, learnt from the other blocks too; zero without one.
    """

    predictions: dict
    rest: np.ndarray


def blocks(n):
    """Contiguous quarters of n rows: slice of each, and the other rows as ndarray of bool."""
    for low, high in pairwise(np.linspace(0, n, _FOLDS + 1).astype(int)):
        others = np.ones(n, dtype=bool)
        others[low:high] = False
        yield slice(low, high), others


def folded(workbench, model, unknown=None):
    """A hypothesis fitted again without each block, and so is the learnt rest if one is given.

    A simulation always runs through the whole recording: only the error of held-out rows is hidden from the
    fit. The fits to the others start from the fit to all and go one step: they differ by little.

    Returns
    -------
    folded : Folded
    """
    n = len(workbench.recording)
    made, rest = {c: np.full(n, np.nan) for c in workbench.channels}, np.zeros(n)
    with workbench.every_row_alike(model):
        lines = lines_of(workbench, model)
    for held, others in blocks(n):
        again = workbench.simulate(model.members, refitted(workbench, model, lines, others))
        for c in workbench.channels:
            made[c][held] = again.predictions[c][held]
        part = None if unknown is None else learn_rest(workbench, again, unknown, others)
        if part is not None:
            rest[held] = learnt_rest(part, again.chain, again.values)[held]
    return Folded(made, rest)


def lines_of(workbench, model):
    """A hypothesis linearised, channels that share no parameter each by itself."""
    lines = {}
    for channel in workbench.channels:
        line = Linearised(workbench, model, (channel,))
        lines[line.channels] = line
    return list(lines.values())


def refitted(workbench, model, lines, rows):
    """Values fitted to some rows only: one step, shortened where the simulation bends before its end."""
    values = dict(model.values)
    for line in lines:
        least, there = _error(workbench, model.predictions, line, rows), line.refitted(rows)
        here = {name: model.values[name] for name in there}
        for share in _SHARES:
            step = line.between(here, there, share)
            made = simulate_channels(model.chain, model.values | step, line.channels)
            if _error(workbench, made, line, rows) <= least:
                break
        values |= step
    return values


def _error(workbench, made, line, rows):
    """Squared errors of the channels of a line on some rows, each in its own size."""
    return sum(
        np.nansum(left_of(workbench.recording, made, c)[rows] ** 2) / workbench.spans[c] ** 2
        for c in line.channels
    )


def correction_holds_out(workbench, tried, channel):
    """Whether a learnt correction lowers the error of rows that it was not learnt from.

    Parameters
    ----------
    workbench : Workbench
    tried : Folded
    channel : str
        That of the correction.

    Returns
    -------
    holds : bool
    errors : tuple of float
        Rms on held-out rows without it and with it [SI].
    """
    recorded, plain = workbench.recording[channel], tried.predictions[channel]
    before, after = (recorded - plain) ** 2, (recorded - plain - tried.rest) ** 2
    better = [np.nansum(after[held]) < np.nansum(before[held]) for held, _ in blocks(len(recorded))]
    errors = float(np.sqrt(np.nanmean(before))), float(np.sqrt(np.nanmean(after)))
    return bool(sum(better) >= _IMPROVED and errors[1] < errors[0]), errors


def held_out_predictions(workbench, whole, nominal, model, correction=None, tried=None, *, black_box=True):
    """Predictions of held-out rows by simulations fitted without them.

    With rows behind those of the workbench (`whole` is longer) these are held out; else contiguous blocks in
    turn.

    Parameters
    ----------
    workbench : Workbench
    whole : Recording
    nominal, model : Model
    correction : dict, default=None
        What is learnt beside `model`, from the rows of the workbench.
    tried : Folded, default=None
        `model` block by block, if that was done already.
    black_box : bool, default=True
        Whether the black box is asked as well.

    Returns
    -------
    predictions : dict
        ``nominal, corrected, black_box`` -> channel -> ndarray; held : ndarray of bool.
    """
    n, used = len(whole), len(workbench.recording)
    if n > used:
        held = np.arange(n) >= used
        made = {"nominal": _run(workbench, nominal, whole), "corrected": _run(workbench, model, whole)}
        if correction is not None:
            chain = workbench.chain(model.members, whole)
            made["corrected"][correction["channel"]] += learnt_rest(correction, chain, model.values)
        if black_box:
            made["black_box"] = {c: black_box_prediction(whole, c, ~held) for c in workbench.channels}
        return made, held
    if tried is None:
        tried = folded(workbench, model)
    corrected = {c: signal.copy() for c, signal in tried.predictions.items()}
    if correction is not None:
        corrected[correction["channel"]] += tried.rest
    plain = corrected if model is nominal and correction is None else folded(workbench, nominal).predictions
    made = {"nominal": plain, "corrected": corrected}
    if not black_box:
        return made, np.ones(n, dtype=bool)
    made["black_box"] = {c: np.full(n, np.nan) for c in workbench.channels}
    for rows, others in blocks(n):
        for c in workbench.channels:
            made["black_box"][c][rows] = black_box_prediction(whole, c, others)[rows]
    return made, np.ones(n, dtype=bool)


def holds_out(workbench, nominal, model, least=0.5):
    """Whether a hypothesis predicts blocks it was not fitted to better than the calibrated nominal.

    Every fourth of sixteen contiguous blocks in turn, so that what acts for a while only, or from an onset
    on, is both fitted and held out; the sum of their losses must fall to the share `least` of the nominal's
    excess over what a healthy simulation leaves over, in the channels that the hypothesis changes.
    """
    changed = [c for c, size in workbench.change(model, nominal).items() if workbench.counts({c: size})]
    before = after = 0.0
    models = nominal, model
    both = [lines_of(workbench, m) for m in models]
    place = np.arange(len(workbench.recording)) * _FOLDS * _TURNS // len(workbench.recording)
    for fold in range(_FOLDS):
        held = place % _FOLDS == fold
        fits = [
            workbench.simulate(m.members, refitted(workbench, m, lines, ~held))
            for m, lines in zip(models, both, strict=True)
        ]
        for channel in changed:
            size = workbench.noise[channel].total
            left = [
                np.nan_to_num(left_of(workbench.recording, f.predictions, channel)[held] / size) for f in fits
            ]
            # robust as the fits are: one wild minute must not outweigh an hour
            losses = [robust_cost(each) / (0.5 * len(each)) for each in left]
            before += max(losses[0] - 1.0, 0.0)
            after += max(losses[1] - 1.0, 0.0)
    return bool(changed) and after < least * before


def _run(workbench, model, whole):
    return simulate_channels(workbench.chain(model.members, whole), model.values, workbench.channels)


def errors(whole, made, held, channel, floor, *, random_state=0):
    """The ``fit`` entry of a channel for diagnosis.json, in the recording's own units.

    The noise floor is no larger than the least error achieved: a floor that was passed was none.
    """
    unit = whole.unit(channel)
    recorded = whole.in_recorded_units(channel, whole[channel])
    seen = {k: whole.in_recorded_units(channel, v[channel]) for k, v in made.items()}
    rows = held & np.isfinite(recorded) & np.all([np.isfinite(v) for v in seen.values()], axis=0)
    entry = {
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


def _skill(before, after, floor, random_state):
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
