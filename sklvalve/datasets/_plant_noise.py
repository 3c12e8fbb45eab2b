# SPDX-License-Identifier: BSD-3-Clause
"""What of a plant's noise stands between a change and its being seen: the law that the plant draws from."""

import numpy as np
from numba import njit

from sklvalve.datasets._plant_rig import RESOLUTION


@njit(cache=True)
def _innovations(columns, poles, envelopes, white):
    """Columns through the Kalman filter of first-order noises of unit variance, scaled row by row."""
    n, width = columns.shape
    size = poles.size
    means = np.zeros((size, width))
    spread = np.eye(size)
    out = np.empty((n, width))
    for k in range(n):
        if k > 0:
            for i in range(size):
                for c in range(width):
                    means[i, c] *= poles[i]
                for j in range(size):
                    spread[i, j] *= poles[i] * poles[j]
                spread[i, i] += 1.0 - poles[i] * poles[i]
        scale = envelopes[k]
        shared = spread @ scale
        variance = white + scale @ shared
        gain = shared / variance
        for c in range(width):
            wrong = columns[k, c] - scale @ np.ascontiguousarray(means[:, c])
            out[k, c] = wrong / np.sqrt(variance)
            for i in range(size):
                means[i, c] += gain[i] * wrong
        for i in range(size):
            for j in range(size):
                spread[i, j] -= gain[i] * shared[j]
    return out


def _whitened(columns, parts, white):
    """`parts`: time constant [s] and standard deviation, one or one a row, of each first-order noise."""
    n = len(columns)
    poles = np.array([np.exp(-1.0 / seconds) for seconds, _ in parts])
    envelopes = np.column_stack([np.broadcast_to(size, n) for _, size in parts])
    return _innovations(np.ascontiguousarray(columns), poles, np.ascontiguousarray(envelopes), white)


def _steps(name):
    """Variance of rounding to what a sensor resolves, in its column's unit."""
    return RESOLUTION[name] ** 2 / 12.0


def whitened_opening(columns, level):
    """Series of opening [1], divided by the noise of the stem sensor, so that what is left has unit variance.

    Parameters
    ----------
    columns : ndarray of shape (n, m)
        One row a second.
    level : float
        Factor on the sensors' noise.
    """
    white = ((0.12 * level) ** 2 + _steps("X") + 1e-4 / 12.0) * 1e-4
    return _whitened(columns, [(10.0, 4e-4 * level), (500.0, 3e-4 * level)], white)


def whitened_flow(columns, level, plant, flow, slope, drop):
    """Series of flow [m3/h], divided by the noise of a flow that is computed from recorded signals.

    The noise of stem and pressure sensors is part of it, since the recorded opening and pressures go in.

    Parameters
    ----------
    columns : ndarray of shape (n, m)
    level : float
    plant : Plant
    flow, slope, drop : ndarray of shape (n,)
        Flow [m3/h], its slope over the opening [m3/h], and pressure drop [kPa].
    """
    lag = plant.healthy["meter_lag"]
    pole = np.exp(-1.0 / lag)
    smoothed = np.sqrt((1.0 - pole) / (1.0 + pole))  # of white noise by the meter's response
    stem = 1e-2 * np.sqrt((0.12 * level) ** 2 + _steps("X"))
    pressure = np.sqrt(2.0 * ((0.25 * level) ** 2 + _steps("P1")))
    by_drop = 0.5 * flow / np.maximum(drop, 1.0)
    span = 1.5 * plant.kv * level
    parts = [
        (9.0, 0.001 * span),
        (600.0, 0.001 * span),
        (2.0 + lag, 0.002 * level * np.abs(flow) * np.sqrt(2.0 / (2.0 + lag))),
        (lag, smoothed * np.hypot(stem * slope, pressure * by_drop)),
        (10.0, 4e-4 * level * slope),
        (500.0, 3e-4 * level * slope),
        (400.0, np.sqrt(2.0) * 0.15 * level * by_drop),
    ]
    return _whitened(columns, parts, (0.0022 * span) ** 2 + _steps("F"))
