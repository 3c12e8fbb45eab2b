# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a channel: white, quickly correlated and slowly wandering parts, as a filter that whitens.

Residuals of a valve are correlated. A test that takes them for independent raises a false alarm in nearly
every healthy record, and one that whitens them without a slow part in most. So the noise is a state-space
model, and the time constant of its wander comes from the data.
"""

from dataclasses import dataclass

import numba as nb
import numpy as np


@nb.njit(cache=True, nogil=True)
def _gains(white, step, fast_time, fast_size, slow_time, slow_size):
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
def _innovations(residuals, gain, keep, spread):
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
    """

    white: np.ndarray
    step: np.ndarray
    fast_time: float
    fast_size: float
    slow_time: float
    slow_size: float
    sensor: float | None = None

    def __post_init__(self):
        filters = _gains(
            self.white, self.step, self.fast_time, self.fast_size, self.slow_time, self.slow_size
        )
        object.__setattr__(self, "_filters", filters)

    def whiten(self, residuals):
        """Innovations of the residuals in their standard deviations, zero in gaps."""
        return _innovations(np.ascontiguousarray(residuals, dtype=float), *self._filters)

    @property
    def pieces(self):
        """First row, row behind the last, gains, what is kept, and spreads, of each recording: one here."""
        return [(0, len(self.white), *self._filters)]

    @property
    def log_spread(self):
        """Sum over the rows of the logarithms of the innovations' standard deviations."""
        spread = self._filters[2]
        return float(np.sum(np.log(spread[np.isfinite(spread)])))

    @property
    def total(self):
        """Standard deviation (rms over the rows) of all that a healthy simulation leaves over.

        The sensor, errors of timing, what the simulation gets wrong, and wander.
        """
        return float(np.sqrt(self._white + self.fast_size + self.slow_size))

    @property
    def floor(self):
        """Standard deviation (rms over the rows) of the sensor alone: its white noise and its quick movement.

        What a simulation could do something about is no part of it: timing, inadequacy, wander.
        """
        sensor = self._white if self.sensor is None else self.sensor
        return float(np.sqrt(sensor + self.fast_size))

    @property
    def _white(self):
        return float(np.mean(self.white[np.isfinite(self.white)]))
