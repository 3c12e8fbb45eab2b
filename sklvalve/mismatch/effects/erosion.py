# SPDX-License-Identifier: BSD-3-Clause
"""Trim and seat worn where they throttle hardest."""

import numpy as np

from sklvalve.mismatch.effects._trim import beyond_trim, visited
from sklvalve.mismatch.effects.base import Effect, Quantity


class Erosion(Effect):
    r"""Wear at seat and plug: capacity added that fades with the opening.

    .. math:: K_v' = K_v + K_{wear}\, e^{-x / x_0}

    It does not vanish at the seat; near the seat alone it looks like a leak, which does not fade.
    """

    name = key = "erosion"
    block, stage = "valve", "capacity"
    parameters = (
        Quantity("wear_kv", "m3/h", 0.0, 1.0, (0.3,)),
        Quantity("reach", "1", 0.02, 0.3, (0.1, 0.05), log=True, null=None),
    )
    needs = ("flow",)
    phrase = (
        "trim and seat are worn: Kv {wear_kv:.2g} m3/h more at the seat, fading over {reach:.0%} of travel"
    )
    separated_by = (
        "Open the valve slowly from shut to 15 %, then hold it shut for 60 s: wear fades with the opening, a "
        "leak does not."
    )
    damadics = "f3"
    requires = "a data sheet that gives the trim's characteristic"

    def quantities(self, chain):
        rated = chain.trim.rated
        worn = Quantity("wear_kv", "m3/h", 0.0, 0.4 * rated, (0.02 * rated, 0.08 * rated))
        return (worn, self.parameters[1])

    def apply(self, value, p, chain):
        return value + p["wear_kv"] * np.exp(-chain.plug / p["reach"])

    def beyond_tolerance(self, p, chain, tolerance, late):
        x, phi = visited(chain)
        added = p["wear_kv"] * np.exp(-x / p["reach"]) / chain.trim.rated
        return late or beyond_trim(added / np.maximum(phi, 1e-6), phi, tolerance)

    def possible(self, chain):
        # a trim learnt from this very recording would take it up
        return chain.trim.known
