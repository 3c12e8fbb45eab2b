# SPDX-License-Identifier: BSD-3-Clause
"""Capacity that stops rising with the opening."""

import numpy as np

from sklvalve.mismatch.effects.base import Effect, Quantity


class Clogging(Effect):
    r"""Blocked passage: from an opening on the capacity stays, :math:`K_v' = \min(K_v, K_v(x_c))`."""

    name = key = "clogging"
    block, stage = "valve", "capacity"
    parameters = (Quantity("limit", "1", 0.03, 0.99, (0.9, 0.7, 0.45)),)
    needs = ("flow",)
    phrase = "the passage is blocked above {limit:.0%} opening"
    separated_by = (
        "Open the valve slowly to 100 %: a blockage has a sharp corner, a line loss bends smoothly."
    )
    damadics = "f1"

    def apply(self, value, p, chain):
        return np.minimum(value, chain.capacity_at(p["limit"]))

    def possible(self, chain):
        # a trim learnt from this very recording would take it up
        return chain.trim.known
