# SPDX-License-Identifier: BSD-3-Clause
"""A command that arrives late."""

import numpy as np

from sklvalve.mismatch.effects._defects import MOVES, hidden
from sklvalve.mismatch.effects._response import slowest
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.stages import delayed
from sklvalve.simulation.tolerance import Tolerance

# as many scans may lie between a command and its effect
_SCANS = 2.0


class DeadTime(Effect):
    r"""Delay of the command: :math:`u'(t) = u(t - \theta)`, the same for steps of every size.

    Air that fills an actuator may pass for a delay of up to its response time. A motor has no such excuse:
    what its recording shows beyond a few scans is one.
    """

    name = key = "dead_time"
    kind, declared_as = "property", "dead_time"
    block, stage = "actuator", "signal"
    parameters = (Quantity("delay", "s", 0.05, 120.0, (4.0, 12.0), log=True, declared=float),)
    needs = ("command",)
    hidden_by = hidden(MOVES, frozen=("command",))
    words = "a dead time between command and stem"
    clause = "the stem answers its command after a dead time"
    phrase = "the valve answers {delay:.2g} s later than its simulation"
    separated_by = (
        "Steps of three sizes: a dead time is the same for all, a slew limit grows with the step. "
        "Compare clocks, too: where no controller answers the flow, a command stamped early looks the same."
    )

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        (delay,) = self.parameters
        scan = chain.recording.sample_time
        # at a fast sampling shorter ones can be seen
        starts = delay.starts if scan > 0.5 else (3.0 * scan, 10.0 * scan, *delay.starts)
        return (Quantity("delay", "s", delay.low if scan < 0.1 else 0.2, delay.high, starts, log=True),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return delayed(value, chain.time, p["delay"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # beyond what is declared, and the calibration has taken up as far as it may
        allowed = tolerance.declared * (chain.valve.dead_time or 0.0)
        if chain.electric:
            return p["delay"] > allowed + _SCANS * chain.recording.sample_time
        return p["delay"] > allowed + slowest(chain, tolerance, late)
