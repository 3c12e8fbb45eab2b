# SPDX-License-Identifier: BSD-3-Clause
"""The whole finder, its noise model replaced by white noise of the residual's variance.

Search, onsets, classes, held-out blocks and the rest are as they are: what the table shows beside the finder
itself is what the noise model is worth.
"""

from unittest.mock import patch

import numpy as np

from benchmarks.concealed.methods import ours
from sklvalve.simulation.noise import NoiseModel


def white_noise(residuals, simulated, step, *, quantum=0.0, **settings):
    """Noise model of residuals that takes all rows for independent and alike.

    Parameters
    ----------
    residuals : ndarray of shape (n,)
        Recorded less simulated; NaN in gaps.
    simulated, step : ndarray of shape (n,)
    quantum : float, default=0.0
        Resolution of the recorded signal; its variance is a floor.
    **settings
        Of `sklvalve.simulation.noise.fit_noise`; not used.

    Returns
    -------
    noise : NoiseModel
    """
    residuals = np.asarray(residuals, dtype=float)
    seen = np.isfinite(residuals)
    least = max(quantum**2 / 12.0, (1e-6 * float(np.nanmax(np.abs(simulated)))) ** 2, 1e-24)
    variance = max(float(np.mean(residuals[seen] ** 2)), least)
    dt = float(np.median(step))
    return NoiseModel(np.where(seen, variance, np.inf), step, dt, 0.0, 100.0 * dt, 0.0)


def diagnose(recording, *, folder=None, **settings):
    """Diagnosis by `MissingPhysicsFinder` under white noise; as `ours.diagnose`.

    The noise model is replaced while the finder works, for the whole process: run no other diagnosis beside.
    """
    with patch("sklvalve.simulation.noise_of_pieces.fit_noise", white_noise):
        return ours.diagnose(recording, folder=folder, **settings)
