# SPDX-License-Identifier: BSD-3-Clause
"""What healthy valves do beside a linear process: a gain that changes with the position, or drifts."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sklvalve.mismatch.loop.constants import VARYING_GAIN_PENALTY
from sklvalve.mismatch.loop.fit import LoopFit, refine
from sklvalve.mismatch.loop.process import responses


def likelihood_with_varying_gain(
    fit: LoopFit, stem: NDArray, stem_forecast: NDArray, any_kind: bool
) -> float:
    r"""Log likelihood of a fit where the gain of the valve may change, with its position and over the record.

    Beside the process :math:`G = \sum_i c_i G_i` of the fit stand processes :math:`G` behind a gain of
    :math:`1 \pm \xi`, :math:`1 \pm \tau`, :math:`\tau^2` and :math:`1 - \tau^2`, where :math:`\xi` is the
    position and :math:`\tau` the time, both from -1 to 1 over the record. All weights have one sign, so that
    the gain is never reversed: a gain that may be reads the controller backwards. Friction is none of these,
    so they hide no band; a healthy loop with a linear process borrows a band for each.

    Parameters
    ----------
    fit : LoopFit
    stem, stem_forecast : ndarray of shape (n,)
        Position of its stem, and the forecast from the rows before, since the command of the same row holds
        the controller's answer to the value [fraction of travel].
    any_kind : bool
        As in `responses`.

    Returns
    -------
    log_likelihood : float
        Less a complexity penalty for the gains; that of `fit` where they help less [nats].
    """
    # the weights have the sign of the process, and are multiplied by it again
    regression = fit.regression
    weights = regression.gain_sign * fit.weights
    bent, bent_forecast = (_under_varying_gain(position, stem) for position in (stem, stem_forecast))
    columns = np.einsum("k,mkn->mn", weights, responses(bent, bent_forecast, any_kind))
    if not columns.any():
        return fit.log_likelihood
    linear = regression.responses[fit.index]
    columns *= np.abs(linear).max() / np.abs(columns).max()
    wider = replace(regression, responses=np.concatenate([linear, columns])[None])
    varying = refine(wider, 0, fit.noise_filter)
    return max(fit.log_likelihood, varying.log_likelihood - VARYING_GAIN_PENALTY)


def _under_varying_gain(position: NDArray, stem: NDArray) -> NDArray:
    """A position behind each of the six gains, scaled by the stem's own movement over the record."""
    time = np.linspace(-1.0, 1.0, len(stem))
    middle = stem.mean()
    scaled = (position - middle) / (np.abs(stem - middle).max() or 1.0)
    drifting = (gain * scaled for gain in (1.0 + time, 1.0 - time, time**2, 1.0 - time**2))
    return np.stack([scaled + 0.5 * scaled**2, scaled - 0.5 * scaled**2, *drifting])
