# SPDX-License-Identifier: BSD-3-Clause
"""A residual that comes back in time: a cycle of one period, which no signal that was recorded drives.

The wander of a meter has no period. So a cycle is told by likelihood: of the noise with a cycle beside it
against that of the noise alone, each with its own quick part and wander, over all periods that were tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.constants import LEAST_P_VALUE
from sklvalve.simulation.noise_of_pieces import noise_of
from sklvalve.simulation.robust import robust_cost, robust_weights

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.simulation.noise import NoiseModel
    from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

    Noise = NoiseModel | NoiseOfPieces

# cycles in the recording at the least, and the shortest period in rows and in seconds
_FEWEST_CYCLES, _FEWEST_ROWS, _SHORTEST = 4, 40, 60.0
# log likelihood that a cycle must add, whatever the number of periods
_LEAST_GAIN = 15.0
# a simulated signal that swings so many times as far, in a line so far above what is around it, is its cause
_DRIVEN, _LINE, _AROUND = 2.0, 8.0, 12
_REFITS = 2
# frequencies tried between those next to the best
_BETWEEN = 41


@dataclass(frozen=True)
class Cycle:
    """A cycle in the residual of a channel.

    Parameters
    ----------
    period : float
        [s]
    p_value : float
        Probability that noise alone shows one as clear at any of the periods tried.
    """

    period: float
    p_value: float


def find_cycle(problem: Problem, model: Model, channel: str) -> Cycle | None:
    """Look for a cycle in what a model leaves over of a channel.

    Parameters
    ----------
    problem : Problem
    model : Model
    channel : str

    Returns
    -------
    cycle : Cycle or None
    """
    clock, left = model.chain.clock - model.chain.clock[0], problem.residuals(model)[channel]
    simulated, noise = model.predictions[channel], problem.noise[channel]
    shortest = max(_SHORTEST, _FEWEST_ROWS * problem.recording.sample_time)
    # of the time that was recorded: years between two recordings tell nothing of a cycle
    length = min(clock[-1], len(clock) * problem.recording.sample_time)
    frequencies = np.arange(_FEWEST_CYCLES, int(length / shortest) + 1) / max(length, 1e-12)
    if not len(frequencies):
        return None
    settings: dict[str, Any] = problem.noise_settings(channel)
    learn = partial(
        noise_of,
        problem.recording,
        simulated=simulated,
        step=model.chain.step,
        role=channel,
        **settings,
    )
    filtered = _Filtered(noise, left)
    best: tuple[float, float] = (0.0, np.nan)
    # as high everywhere, or growing with the signal
    for height in (np.ones_like(simulated), np.nan_to_num(simulated / np.nanmax(np.abs(simulated)))):
        waves = partial(_waves, clock, height)
        gains = [filtered.fitted(waves(f))[1] for f in frequencies]
        k = int(np.argmax(gains))
        if gains[k] < 0.3 * _LEAST_GAIN or _driven(simulated, left, waves, frequencies, k):
            continue
        # between the frequencies that the length of the recording holds apart
        near = frequencies[k] + np.linspace(-1.0, 1.0, _BETWEEN) / length
        frequency = near[int(np.argmax([filtered.fitted(waves(f))[1] for f in near]))]
        gain = _gain_with_noise_refitted(learn, left, waves(frequency))
        if gain > best[0]:
            best = gain, 1.0 / frequency
    gain, period = best
    if gain < _LEAST_GAIN:
        return None
    tries = 2 * len(frequencies)
    p_value = float(-np.expm1(tries * np.log1p(-np.exp(-gain))))
    return Cycle(float(f"{period:.5g}"), max(p_value, LEAST_P_VALUE))


def _waves(clock: np.ndarray, height: np.ndarray, frequency: float) -> np.ndarray:
    angle = 2.0 * np.pi * frequency * clock
    return np.column_stack([height * np.cos(angle), height * np.sin(angle)])


class _Filtered:
    """Residuals through the noise's filter, rows weighed as the robust loss weighs them."""

    def __init__(self, noise: Noise, left: np.ndarray) -> None:
        self._noise, self._gap = noise, ~np.isfinite(left)
        white = noise.whiten(left)
        self._weights = np.sqrt(robust_weights(white))
        self._target = self._weights * white

    def fitted(self, waves: np.ndarray) -> tuple[np.ndarray, float]:
        """Sizes of a cycle's waves, and what they add to the log likelihood while the noise stays."""
        whitened = [self._noise.whiten(np.where(self._gap, np.nan, each)) for each in waves.T]
        columns = self._weights[:, None] * np.column_stack(whitened)
        size = np.linalg.lstsq(columns, self._target, rcond=None)[0]
        left = self._target - columns @ size
        return size, 0.5 * float(self._target @ self._target - left @ left)


def _gain_with_noise_refitted(learn: Callable[..., Noise], left: np.ndarray, waves: np.ndarray) -> float:
    """What a cycle adds where the noise is learnt anew, without it and beside it."""
    alone = learn(residuals=left)
    size, _ = _Filtered(alone, left).fitted(waves)
    for _ in range(_REFITS):
        beside = learn(residuals=left - waves @ size)
        size, _ = _Filtered(beside, left).fitted(waves)
    return _cost(alone, left) - _cost(beside, left - waves @ size)


def _cost(noise: Noise, left: np.ndarray) -> float:
    return robust_cost(noise.whiten(left)) + noise.log_spread


def _driven(
    simulated: np.ndarray,
    left: np.ndarray,
    waves: Callable[[float], np.ndarray],
    frequencies: np.ndarray,
    k: int,
) -> bool:
    """Whether the simulated signal itself swings at a period, so that a small error of it would as well."""
    seen = np.isfinite(simulated) & np.isfinite(left)

    def height(signal: np.ndarray, i: int) -> float:
        columns = waves(frequencies[i])[seen]
        return float(np.hypot(*np.linalg.lstsq(columns, signal[seen] - np.mean(signal[seen]), rcond=None)[0]))

    around = [i for i in range(max(k - _AROUND, 0), min(k + _AROUND + 1, len(frequencies))) if abs(i - k) > 1]
    if not around or height(simulated, k) < _DRIVEN * height(left, k):
        return False
    return height(simulated, k) > np.sqrt(_LINE) * float(np.median([height(simulated, i) for i in around]))
