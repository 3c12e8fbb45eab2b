# SPDX-License-Identifier: BSD-3-Clause
"""Noise of recordings that were joined: each has its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sklvalve.recording import Recording
from sklvalve.recording.dead_bands import step_of
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.noise import NoiseModel
from sklvalve.simulation.noise_fit import fit_noise


@dataclass(frozen=True, eq=False)
class NoiseOfPieces:
    """Noise of one channel in several recordings, one behind the other.

    Parameters
    ----------
    spans : list of (int, int)
        First row of each, and the row behind its last.
    models : list of NoiseModel
    """

    spans: list[tuple[int, int]]
    models: list[NoiseModel]

    def whiten(self, residuals: np.ndarray) -> np.ndarray:
        """Innovations of the residuals in their standard deviations, zero in gaps."""
        residuals = np.asarray(residuals, dtype=float)
        return np.concatenate([m.whiten(residuals[low:high]) for (low, high), m in self._each()])

    def without(self, rows: np.ndarray) -> NoiseOfPieces:
        """The same noise, with some rows, a mask of shape (n,), as a gap."""
        return replace(self, models=[m.without(rows[low:high]) for (low, high), m in self._each()])

    @property
    def pieces(self) -> list[tuple[int, int, np.ndarray, np.ndarray, np.ndarray]]:
        """First row, row behind the last, gains, what is kept, and spreads, of each recording."""
        return [
            (low + a, low + b, gain, keep, spread)
            for (low, _), model in self._each()
            for a, b, gain, keep, spread in model.pieces
        ]

    @property
    def log_spread(self) -> float:
        """Sum over the rows of the logarithms of the innovations' standard deviations."""
        return sum(m.log_spread for m in self.models)

    @property
    def total(self) -> float:
        """Standard deviation of all that a healthy simulation leaves over, rms over all rows."""
        return self._rms(lambda model: model.total)

    @property
    def floor(self) -> float:
        """Standard deviation of the sensor alone, rms over all rows."""
        return self._rms(lambda model: model.floor)

    @property
    def longest(self) -> tuple[slice, NoiseModel]:
        """Rows of the longest recording, and its noise."""
        (low, high), model = max(self._each(), key=lambda each: each[0][1] - each[0][0])
        return slice(low, high), model

    def _each(self) -> list[tuple[tuple[int, int], NoiseModel]]:
        return list(zip(self.spans, self.models, strict=True))

    def _rms(self, of: Callable[[NoiseModel], float]) -> float:
        rows = [int(np.isfinite(m.white).sum()) for m in self.models]
        squares = [of(m) ** 2 if many else 0.0 for m, many in zip(self.models, rows, strict=True)]
        return float(np.sqrt(np.average(squares, weights=rows)))


def noise_of(
    recording: Recording,
    residuals: np.ndarray,
    simulated: np.ndarray,
    step: np.ndarray,
    role: str,
    **settings: Any,
) -> NoiseModel | NoiseOfPieces:
    """Noise of a channel, fitted to what a simulation leaves over of it.

    Parameters
    ----------
    recording : Recording
    residuals, simulated, step : ndarray of shape (n,)
        As `fit_noise` takes them.
    role : str
        The channel.
    **settings
        Those of `fit_noise` but the quantum, which the recording tells.

    Returns
    -------
    noise : NoiseModel, or NoiseOfPieces where several recordings were joined
    """

    if role == "flow" and drop_is_unknown(recording):
        # a drop that nobody recorded wanders by more than any sensor: what is slow belongs to it
        settings |= {"cautious": False, "largest": np.inf}

    def fitted(left: np.ndarray, made: np.ndarray, steps: np.ndarray, quantum: float) -> NoiseModel:
        return fit_noise(left, made, steps, quantum=quantum, **settings)

    return of_each(recording, residuals, simulated, step, role, fitted)


def of_each(
    recording: Recording,
    residuals: np.ndarray,
    simulated: np.ndarray,
    step: np.ndarray,
    role: str,
    model_of: Callable[[np.ndarray, np.ndarray, np.ndarray, float], NoiseModel],
) -> NoiseModel | NoiseOfPieces:
    """Noise of a channel, of each recording that was joined by itself.

    Parameters
    ----------
    recording, residuals, simulated, step, role
        As `noise_of` takes them.
    model_of : callable
        ``model_of(residuals, simulated, step, quantum)`` of one recording.

    Returns
    -------
    noise : NoiseModel, or NoiseOfPieces where several recordings were joined
    """

    def of(low: int, high: int) -> NoiseModel:
        rows = slice(low, high)
        steps = step[rows].copy()
        # the time since the piece before is no time of this one
        steps[0] = np.median(steps[1:]) if len(steps) > 1 else steps[0]
        return model_of(residuals[rows], simulated[rows], steps, step_of(recording.slice(low, high), role))

    # a piece without a value of this channel has no noise to be told, and asks for none
    spans = recording.spans
    if len(spans) == 1:
        return of(*spans[0])
    return NoiseOfPieces(
        spans, [of(*span) if _seen(residuals, *span) else _none(step, *span) for span in spans]
    )


def _seen(residuals: np.ndarray, low: int, high: int) -> bool:
    return np.isfinite(residuals[low:high]).sum() > 2


def _none(step: np.ndarray, low: int, high: int) -> NoiseModel:
    """Noise of rows that hold nothing: every one a gap."""
    white = np.full(high - low, np.inf)
    return NoiseModel(white, step[low:high], 1.0, 1e-12, 1.0, 1e-12, sensor=0.0)
