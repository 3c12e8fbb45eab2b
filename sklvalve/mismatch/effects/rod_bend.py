# SPDX-License-Identifier: BSD-3-Clause
"""A stem that is bent or twisted."""

from typing import Any

from sklvalve.mismatch.effects._defects import MOVES, hidden
from sklvalve.mismatch.effects._events import ByHunting
from sklvalve.mismatch.effects._shown import FRICTION
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.friction import most_friction
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_BEND = Shown("begins at", "% opening", 100.0)


class RodBend(Effect):
    r"""Side load that grows towards the open end: friction in one part of the travel only.

    .. math:: F_f(x) = F_c + F_b \max\left(0, \frac{x - x_b}{1 - x_b}\right)

    in travels of the spring. Below :math:`x_b` the stem is sound.
    """

    name = key = "rod_bend"
    alike = "play"
    block, stage = "actuator", "actuator"
    parameters = (
        Quantity("friction", "1", 0.02, 2.0, (0.2, 0.5, 0.5), log=True, shown=FRICTION),
        Quantity("begins", "1", 0.0, 0.95, (0.3, 0.6, 0.1), null=None, shown=_BEND),
    )
    needs = ("command",)
    hidden_by = hidden(MOVES, saturated=("opening",))
    source = "friction in proportion to the side load of a bent beam"
    words = "a bent or twisted stem"
    clause = "the stem is bent or twisted"
    phrase = (
        "the stem is bent (above {begins:.0%} opening friction grows to {friction:.0%} of the spring's range)"
    )
    separated_by = (
        "A slow full stroke both ways: the way round is wider in one part of the travel for a bent rod, "
        "everywhere for a tight packing."
    )
    damadics = "f8"

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        slope, begins = p["friction"] / (1.0 - p["begins"]), p["begins"]
        return value | self._as_air_drives(slope, begins, chain)

    @staticmethod
    def _as_air_drives(slope: float, begins: float, chain: Chain) -> dict[str, float]:
        # a valve that air closes is seen from its other end
        return (
            {"rod": -slope, "rod_from": 1.0 - begins}
            if chain.air_closes
            else {"rod": slope, "rod_from": begins}
        )

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["friction"] > most_friction(tolerance)


class RodBendShut(RodBend):
    r"""Side load that grows towards the seat: :math:`F_b \max(0, (x_b - x) / x_b)`."""

    key = "rod_bend_shut"
    parameters = (
        Quantity("friction", "1", 0.02, 2.0, (0.2, 0.5, 0.5), log=True, shown=FRICTION),
        Quantity("begins", "1", 0.05, 1.0, (0.7, 0.4, 0.9), null=None, shown=_BEND),
    )
    phrase = (
        "the stem is bent (below {begins:.0%} opening friction grows to {friction:.0%} of the spring's range)"
    )

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | self._as_air_drives(-p["friction"] / p["begins"], p["begins"], chain)


class RodBendByHunting(ByHunting, RodBend):
    """A bent stem told by its hunting: where it rubs, its positioner overshoots what breaks it away."""

    key = "rod_bend_hunting"
    phrase = (
        "the stem is bent and rubs, and hunts by {swing:.1%} of travel while its command rests; "
        "its swings are not predicted"
    )
