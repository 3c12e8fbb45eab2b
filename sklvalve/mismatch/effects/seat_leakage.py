# SPDX-License-Identifier: BSD-3-Clause
"""Flow beside the trim, through a seat that does not close."""

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain


class SeatLeakage(Effect):
    r"""Leak through the seat, a capacity in parallel at every opening: :math:`K_v' = K_v + K_{leak}`."""

    name = key = "seat_leakage"
    block, stage = "valve", "capacity"
    # what is possible follows the valve's size: `quantities`
    parameters = (Quantity("leak_kv", "m3/h", 0.0, 1.0, (0.3,)),)
    needs = ("flow",)
    hidden_by = END_OF_FLOW
    by_drop = "always"
    family = "parallel"
    words = "seat leakage"
    clause = "the seat leaks"
    phrase = "the seat leaks (Kv {leak_kv:.2g} m3/h)"
    separated_by = "Close the valve for 60 s at two pressure drops, once with the bypass blocked off."
    damadics = "f6"
    requires = "a data sheet that gives the trim's characteristic"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        scale = chain.trim.rated
        return tuple(
            Quantity(q.name, q.unit, 0.0, 0.5 * scale, (0.005 * scale, 0.03 * scale)) for q in self.parameters
        )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value + p["leak_kv"]

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known
