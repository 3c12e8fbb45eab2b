# SPDX-License-Identifier: BSD-3-Clause
"""A command that arrives late."""

from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.stages import delayed


class DeadTime(Effect):
    r"""Delay of the command: :math:`u'(t) = u(t - \theta)`, the same for steps of every size."""

    name = key = "dead_time"
    block, stage = "actuator", "signal"
    parameters = (Quantity("delay", "s", 0.2, 120.0, (4.0, 12.0), log=True),)
    needs = ("command",)
    phrase = "the valve answers {delay:.1f} s after the command"
    separated_by = "Steps of three sizes: a dead time is the same for all, a slew limit grows with the step."

    def apply(self, value, p, chain):
        return delayed(value, chain.time, p["delay"])

    def beyond_tolerance(self, p, chain, tolerance, late):
        return p["delay"] > tolerance.response
