# SPDX-License-Identifier: BSD-3-Clause
"""Capacity that stops rising with the opening, or a plug that something keeps from closing."""

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain

_BLOCKED = Shown("blocked at", "% opening", 100.0)


class Clogging(Effect):
    r"""Blocked passage: from an opening on the capacity stays, :math:`K_v' = \min(K_v, K_v(x_c))`."""

    name = key = "clogging"
    block, stage = "valve", "capacity"
    parameters: tuple = (Quantity("limit", "1", 0.03, 0.99, (0.9, 0.7, 0.45), null=None, shown=_BLOCKED),)
    needs: tuple = ("flow",)
    hidden_by = END_OF_FLOW
    by_drop = "always"
    words = "clogging that caps the opening"
    clause = "clogging limits the opening"
    phrase = "the passage is blocked above {limit:.0%} opening"
    separated_by = (
        "Open the valve slowly to 100 %: a blockage has a sharp corner, a line loss bends smoothly."
    )
    requires = "a data sheet that gives the trim's characteristic"
    # a limit has no slope where no row is beyond it: shares of the rows that it begins by leaving alone
    _left_alone: tuple = (0.995, 0.97, 0.85, 0.5)

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        (limit,) = self.parameters
        opening = chain.command if chain.measured is None else chain.measured
        starts = np.nanquantile(opening, self._left_alone)
        starts = tuple(float(v) for v in np.clip(starts, limit.low + 1e-3, limit.high - 1e-3))
        return (Quantity("limit", "1", limit.low, limit.high, starts, null=None),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return np.minimum(value, chain.capacity_at(p["limit"]))

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known


class ClosingBlocked(Clogging):
    r"""Something between plug and seat: the stem stops before the valve is shut, :math:`x' = \max(x, x_c)`.

    The recorded opening shows it; the flow follows the opening as ever. The positioner lets out the air of a
    stem that it wants to shut, and has to fill the chamber again before that leaves the stop.
    """

    key = "clogging_closing"
    stage = "stem"
    parameters = (Quantity("limit", "1", 0.01, 0.95, (0.08, 0.25, 0.5), null=None, shown=_BLOCKED),)
    needs = ("command",)
    by_drop = "unseen"
    phrase = "something keeps the plug from closing below {limit:.0%} opening"
    separated_by = "Close the valve slowly and open it by hand wheel: the stem stops at one place, both ways."
    damadics = "f1"
    requires = "commands below 95 % opening"
    _left_alone = (0.005, 0.03, 0.15, 0.5)
    stops_stem = True

    def lowest(self, p: dict[str, float]) -> float:
        return p["limit"]

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return np.maximum(value, p["limit"])

    def possible(self, chain: Chain) -> bool:
        return bool(np.nanquantile(chain.command, 0.05) < 0.95)
