# SPDX-License-Identifier: BSD-3-Clause
"""Resistance in series with the trim."""

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW
from sklvalve.mismatch.effects._shown import LOSS
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain

#: Share of a loss in series that lies before the trim, velocity head included.
BEFORE = Quantity("before", "1", 0.0, 2.0, (0.7,), null=None, silent=True)


class PipingReducers(Effect):
    r"""Fittings at the valve that cost pressure with the square of the flow.

    .. math:: K_v' = \frac{K_v}{\sqrt{1 + s}}, \quad s = \zeta \left(\frac{K_v}{K_{v,rated}}\right)^2, \quad
        \Delta p_{choked} = F_L^2 \frac{1 + s}{1 + F_L^2 z s} (p_1 - F_F p_v)

    the factors F_P and F_LP of IEC 60534-2-1: the flow loses more the further the valve is open, the same
    share at every pressure drop, and the trim, which has only its own part of the drop, chokes at another
    drop between the taps. z is the share of the loss before the trim, the velocity head there included: 0
    where all of it is behind, above 1 for reducers on both sides. It begins within a recording where
    fittings foul.
    """

    name = key = "piping_reducers"
    kind = "property"
    block, stage = "line", "line"
    parameters = (Quantity("loss", "1", 0.0, 30.0, (0.3, 1.5), shown=LOSS), BEFORE)
    needs: tuple = ("flow",)
    hidden_by = END_OF_FLOW
    by_drop = "always"
    family = "series"
    source = "IEC 60534-2-1"
    words = "reducers or fittings at the valve"
    clause = "reducers or fittings at the valve take pressure"
    phrase = "fittings or line in series with the valve cost {loss:.2g} times its own loss when fully open"
    separated_by = (
        "Pressure taps directly at the valve; no signal beyond them tells reducers from a line loss."
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value / np.sqrt(1.0 + self._taken(value, p, chain))

    def recovery(self, fl: np.ndarray, kv: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        taken = self._taken(kv, p, chain)
        # without choking F_L is infinite, and stays so
        share = np.where(np.isinf(fl), 0.0, fl * fl) * p["before"] * taken
        return fl * np.sqrt((1.0 + taken) / (1.0 + share))

    @staticmethod
    def _taken(kv: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        """Drop of the fittings in drops of the trim [1]."""
        return p["loss"] * (kv / chain.trim.rated) ** 2

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known
