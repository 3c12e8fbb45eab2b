# SPDX-License-Identifier: BSD-3-Clause
"""Play, between the stem's sensor and the plug or in the linkage before the sensor."""

from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.stages import play


class Backlash(Effect):
    r"""Play between the stem, where its position is taken, and the plug.

    .. math:: x_{plug}(t) = \min(\max(x_{plug}(t^-), x - w/2), x + w/2)

    It shows in the flow only, as a constant shift of opening by direction of travel; without jumps, and
    whatever the rate.
    """

    name = key = "backlash"
    block, stage = "valve", "plug"
    parameters = (Quantity("width", "1", 0.002, 0.4, (0.015, 0.05), log=True),)
    needs: tuple = ("flow",)
    family = "play"
    phrase = "there is play between stem and plug of {width:.1%} of travel"
    separated_by = (
        "Step the command up and down by 1, 2 and 5 % at a slow and at a fast rate: play is the same."
    )
    damadics = "f4"

    def apply(self, value, p, chain):
        return play(value, p["width"])

    def beyond_tolerance(self, p, chain, tolerance, late):
        return p["width"] > tolerance.static_error


class LinkageBacklash(Backlash):
    """Play in the linkage between actuator and position sensor: the recorded opening itself shows it."""

    key = "backlash_linkage"
    block, stage = "actuator", "stem"
    needs = ("command", "opening")
    phrase = "there is play of {width:.1%} of travel between actuator and stem"

    def possible(self, chain):
        return chain.measured is not None
