# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a channel: white, quickly correlated and slowly wandering parts.

Residuals of a valve are correlated. A test that takes them for independent raises a false alarm in nearly
every healthy record, and one that whitens them without a slow part in most. So the noise is a state-space
model, and the time constant of its wander comes from the data (`sklvalve.simulation.noise_fit`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numba as nb
import numpy as np

from sklvalve.recording.gaps import filled

# a healthy simulation is wrong by about this share of what counts as an effect, and no correlated noise of a
# sensor is larger than so many times that
_INADEQUACY, _LARGEST = 0.2, 2.0
#: The instant of a row is known to a tenth of its distance from the next: variance, as share of the square of
#: what a signal moves from row to row. The few strokes of a recording may come out better than the next will.
TIMING = 0.01


@nb.njit(cache=True, nogil=True)
def _gains(
    white: np.ndarray,
    step: np.ndarray,
    fast_time: float,
    fast_size: float,
    slow_time: float,
    slow_size: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Kalman gains and innovation spreads; a row with an infinite white variance is a gap."""
    n = len(white)
    gain = np.empty((n, 2))
    keep = np.empty((n, 2))
    spread = np.empty(n)
    p11, p12, p22 = fast_size, 0.0, slow_size
    a = b = last = 0.0
    for k in range(n):
        if step[k] != last:
            last = step[k]
            a = np.exp(-last / fast_time)
            b = np.exp(-last / slow_time)
        p11 = a * a * p11 + (1.0 - a * a) * fast_size
        p22 = b * b * p22 + (1.0 - b * b) * slow_size
        p12 = a * b * p12
        keep[k, 0] = a
        keep[k, 1] = b
        if white[k] == np.inf:
            gain[k, 0] = 0.0
            gain[k, 1] = 0.0
            spread[k] = np.inf
            continue
        s = p11 + 2.0 * p12 + p22 + white[k]
        g1 = (p11 + p12) / s
        g2 = (p12 + p22) / s
        gain[k, 0] = g1
        gain[k, 1] = g2
        spread[k] = np.sqrt(s)
        q11, q12, q22 = p11, p12, p22
        p11 = q11 - g1 * (q11 + q12)
        p12 = q12 - g1 * (q12 + q22)
        p22 = q22 - g2 * (q12 + q22)
    return gain, keep, spread


@nb.njit(cache=True, nogil=True)
def _innovations(residuals: np.ndarray, gain: np.ndarray, keep: np.ndarray, spread: np.ndarray) -> np.ndarray:
    out = np.zeros_like(residuals)
    f = 0.0
    s = 0.0
    for k in range(len(residuals)):
        f *= keep[k, 0]
        s *= keep[k, 1]
        e = residuals[k]
        if e == e and spread[k] != np.inf:
            left = e - f - s
            f += gain[k, 0] * left
            s += gain[k, 1] * left
            out[k] = left / spread[k]
    return out


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """Noise of one channel, as a filter that whitens residuals.

    Parameters
    ----------
    white : ndarray of shape (n,)
        Variance of the uncorrelated part in each row, infinite in gaps.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    fast_time, slow_time : float
        Correlation times of the quick part and of the wander [s].
    fast_size, slow_size : float
        Their variances.
    sensor : float, default=None
        Variance of the sensor's own part of `white`, mean over the rows; all of it unless given.
    parts : NoiseParts, default=None
        What it was made of, where it was fitted.
    """

    white: np.ndarray
    step: np.ndarray
    fast_time: float
    fast_size: float
    slow_time: float
    slow_size: float
    sensor: float | None = None
    parts: NoiseParts | None = None
    _filters: tuple[np.ndarray, np.ndarray, np.ndarray] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        filters = _gains(
            self.white, self.step, self.fast_time, self.fast_size, self.slow_time, self.slow_size
        )
        object.__setattr__(self, "_filters", filters)

    def whiten(self, residuals: np.ndarray) -> np.ndarray:
        """Innovations of the residuals in their standard deviations, zero in gaps."""
        return _innovations(np.ascontiguousarray(residuals, dtype=float), *self._filters)

    def without(self, rows: np.ndarray) -> NoiseModel:
        """The same noise, with some rows, a mask of shape (n,), as a gap."""
        return replace(self, white=np.where(rows, np.inf, self.white))

    @property
    def pieces(self) -> list[tuple[int, int, np.ndarray, np.ndarray, np.ndarray]]:
        """First row, row behind the last, gains, what is kept, and spreads, of each recording: one here."""
        return [(0, len(self.white), *self._filters)]

    @property
    def log_spread(self) -> float:
        """Sum over the rows of the logarithms of the innovations' standard deviations."""
        spread = self._filters[2]
        return float(np.sum(np.log(spread[np.isfinite(spread)])))

    @property
    def total(self) -> float:
        """Standard deviation (rms over the rows) of all that a healthy simulation leaves over.

        The sensor, errors of timing, what the simulation gets wrong, and wander.
        """
        return float(np.sqrt(self._white + self.fast_size + self.slow_size))

    @property
    def floor(self) -> float:
        """Standard deviation (rms over the rows) of the sensor alone: its white noise and its quick movement.

        What a simulation could do something about is no part of it: timing, inadequacy, wander.
        """
        sensor = self._white if self.sensor is None else self.sensor
        return float(np.sqrt(sensor + self.fast_size))

    @property
    def _white(self) -> float:
        return float(np.mean(self.white[np.isfinite(self.white)]))


def movement(simulated: np.ndarray, step: np.ndarray, memory: float = 4.5) -> np.ndarray:
    """How fast a simulated signal moves around each row: where errors of timing and response weigh.

    Parameters
    ----------
    simulated, step : ndarray of shape (n,)
    memory : float, default=4.5
        Time constant with which a movement is forgotten [s]; a healthy response is over after a few.
    """
    bridged = filled(simulated)
    slope = np.abs(np.diff(bridged, prepend=bridged[0]))
    ahead = np.append(slope[1:], 0.0)
    return _forgotten(np.maximum(slope, 0.5 * ahead), np.exp(-step / memory))


@nb.njit(cache=True, nogil=True)
def _forgotten(values: np.ndarray, keep: np.ndarray) -> np.ndarray:
    out = np.empty_like(values)
    held = 0.0
    for k in range(len(values)):
        held = max(values[k], keep[k] * held)
        out[k] = held
    return out


def sizes_of_noise(counts: float) -> dict[str, float]:
    """How large a noise may be beside what counts as an effect: settings of `fit_noise`.

    A wander without a bound takes up whatever a calibration misses, and what is calibrated by it misses more.

    Parameters
    ----------
    counts : float
        Size from which on a change of the signal counts [SI].

    Returns
    -------
    settings : dict
        `inadequacy` and `largest`.
    """
    return {"inadequacy": _INADEQUACY * counts, "largest": _LARGEST * counts}


@dataclass(frozen=True)
class NoiseParts:
    """What a noise is made of, whichever rows it is in.

    Parameters
    ----------
    base, share : float
        Variances of the sensor's white part: everywhere, and in proportion to the square of the signal, where
        that is at its peak or beyond.
    peak : float
        Largest size of the signal that the noise was seen at.
    timing : float
        Variance of errors of timing, share of the square of the movement from row to row [1].
    fast_time, fast : float
        Correlation time [s] and variance of the quick part.
    slow_time, slow : float
        Those of the wander.
    size : float
        Standard deviation of the quick noise, by differences from row to row.
    inadequacy : float
        Standard deviation of what a healthy simulation gets wrong from row to row. White noise below it is
        not told from it, so it goes with the other parts to other rows.
    """

    base: float
    share: float
    peak: float
    timing: float
    fast_time: float
    fast: float
    slow_time: float
    slow: float
    size: float
    inadequacy: float

    def louder(self, times: float, step: float) -> NoiseParts:
        """The same noise where differences from row to row are so many times as large.

        They speak of a part as far as it changes from row to row: all of what is white, and next to nothing
        of the wander. Errors of timing stay as they are.

        Parameters
        ----------
        times : float
            At least 1.
        step : float
            Time between rows [s].
        """
        square = times**2
        # share of a part that is new in each row
        fresh = -np.expm1(-step / np.array([self.fast_time, self.slow_time]))
        fast, slow = 1.0 + (square - 1.0) * fresh
        return replace(
            self,
            # nothing tells how much of the white noise the sensor has, but no more than differences show
            base=self.base * square + min(self.inadequacy, self.size) ** 2 * (square - 1.0),
            share=self.share * square,
            fast=self.fast * float(fast),
            slow=self.slow * float(slow),
            size=self.size * times,
        )

    def model(self, seen: np.ndarray, simulated: np.ndarray, step: np.ndarray) -> NoiseModel:
        """Noise of these parts in some rows.

        Parameters
        ----------
        seen : ndarray of bool, shape (n,)
            Rows that are no gaps.
        simulated, step
            As `fit_noise` takes them.
        """
        # further up than it was seen at, loudness tells
        height = np.minimum(np.abs(np.nan_to_num(np.asarray(simulated, dtype=float) / self.peak)), 1.0)
        sensor = self.base + self.share * height**2
        moving = movement(simulated, step) ** 2
        white = np.where(seen, sensor + self.inadequacy**2 + self.timing * moving, np.inf)
        known = float(np.mean(sensor[seen])) if seen.any() else 0.0
        return NoiseModel(
            white, step, self.fast_time, self.fast, self.slow_time, self.slow, known, parts=self
        )
