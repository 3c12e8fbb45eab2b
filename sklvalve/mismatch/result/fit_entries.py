# SPDX-License-Identifier: BSD-3-Clause
"""How well each simulation fits, from rows that no fit has seen: the ``fit`` entries of diagnosis.json."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.proof.forward import forward_in_time
from sklvalve.mismatch.proof.held_out import cross_validated, errors, held_out_predictions
from sklvalve.mismatch.result.further_proof import further_proof

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.proof.forward import Forward
    from sklvalve.recording import Recording


def fit_entries(
    problem: Problem,
    whole: Recording,
    judged: Judgement,
    forward: Forward | None,
    flagged: np.ndarray,
    seed: int,
) -> dict[str, Any]:
    """The ``fit`` entries of diagnosis.json, from rows that no fit has seen."""
    nominal, model = judged.nominal, judged.model
    if forward is None:
        forward = forward_in_time(problem, nominal, model)
    made, held = held_out_predictions(problem, whole, nominal, model, forward, judged.correction)
    interleaved = _interleaved(problem, judged)
    fit = {}
    for c in problem.channels:
        fit[c] = errors(whole, made, held, c, problem.noise[c].floor, random_state=seed)
        fit[c]["interleaved"] = {"rmse": _interleaved_errors(problem.recording, interleaved, c)}
    if judged.detected:
        proof = further_proof(problem, whole, judged, made, held, flagged, forward.spans)
        fit = {c: entry | proof[c] for c, entry in fit.items()}
    return fit


def _interleaved(problem: Problem, judged: Judgement) -> dict[str, dict[str, np.ndarray]]:
    """Predictions of contiguous quarters, each by fits to the other three, those after it included.

    Returns
    -------
    predictions : dict
        ``nominal, corrected`` -> channel -> ndarray of shape (n,) [SI].
    """
    tried = judged.tried or cross_validated(problem, judged.model)
    corrected = dict(tried.predictions)
    if judged.correction is not None:
        channel = judged.correction["channel"]
        corrected[channel] = corrected[channel] + tried.learnt_residual
    same = judged.model is judged.nominal
    return {
        "nominal": tried.predictions if same else cross_validated(problem, judged.nominal).predictions,
        "corrected": corrected,
    }


def _interleaved_errors(
    recording: Recording, predictions: dict[str, dict[str, np.ndarray]], channel: str
) -> dict[str, float]:
    """Root mean square errors of `_interleaved`, in the recording's own units."""
    unit = abs(recording.per_si(channel))
    left = {kind: recording[channel] - made[channel] for kind, made in predictions.items()}
    return {kind: float(np.sqrt(np.nanmean(error**2)) * unit) for kind, error in left.items()}
