# SPDX-License-Identifier: BSD-3-Clause
"""A flow meter whose zero is wrong."""

import numpy as np

from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.calibration import span_of
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class FlowMeterBias(Effect):
    r"""Recorded flow is off by a constant: :math:`F' = F + b`."""

    name = key = "flow_meter_bias"
    block, stage = "measurement", "flow_meter"
    parameters = (Quantity("bias", "m3/s", -1.0, 1.0, (0.01, -0.01)),)
    needs = ("flow",)
    by_drop = "always"
    words = "a shifted zero of the flow meter"
    clause = "the flow meter's zero has shifted"
    phrase = "the flow meter's zero is off"
    separated_by = "Shut the block valves and read the meter at zero flow."
    damadics = "f19"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        span = span_of(chain.recording["flow"])
        unit = "kg/s" if chain.recording.mass_flow else "m3/s"
        return (Quantity("bias", unit, -span, span, (0.02 * span, -0.02 * span)),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value + p["bias"]

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        span = span_of(chain.recording["flow"])
        return late or abs(p["bias"]) > tolerance.flow_zero * span
