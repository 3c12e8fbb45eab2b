# SPDX-License-Identifier: BSD-3-Clause
"""Proof on rows that no fit has seen: the calibrated nominal, a black box, and the corrected simulation."""

from itertools import pairwise

import numpy as np

from sklvalve.metrics import err_max, mape, rmse
from sklvalve.mismatch.black_box import black_box_prediction
from sklvalve.simulation.chain import Chain

_FOLDS = 4


def held_out_predictions(workbench, whole, nominal, model, learnt):
    """Predictions of held-out rows by simulations fitted without them.

    With rows behind those of the workbench (`whole` is longer) these are held out; else contiguous blocks in
    turn, each predicted by fits to the others. A simulation always runs through the whole recording: only the
    error of held-out rows is hidden from the fit.

    Returns
    -------
    predictions : dict
        ``nominal, corrected, black_box`` -> channel -> ndarray; held : ndarray of bool.
    """
    n, used = len(whole), len(workbench.recording)
    channels = workbench.channels
    made = {kind: {c: np.full(n, np.nan) for c in channels} for kind in ("nominal", "corrected", "black_box")}
    if n > used:
        held = np.arange(n) >= used
        for kind, fitted in (("nominal", nominal), ("corrected", model)):
            for c, signal in _run(workbench, fitted, whole).items():
                made[kind][c] = signal
        for c in channels:
            made["corrected"][c] = made["corrected"][c] + learnt(c)
            made["black_box"][c] = black_box_prediction(whole, c, ~held)
        return made, held
    edges = np.linspace(0, n, _FOLDS + 1).astype(int)
    for low, high in pairwise(edges):
        rows = np.ones(n, dtype=bool)
        rows[low:high] = False
        for kind, fitted in (("nominal", nominal), ("corrected", model)):
            again = workbench.least_squares(fitted, rows=rows, max_steps=4)
            for c in channels:
                made[kind][c][low:high] = again.predictions[c][low:high]
        for c in channels:
            made["black_box"][c][low:high] = black_box_prediction(whole, c, rows)[low:high]
    for c in channels:
        made["corrected"][c] = made["corrected"][c] + learnt(c)
    return made, np.ones(n, dtype=bool)


def holds_out(workbench, nominal, model, least=0.5):
    """Whether a hypothesis predicts blocks it was not fitted to better than the calibrated nominal.

    Contiguous quarters in turn; the sum of their whitened losses must fall to the share `least` of the
    nominal's excess over noise, in the channels that the hypothesis changes.
    """
    n = len(workbench.recording)
    edges = np.linspace(0, n, _FOLDS + 1).astype(int)
    changed = [c for c, size in workbench.change(model, nominal).items() if workbench.counts({c: size})]
    before = after = 0.0
    for low, high in pairwise(edges):
        rows = np.ones(n, dtype=bool)
        rows[low:high] = False
        fits = [workbench.fit(m.members, start=m, rows=rows, max_steps=4) for m in (nominal, model)]
        for channel in changed:
            losses = [
                np.nansum((workbench.recording[channel] - f.predictions[channel])[low:high] ** 2)
                for f in fits
            ]
            floor = (high - low) * workbench.noise[channel].floor ** 2
            before += max(losses[0] - floor, 0.0) / floor
            after += max(losses[1] - floor, 0.0) / floor
    return bool(changed) and after < least * before


def _run(workbench, model, whole):
    chain = Chain(
        whole,
        workbench.valve,
        workbench.trim,
        effects=[m.effect for m in model.members],
        onsets={m.effect.key: m.onset for m in model.members if m.onset is not None},
        choking=model.chain.choking,
    )
    return {c: getattr(chain, c)(model.values) for c in workbench.channels}


def errors(whole, made, held, channel, floor, *, random_state=0):
    """The ``fit`` entry of a channel for diagnosis.json, in the recording's own units."""
    unit = whole.unit(channel)
    offset = whole.in_recorded_units(channel, np.zeros(1))[0]
    slope = whole.in_recorded_units(channel, np.ones(1))[0] - offset
    recorded = whole.in_recorded_units(channel, whole[channel])
    seen = {k: whole.in_recorded_units(channel, v[channel]) for k, v in made.items()}
    rows = held & np.isfinite(recorded) & np.all([np.isfinite(v) for v in seen.values()], axis=0)
    entry = {"unit": unit, "held_out_rows": int(rows.sum()), "noise_floor": float(floor * abs(slope))}
    for name, metric in (("rmse", rmse), ("mape", mape), ("err_max", err_max)):
        entry[name] = {}
        for kind, values in seen.items():
            try:
                entry[name][kind] = float(metric(recorded[rows], values[rows]))
            except ValueError:
                entry[name][kind] = None
    before = (recorded[rows] - seen["nominal"][rows]) ** 2
    after = (recorded[rows] - seen["corrected"][rows]) ** 2
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
    low, high = np.quantile(drawn, [0.025, 0.975])
    return float((before.mean() - after.mean()) / room), [float(low), float(high)]
