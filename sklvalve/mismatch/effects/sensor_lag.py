# SPDX-License-Identifier: BSD-3-Clause
"""A flow signal that is damped by more than a meter's own response."""

import numpy as np

from sklvalve.mismatch.effects._defects import FOLLOWING, hidden
from sklvalve.mismatch.effects._response import slowest
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.stages import first_order_lag
from sklvalve.simulation.tolerance import Tolerance


class SensorLag(Effect):
    r"""Damping of the recorded flow: :math:`\tau \dot F' = F - F'`, behind the meter's own response.

    A calibrated meter answers within 3 s; this is what is slower. It is told from the inertia of the liquid
    by being the same at every flow and drop. Damping of a position signal is not among the effects: no signal
    tells it from a slow actuator.
    """

    name = key = "sensor_lag"
    kind = "property"
    block, stage = "measurement", "flow_meter"
    parameters = (Quantity("lag", "s", 1.0, 600.0, (6.0, 25.0), log=True),)
    needs = ("flow",)
    hidden_by = hidden(FOLLOWING, frozen=("flow",))
    by_drop = "always"
    words = "a slow sensor"
    clause = "a sensor is slow"
    phrase = "the flow signal is damped by {lag:.1f} s"
    separated_by = (
        "Fast steps at two pressure drops: damping takes the same time at both, inertia less at the larger "
        "drop."
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        # when within a sample a step came, the meter's own response knows already
        return first_order_lag(value, chain.step, p["lag"], 1.0)

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["lag"] > slowest(chain, tolerance, late)
