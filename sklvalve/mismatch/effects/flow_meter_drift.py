# SPDX-License-Identifier: BSD-3-Clause
"""A flow meter that drifts: its zero, or its span."""

import numpy as np

from sklvalve.mismatch.effects._growth import hours_left, hours_since
from sklvalve.mismatch.effects._shown import RATE
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.calibration import span_of
from sklvalve.simulation.chain import Chain


class FlowMeterDrift(Effect):
    r"""Recorded flow is off by what grows with time: :math:`F' = F + d\,(t - t_0)`.

    :math:`t_0` is its onset, or the first row of the recording. Unlike deposits it also shows where the valve
    is shut.
    """

    name = key = "flow_meter_drift"
    block, stage = "measurement", "flow_meter"
    parameters = (Quantity("drift", "m3/s/h", -1.0, 1.0, (0.01, -0.01)),)
    needs = ("flow",)
    by_drop = "always"
    grows = True
    words = "a drift of the flow meter"
    clause = "the flow meter drifts"
    phrase = "the flow meter's zero drifts"
    separated_by = "Shut the block valves and read the meter at zero flow, now and some hours later."
    damadics = "f19"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        share = span_of(chain.recording["flow"]) / hours_left(self, chain)
        unit = "kg/s/h" if chain.recording.mass_flow else "m3/s/h"
        starts = (0.03 * share, -0.03 * share)
        return (Quantity("drift", unit, -0.5 * share, 0.5 * share, starts),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value + p["drift"] * hours_since(self, chain)


class FlowMeterSpanDrift(FlowMeterDrift):
    r"""Recorded flow is off by a share that grows with time: :math:`F' = F\,(1 + g\,(t - t_0))`.

    The equation of deposits that grow, of either sign.
    """

    key = "flow_meter_drift_span"
    parameters = (Quantity("rate", "1/h", -10.0, 10.0, (0.1, -0.1), shown=RATE),)
    family = "growth"
    phrase = "the flow meter's span drifts by {rate:+.1%} an hour"
    separated_by = (
        "Check the meter against a second one: a recording of the valve alone shows the same for deposits."
    )

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        hours = hours_left(self, chain)
        return (Quantity("rate", "1/h", -0.8 / hours, 1.5 / hours, (0.05 / hours, -0.05 / hours)),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * np.maximum(1.0 + p["rate"] * hours_since(self, chain), 0.2)
