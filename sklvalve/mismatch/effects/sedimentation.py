# SPDX-License-Identifier: BSD-3-Clause
"""Deposits that grow in the passage."""

import numpy as np

from sklvalve.mismatch.effects._growth import hours_left, hours_since
from sklvalve.mismatch.effects._shown import RATE
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain

# a valve that has lost more is blocked, which is another effect
_MOST = 0.8


class Sedimentation(Effect):
    r"""Deposits that take a growing share of the capacity at every opening.

    .. math:: K_v' = K_v\,\bigl(1 - \min(r\,(t - t_0),\, 0.8)\bigr)

    :math:`t_0` is its onset, or the first row of the recording. No signal of the valve tells it from a flow
    meter whose span falls.
    """

    name = key = "sedimentation"
    block, stage = "valve", "capacity"
    parameters = (Quantity("rate", "1/h", 0.0, 10.0, (0.1,), shown=RATE),)
    needs = ("flow",)
    by_drop = "always"
    family = "growth"
    grows = True
    words = "deposits growing in the trim"
    clause = "deposits grow in the trim"
    phrase = "deposits take {rate:.1%} of the capacity an hour"
    separated_by = "Check the flow meter against a second one: a recording of the valve alone shows the same."
    damadics = "f2"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        hours = hours_left(self, chain)
        return (Quantity("rate", "1/h", 0.0, _MOST / hours, (0.05 / hours, 0.25 / hours)),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * (1.0 - np.minimum(p["rate"] * hours_since(self, chain), _MOST))
