# SPDX-License-Identifier: BSD-3-Clause
"""What bends a healthy loop: a valve whose gain changes with its position, and a gain that drifts."""

import numpy as np

from sklvalve.mismatch.loop.fit import refined
from sklvalve.mismatch.loop.process import responses

_BENDS = 3  # degrees of freedom of the six gains below, beside that of the process itself


def beside_a_bend(columns, fit, stem, ahead, loop, sense, waves=None):
    r"""A fit once more where the gain of the valve may change, with its position and over the record.

    Beside the process :math:`G = \sum_i c_i G_i` of the fit stand processes :math:`G` behind a gain of
    :math:`1 \pm \xi`, :math:`1 \pm \tau`, :math:`\tau^2` and :math:`1 - \tau^2`, where :math:`\xi` is the
    position and :math:`\tau` the time, both from -1 to 1 over the record. All weights have one sign, so that
    the gain is never reversed: a gain that may be reads the controller backwards. Friction is none of these,
    so they hide no band; a healthy loop with a linear process borrows a band for each.

    Parameters
    ----------
    columns : ndarray of shape (m, k, n)
        Responses to each stem.
    fit : LoopFit
    stem, ahead : ndarray of shape (n,)
        Position of its stem [fraction of travel], and as foreseen from the rows before: the command of the
        same row holds the controller's answer to the value.
    loop : LoopSignals
    sense : int
        Sign of the response.
    waves : ndarray of shape (w, n), optional
        An oscillation from outside that stands beside the stem already.

    Returns
    -------
    likelihood : float
        Log likelihood, with three taken off for the gains; that of `fit` where they help less.
    """
    # `mixture` has the sign of the process, and weights are multiplied by it again
    bent = [_bent(moved, stem) for moved in (stem, ahead)]
    answers = np.einsum("k,mkn->mn", sense * fit.mixture, responses(*bent, not loop.is_flow))
    if not answers.any():
        return fit.log_likelihood
    answers *= np.abs(columns[fit.stem]).max() / np.abs(answers).max()
    wider = np.concatenate([columns[fit.stem], answers])[None]
    other = refined(wider, 0, loop.value, loop.used, sense, fit.noise, waves)
    return max(fit.log_likelihood, other.log_likelihood - _BENDS)


def _bent(moved, stem):
    """What the gains make of a position, each over the record of the stem."""
    time = np.linspace(-1.0, 1.0, len(stem))
    middle = stem.mean()
    place = (moved - middle) / (np.abs(stem - middle).max() or 1.0)
    drifting = (gain * place for gain in (1.0 + time, 1.0 - time, time**2, 1.0 - time**2))
    return np.stack([place + 0.5 * place**2, place - 0.5 * place**2, *drifting])
