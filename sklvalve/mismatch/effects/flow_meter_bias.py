# SPDX-License-Identifier: BSD-3-Clause
"""A flow meter whose zero is wrong."""

from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.calibration import span_of


class FlowMeterBias(Effect):
    r"""Recorded flow is off by a constant: :math:`F' = F + b`."""

    name = key = "flow_meter_bias"
    block, stage = "measurement", "flow_meter"
    parameters = (Quantity("bias", "m3/s", -1.0, 1.0, (0.01, -0.01)),)
    needs = ("flow",)
    phrase = "the flow meter's zero is off"
    separated_by = "Shut the block valves and read the meter at zero flow."
    damadics = "f19"

    def quantities(self, chain):
        span = span_of(chain.recording["flow"])
        unit = "kg/s" if chain.recording.mass_flow else "m3/s"
        return (Quantity("bias", unit, -span, span, (0.02 * span, -0.02 * span)),)

    def apply(self, value, p, chain):
        return value + p["bias"]

    def beyond_tolerance(self, p, chain, tolerance, late):
        span = span_of(chain.recording["flow"])
        return abs(p["bias"]) > tolerance.flow_zero * span
