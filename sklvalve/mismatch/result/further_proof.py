# SPDX-License-Identifier: BSD-3-Clause
"""What else a correction must stand: beyond the range of its fit, where nothing acts, beside its rivals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sklvalve.mismatch.inference.refitting import lines_of, refitted
from sklvalve.mismatch.proof.black_box import black_box_prediction
from sklvalve.mismatch.proof.forward import forecast
from sklvalve.mismatch.proof.held_out import run
from sklvalve.mismatch.residual.low_pass_residual import learn_residual
from sklvalve.mismatch.search.events import simulated
from sklvalve.mismatch.search.rivals import class_of
from sklvalve.simulation.simulation import learnt_rest

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.rivals import Rival
    from sklvalve.recording import Recording

    Predictions = dict[str, np.ndarray]
    Entries = dict[str, dict[str, Any]]

# of the range that the opening covers, at both ends left out of the fit
_END = 0.15
_FEWEST_INSIDE, _FEWEST_OUTSIDE = 120, 40


def further_proof(
    problem: Problem,
    whole: Recording,
    judged: Judgement,
    made: dict[str, Predictions],
    held: np.ndarray,
    flagged: np.ndarray,
    spans: Sequence[slice],
) -> dict[str, dict[str, Any]]:
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
    entries: dict[str, dict[str, Any]] = {c: {} for c in problem.channels}
    ruled_out = _ruled_out(problem, whole, judged, held, spans)
    extrapolation = _extrapolation(problem, whole, judged)
    for part in (extrapolation, _elsewhere(problem, whole, made, held, flagged), ruled_out):
        for c, entry in part.items():
            entries[c] |= entry
    return entries


def _extrapolation(problem: Problem, whole: Recording, judged: Judgement) -> Entries:
    """Errors outside the range of a fit, by channel."""
    recording = problem.recording
    inside, outside = _ranges(recording)
    limits = _limits(recording)
    if inside is None or outside is None or limits is None:
        return {}
    beyond, (low, high, driver) = _beyond(problem, judged, inside), limits
    entries = {}
    for c in problem.channels:
        unit = whole.per_si(c)
        rmse = {kind: _rmse(recording[c] - v[c], outside, unit) for kind, v in beyond.items()}
        if None not in rmse.values():
            made = {"signal": driver, "fitted_from": low, "to": high, "rmse": rmse}
            entries[c] = {"extrapolation": made}
    return entries


def _elsewhere(
    problem: Problem,
    whole: Recording,
    made: dict[str, Predictions],
    held: np.ndarray,
    flagged: np.ndarray,
) -> Entries:
    """Errors where nothing of what was found acts, by channel."""
    if len(whole) != len(flagged) or (held & ~flagged).sum() < _FEWEST_OUTSIDE:
        return {}
    rows, entries = held & ~flagged, {}
    for c in problem.channels:
        unit, kinds = whole.per_si(c), ("nominal", "corrected")
        rmse = {kind: _rmse(whole[c] - made[kind][c], rows, unit) for kind in kinds}
        if None not in rmse.values():
            entries[c] = {"elsewhere": {"rows": int(rows.sum()), "rmse": rmse}}
    return entries


def _ruled_out(
    problem: Problem, whole: Recording, judged: Judgement, held: np.ndarray, spans: Sequence[slice]
) -> Entries:
    """Errors of the best explanation that was ruled out, for the channels that it changes."""
    rival = _best_ruled_out(judged)
    if rival is None:
        return {}
    ahead = len(whole) > len(problem.recording)
    predicted = run(problem, rival.model, whole) if ahead else forecast(problem, rival.model, spans)
    if predicted is None:
        return {}
    effect, entries = rival.term.effect, {}
    for c in problem.channels:
        if c in problem.channels_touched(effect):
            error = _rmse(whole[c] - predicted[c], held, whole.per_si(c))
            if error is not None:
                entries[c] = {"ruled_out": {"name": effect.name, "rmse": error}}
    return entries


def _best_ruled_out(judged: Judgement) -> Rival | None:
    """The likeliest rival of the strongest finding that its class does not hold; None without one."""
    if not judged.findings:
        return None
    finding = judged.findings[0]
    inside = class_of(finding)
    ruled = [r for r in finding.rivals if r.term.effect.name not in inside]
    return min(ruled, key=lambda r: r.distance, default=None)


def _limits(recording: Recording) -> tuple[float, float, str] | None:
    driver = "opening" if "opening" in recording else "command"
    if driver not in recording:
        return None
    low, high = np.nanquantile(recording[driver], [0.005, 0.995])
    end = _END * (high - low)
    return float(low + end), float(high - end), driver


def _ranges(recording: Recording) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Rows inside and outside the range to be fitted; (None, None) where there are too few of either."""
    limits = _limits(recording)
    if limits is None:
        return None, None
    low, high, driver = limits
    inside = (recording[driver] >= low) & (recording[driver] <= high)
    outside = (recording[driver] < low) | (recording[driver] > high)
    enough = inside.sum() >= _FEWEST_INSIDE and outside.sum() >= _FEWEST_OUTSIDE
    return (inside, outside) if enough and high - low > 0.05 else (None, None)


def _beyond(problem: Problem, judged: Judgement, inside: np.ndarray) -> dict[str, Predictions]:
    """Predictions by nominal, corrected and black box, each fitted to the rows inside only."""
    nominal, model = cast("Model", judged.nominal), simulated(cast("Model", judged.model))
    made: dict[str, Predictions] = {}
    for kind, fitted in (("nominal", nominal), ("corrected", model)):
        lines = lines_of(problem.homoscedastic(fitted), fitted)
        again = problem.simulate(fitted.terms, refitted(problem, fitted, lines, inside))
        made[kind] = dict(again.predictions)
    if judged.correction is not None and judged.unknown is not None:
        channel = judged.correction["channel"]
        part = learn_residual(problem, again, judged.unknown, inside)
        if part is not None:
            made["corrected"][channel] = made["corrected"][channel] + learnt_rest(
                part, again.chain, again.values
            )
    box = {c: black_box_prediction(problem.recording, c, inside) for c in problem.channels}
    return made | {"black_box": box}


def _rmse(left: np.ndarray, rows: np.ndarray, unit: float) -> float | None:
    left = left[rows & np.isfinite(left)]
    return float(np.sqrt(np.mean(left**2)) * abs(unit)) if len(left) else None
