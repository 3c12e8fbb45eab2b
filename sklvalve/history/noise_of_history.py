# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a later recording, of the parts that the valve's history has it of."""

from __future__ import annotations

import numpy as np

from sklvalve.recording import Recording
from sklvalve.simulation.noise import NoiseModel, NoiseParts
from sklvalve.simulation.noise_fit import quick_size
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces, of_each


def as_before(
    parts: NoiseParts,
    recording: Recording,
    residuals: np.ndarray,
    simulated: np.ndarray,
    step: np.ndarray,
    role: str,
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

    Returns
    -------
    noise : NoiseModel, or NoiseOfPieces where several recordings were joined
    """

    def louder(left: np.ndarray, made: np.ndarray, steps: np.ndarray, quantum: float) -> NoiseModel:
        times = max(1.0, quick_size(left, made, quantum) / parts.size)
        noise = parts.louder(times, float(np.median(steps)))
        return noise.model(np.isfinite(left), made, steps)

    return of_each(recording, residuals, simulated, step, role, louder)
