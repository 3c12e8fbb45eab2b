# SPDX-License-Identifier: BSD-3-Clause
"""Resistance in series with the trim."""

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW
from sklvalve.mismatch.effects._shown import LOSS
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain


class PipingReducers(Effect):
    r"""Fittings at the valve that cost pressure with the square of the flow.

    .. math:: K_v' = K_v / \sqrt{1 + \zeta (K_v / K_{v,rated})^2}

    the piping factor F_P of IEC 60534-2-1; it grows with the opening, the same at every pressure drop. It
    begins within a recording where fittings foul.
    """

    name = key = "piping_reducers"
    kind = "property"
    block, stage = "line", "line"
    parameters = (Quantity("loss", "1", 0.0, 30.0, (0.3, 1.5), shown=LOSS),)
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
        return value / np.sqrt(1.0 + p["loss"] * (value / chain.trim.rated) ** 2)

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known
