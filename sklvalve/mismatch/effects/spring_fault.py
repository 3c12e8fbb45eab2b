# SPDX-License-Identifier: BSD-3-Clause
"""An actuator's spring that is not the sheet's."""

from typing import Any

from sklvalve.mismatch.effects._defects import REACH
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.friction import most_friction
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_SPRING_FORCE = Shown("force of the spring", "% of the sheet's", 100.0)


class SpringFault(Effect):
    r"""Spring weaker or stronger than its range says, or one that hardens along the travel.

    .. math:: F = s\,(F_0 + x) + k_3 x^3

    in travels of the sheet's spring, :math:`F_0` its preload. The positioner makes up for it while it has
    air: it shows where the air ends, in how long strokes take one way and the other, and in the last of the
    way home.
    """

    name = key = "spring_fault"
    block, stage = "actuator", "actuator"
    parameters = (
        Quantity("strength", "1", 0.02, 3.0, (0.6, 1.5, 0.15), log=True, null=1.0, shown=_SPRING_FORCE),
        Quantity("hardening", "1", -0.3, 2.0, (0.0,), silent=True),
    )
    needs = ("command",)
    hidden_by = REACH
    by_drop = "unseen"
    source = "force balance of a spring and diaphragm actuator, IEC 60534-4 bench range"
    requires = "an air supply or a spring range in the data sheet"
    words = "a faulty actuator spring"
    clause = "the actuator's spring is faulty"
    phrase = "the actuator's spring has {strength:.0%} of its sheet's force"
    separated_by = (
        "Stroke the valve fully both ways with the actuator's pressure recorded: "
        "the spring's range is the line of pressure over travel."
    )
    damadics = "f11"

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        excess = p["strength"] - 1.0
        return value | {
            "preload": excess * (chain.spring - chain.atmosphere),
            "stiffness": excess,
            "hardening": p["hardening"],
        }

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # a spring that the air still carries through, and that still brings the stem home, changes the
        # response only
        left = chain.supply - chain.spring
        extra_force = (p["strength"] - 1.0) * (chain.spring - chain.atmosphere + 1.0) + p["hardening"]
        home = p["strength"] * (chain.spring - chain.atmosphere)
        return late or left - extra_force < 1.05 or home < most_friction(tolerance)

    def possible(self, chain: Chain) -> bool:
        return knows_air(chain)


def knows_air(chain: Chain) -> bool:
    """Whether the sheet says what air and spring the actuator has: without them its forces have no scale."""
    return chain.valve.supply_pressure is not None or chain.valve.spring_range is not None
