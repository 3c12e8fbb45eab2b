# SPDX-License-Identifier: BSD-3-Clause
"""Time since an effect began, for those that grow."""

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.simulation.chain import Chain


def hours_since(effect: Effect, chain: Chain) -> np.ndarray:
    """Time since an effect's onset, or since the first row where it has none; zero before it.

    Parameters
    ----------
    effect : Effect
    chain : Chain

    Returns
    -------
    hours : ndarray of shape (n,)
        [h].
    """
    begin = chain.onsets.get(effect.key)
    begin = chain.clock[0] if begin is None else begin
    return np.maximum(chain.clock - begin, 0.0) / 3600.0


def hours_left(effect: Effect, chain: Chain) -> float:
    """How long an effect grows within the recording, a minute at least [h]."""
    return max(float(hours_since(effect, chain)[-1]), 1.0 / 60.0)
