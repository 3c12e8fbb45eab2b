# SPDX-License-Identifier: BSD-3-Clause
"""Trim and seat worn where they throttle hardest."""

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW
from sklvalve.mismatch.effects._trim import beyond_trim, visited
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_REACH = Shown("reach of the wear", "% of travel", 100.0)


class Erosion(Effect):
    r"""Wear at seat and plug: capacity added that fades with the opening.

    .. math:: K_v' = K_v + K_{wear}\, e^{-x / x_0}

    It does not vanish at the seat; near the seat alone it looks like a leak, which does not fade.
    """

    name = key = "erosion"
    block, stage = "valve", "capacity"
    parameters = (
        Quantity("wear_kv", "m3/h", 0.0, 1.0, (0.3,)),
        Quantity("reach", "1", 0.02, 0.3, (0.1, 0.05), log=True, null=None, shown=_REACH),
    )
    needs = ("flow",)
    hidden_by = END_OF_FLOW
    by_drop = "always"
    words = "erosion of the trim near the seat"
    clause = "the trim is worn near the seat"
    phrase = (
        "trim and seat are worn: Kv {wear_kv:.2g} m3/h more at the seat, fading over {reach:.0%} of travel"
    )
    separated_by = (
        "Open the valve slowly from shut to 15 %, then hold it shut for 60 s: wear fades with the opening, a "
        "leak does not."
    )
    damadics = "f3"
    requires = "a data sheet that gives the trim's characteristic"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        rated = chain.trim.rated
        worn = Quantity("wear_kv", "m3/h", 0.0, 0.4 * rated, (0.02 * rated, 0.08 * rated))
        return (worn, self.parameters[1])

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value + p["wear_kv"] * np.exp(-chain.plug / p["reach"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        x, phi = visited(chain)
        added = p["wear_kv"] * np.exp(-x / p["reach"]) / chain.trim.rated
        return late or beyond_trim(added / np.maximum(phi, 1e-6), phi, tolerance)

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known
