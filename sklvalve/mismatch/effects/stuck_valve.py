# SPDX-License-Identifier: BSD-3-Clause
"""A stem that does not move at all."""

import numpy as np

from sklvalve.mismatch.effects._defects import REACH, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain

# a command that moves by less may stay within an ordinary friction band
_MOVES = 0.02
_OPENING = Shown("stuck at", "% opening", 100.0)


class StuckValve(Effect):
    r"""Stem seized at one opening: :math:`x = x_s` whatever the command.

    It may seize while the valve runs; without a position signal the flow at an equal pressure drop holds.
    """

    name = key = "stuck_valve"
    block, stage = "actuator", "stem"
    parameters = (Quantity("opening", "1", 0.0, 1.0, (0.5, 0.2, 0.8), null=None, shown=_OPENING),)
    needs = ("command",)
    hidden_by = hidden(REACH, compressed=("command", "opening"), frozen=("command", "opening"))
    standstill = True
    source = "plain"
    requires = "a command that moves"
    words = "a stuck stem"
    clause = "the stem is stuck"
    phrase = "the stem is stuck at {opening:.1%} opening"
    separated_by = "Step the command by 10 % both ways and watch the stem itself."

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        (opening,) = self.parameters
        seen = chain.command if chain.measured is None else chain.measured
        seen = seen[np.isfinite(seen)]
        if not len(seen):
            return self.parameters
        # what seizes stays so: the last fifth of the record, then where else it stood
        last = np.median(seen[-max(len(seen) // 5, 1) :])
        starts = tuple(float(np.clip(x, 0.0, 1.0)) for x in (last, *np.quantile(seen, (0.5, 0.15, 0.85))))
        return (Quantity(opening.name, opening.unit, opening.low, opening.high, starts, null=None),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return np.full_like(value, p["opening"])

    def possible(self, chain: Chain) -> bool:
        return bool(np.nanmax(chain.command) - np.nanmin(chain.command) > _MOVES)
