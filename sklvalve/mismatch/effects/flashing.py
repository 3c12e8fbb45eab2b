# SPDX-License-Identifier: BSD-3-Clause
"""Liquid that boils behind the valve."""

import numpy as np

from sklvalve.mismatch.effects._defects import UNSTEADY, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain

_FEWEST = 0.01


class Flashing(Effect):
    r"""Vapour behind the valve, of which a volume meter downstream counts some as liquid.

    .. math:: F' = F \Bigl(1 + s\, \frac{p_v - p_2}{p_v}\Bigr) \text{ for } p_2 < p_v(T)

    The share of liquid that boils is proportional, to first order, to how far the outlet pressure lies below
    the vapour pressure; :math:`s` says by how much it swells what the meter counts. The flow through such a
    valve is choked as well: that is `choked_flow`, an effect of its own.
    """

    name = key = "flashing"
    kind, fluid = "property", "liquid"
    block, stage = "valve", "flow"
    parameters = (Quantity("swelling", "1", 0.0, 20.0, (0.3, 3.0)),)
    needs = ("flow", "p1", "p2")
    hidden_by = hidden(UNSTEADY, saturated=("flow", "p2"), unmeasured=("temperature",))
    words = "flashing"
    clause = "the liquid flashes"
    phrase = "liquid boils behind the valve and swells what the meter counts"
    separated_by = "Raise the outlet pressure above the vapour pressure: what boiling adds vanishes at once."
    damadics = "f7"
    requires = "the liquid's vapour pressure, and outlet pressures below it"

    def _depth(self, chain: Chain) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.clip(1.0 - chain.p2 / chain.vapour, 0.0, 1.0)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * (1.0 + p["swelling"] * self._depth(chain))

    def possible(self, chain: Chain) -> bool:
        return chain.vapour is not None and bool(np.mean(self._depth(chain) > 0.0) > _FEWEST)
