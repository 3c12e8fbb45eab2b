# SPDX-License-Identifier: BSD-3-Clause
"""A stem that travels no faster than a limit."""

from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.stages import limited_rate


class SlewLimit(Effect):
    r"""Travel at a limited speed, of its own in each direction: :math:`-v_{close} \le \dot x \le v_{open}`.

    Electric actuators run at one speed; pneumatic ones do where little air passes.
    """

    name = key = "slew_limit"
    block, stage = "actuator", "signal"
    parameters = (
        Quantity("speed", "1/s", 0.001, 1.0, (0.1, 0.02), log=True),
        Quantity("closing_ratio", "1", 0.25, 4.0, (1.0,), log=True),
    )
    needs = ("command",)
    phrase = (
        "the stem opens at {speed:.1%} of travel a second at most (closing {closing_ratio:.2g} times that)"
    )
    separated_by = (
        "Steps of three sizes: a slew limit takes longer the larger the step, a dead time does not."
    )

    def apply(self, value, p, chain):
        return limited_rate(value, chain.step, p["speed"], p["speed"] * p["closing_ratio"])

    def beyond_tolerance(self, p, chain, tolerance, late):
        # positioner and actuator each may take their response time for a stroke
        return p["speed"] * min(p["closing_ratio"], 1.0) < 0.5 / tolerance.response
