# SPDX-License-Identifier: BSD-3-Clause
"""Capacity lost to bubbles before the flow chokes."""

import numpy as np

from sklvalve.mismatch.effects._defects import UNSTEADY
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain

_SEEN = 0.2
_BEGINS = Shown("pressure ratio at which it begins")


class Cavitation(Effect):
    r"""Bubbles in the vena contracta that take a little of the capacity, more as cavitation goes further.

    .. math:: K_v' = K_v \Bigl(1 - c\, \frac{x_F - x_{Fz}}{1 - x_{Fz}}\Bigr)
              \text{ for } x_F = \frac{\Delta p}{p_1 - p_v} > x_{Fz}

    The pressure ratio :math:`x_F` at which it begins and its name are of IEC 60534-8-4; that the loss grows
    linearly is a first approximation. Choking is the end of the same: it bends the flow at one ratio.
    Cavitation is heard, and shows as noise of flow and outlet pressure, before it shows here.
    """

    name = key = "cavitation"
    kind, fluid = "property", "liquid"
    block, stage = "valve", "capacity"
    parameters = (
        Quantity("loss", "1", 0.0, 0.4, (0.05, 0.15), shown=Shown("largest loss of capacity", "%", 100.0)),
        Quantity("begins", "1", 0.15, 0.9, (0.3, 0.6), null=None, shown=_BEGINS),
    )
    needs = ("flow", "p1", "p2")
    hidden_by = UNSTEADY
    words = "cavitation"
    clause = "the liquid cavitates"
    phrase = "cavitation takes capacity from a pressure ratio of {begins:.2f} on"
    separated_by = (
        "Lower the outlet pressure slowly at a fixed opening and record it fast: its noise rises where "
        "cavitation begins."
    )
    source = "IEC 60534-8-4"
    requires = "the liquid's vapour pressure, and pressure drops of 0.2 (p1 - pv) or more"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = chain.dp / (chain.p1 - chain.vapour)
        far = np.clip((ratio - p["begins"]) / (1.0 - p["begins"]), 0.0, 1.0)
        return value * (1.0 - p["loss"] * far)

    def possible(self, chain: Chain) -> bool:
        if chain.vapour is None:
            return False
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = chain.dp / (chain.p1 - chain.vapour)
        return bool(np.nanquantile(ratio, 0.99) > _SEEN)
