# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a later recording, of the parts that the valve's history has it of."""

from __future__ import annotations

import numpy as np

from sklvalve.recording import Recording
from sklvalve.recording.dead_bands import step_of
from sklvalve.simulation.noise import NoiseModel, NoiseParts, quick_size
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces


def as_before(
    parts: NoiseParts,
    recording: Recording,
    residuals: np.ndarray,
    simulated: np.ndarray,
    step: np.ndarray,
    role: str,
    inadequacy: float,
) -> NoiseModel | NoiseOfPieces:
    """Noise of a channel as the history has it, louder where the recording is louder from row to row.

    Parameters
    ----------
    parts : NoiseParts
    recording : Recording
    residuals, simulated, step : ndarray of shape (n,)
        As `fit_noise` takes them.
    role : str
        The channel.
    inadequacy : float
        Standard deviation of what a healthy simulation gets wrong [SI].

    Returns
    -------
    noise : NoiseModel, or NoiseOfPieces where several recordings were joined
    """

    def of(low: int, high: int) -> NoiseModel:
        rows = slice(low, high)
        steps = step[rows].copy()
        steps[0] = np.median(steps[1:]) if len(steps) > 1 else steps[0]
        left, made = residuals[rows], simulated[rows]
        size = quick_size(left, made, step_of(recording.slice(low, high), role))
        louder = parts.louder(max(1.0, size / parts.size))
        return louder.model(np.isfinite(left), made, steps, inadequacy=inadequacy)

    spans = recording.spans
    if len(spans) == 1:
        return of(*spans[0])
    return NoiseOfPieces(spans, [of(*span) for span in spans])
