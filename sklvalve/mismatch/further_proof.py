# SPDX-License-Identifier: BSD-3-Clause
"""What else a correction must stand: beyond the range of its fit, where nothing acts, beside its rivals."""

import numpy as np

from sklvalve.mismatch.events import simulated
from sklvalve.mismatch.low_pass_residual import learn_residual
from sklvalve.mismatch.prove import run
from sklvalve.mismatch.referee import black_box_prediction, forecast
from sklvalve.mismatch.refitting import lines_of, refitted
from sklvalve.mismatch.verdict import class_of
from sklvalve.simulation.simulation import learnt_rest

# of the range that the opening covers, at both ends left out of the fit
_END = 0.15
_FEWEST_INSIDE, _FEWEST_OUTSIDE = 120, 40


def further_proof(problem, whole, judged, made, held, flagged, spans):
    """Entries beside the errors of held-out rows, for each channel.

    Parameters
    ----------
    problem : Problem
    whole : Recording
    judged : Judgement
        In which something was found.
    made : dict
        Kind -> channel -> prediction of held-out rows.
    held : ndarray of bool
    flagged : ndarray of bool
        Rows of the problem in which what was found acts.
    spans : tuple of slice
        Stretches that are forecast where no later rows are held out.

    Returns
    -------
    entries : dict
        Channel -> dict with those of these that can be told: ``extrapolation`` (fitted on the inner 70 % of
        the opening's range, rmse outside it), ``elsewhere`` (rmse where nothing acts), and ``ruled_out`` (the
        best explanation that was ruled out, and its rmse), in the recording's own units.
    """
    rival = _best_ruled_out(judged)
    others = None
    if rival is not None:
        ahead = len(whole) > len(problem.recording)
        others = run(problem, rival.model, whole) if ahead else forecast(problem, rival.model, spans)
    inside, outside = _ranges(problem.recording)
    beyond = None if inside is None else _beyond(problem, judged, inside)
    entries = {}
    for c in problem.channels:
        unit = whole.per_si(c)
        entry = {}
        if beyond is not None:
            low, high, driver = _limits(problem.recording)
            rmse = {kind: _rmse(problem.recording[c] - v[c], outside, unit) for kind, v in beyond.items()}
            if None not in rmse.values():
                entry["extrapolation"] = {"signal": driver, "fitted_from": low, "to": high, "rmse": rmse}
        if len(whole) == len(flagged) and (held & ~flagged).sum() >= _FEWEST_OUTSIDE:
            rows = held & ~flagged
            kinds = ("nominal", "corrected")
            rmse = {kind: _rmse(whole[c] - made[kind][c], rows, unit) for kind in kinds}
            if None not in rmse.values():
                entry["elsewhere"] = {"rows": int(rows.sum()), "rmse": rmse}
        if others is not None and c in problem.channels_touched(rival.term.effect):
            error = _rmse(whole[c] - others[c], held, unit)
            if error is not None:
                entry["ruled_out"] = {"name": rival.term.effect.name, "rmse": error}
        entries[c] = entry
    return entries


def _best_ruled_out(judged):
    """The likeliest rival of the strongest finding that its class does not hold; None without one."""
    if not judged.findings:
        return None
    finding = judged.findings[0]
    inside = class_of(finding)
    ruled = [r for r in finding.rivals if r.term.effect.name not in inside]
    return min(ruled, key=lambda r: r.distance, default=None)


def _limits(recording):
    driver = "opening" if "opening" in recording else "command"
    if driver not in recording:
        return None
    low, high = np.nanquantile(recording[driver], [0.005, 0.995])
    end = _END * (high - low)
    return float(low + end), float(high - end), driver


def _ranges(recording):
    """Rows inside and outside the range to be fitted; (None, None) where there are too few of either."""
    limits = _limits(recording)
    if limits is None:
        return None, None
    low, high, driver = limits
    inside = (recording[driver] >= low) & (recording[driver] <= high)
    outside = (recording[driver] < low) | (recording[driver] > high)
    enough = inside.sum() >= _FEWEST_INSIDE and outside.sum() >= _FEWEST_OUTSIDE
    return (inside, outside) if enough and high - low > 0.05 else (None, None)


def _beyond(problem, judged, inside):
    """Predictions by nominal, corrected and black box, each fitted to the rows inside only."""
    model = simulated(judged.model)
    made = {}
    for kind, fitted in (("nominal", judged.nominal), ("corrected", model)):
        with problem.homoscedastic(fitted):
            lines = lines_of(problem, fitted)
        again = problem.simulate(fitted.terms, refitted(problem, fitted, lines, inside))
        made[kind] = dict(again.predictions)
    if judged.correction is not None:
        channel = judged.correction["channel"]
        part = learn_residual(problem, again, judged.unknown, inside)
        if part is not None:
            made["corrected"][channel] = made["corrected"][channel] + learnt_rest(
                part, again.chain, again.values
            )
    box = {c: black_box_prediction(problem.recording, c, inside) for c in problem.channels}
    return made | {"black_box": box}


def _rmse(left, rows, unit):
    left = left[rows & np.isfinite(left)]
    return float(np.sqrt(np.mean(left**2)) * abs(unit)) if len(left) else None
