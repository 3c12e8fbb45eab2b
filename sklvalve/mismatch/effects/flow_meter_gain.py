# SPDX-License-Identifier: BSD-3-Clause
"""A flow meter whose span is wrong."""

import numpy as np

from sklvalve.mismatch.effects._shown import DEVIATION
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class FlowMeterGain(Effect):
    r"""Recorded flow is off in proportion: :math:`F' = (1 + g) F`."""

    name = key = "flow_meter_gain"
    block, stage = "measurement", "flow_meter"
    parameters = (Quantity("gain", "1", -0.9, 2.0, (0.1, -0.1), shown=DEVIATION),)
    needs = ("flow",)
    by_drop = "always"
    family = "gain"
    words = "a wrong span of the flow meter"
    clause = "the flow meter's span is wrong"
    phrase = "the flow reads {gain:+.0%} off"
    separated_by = (
        "A second meter, or a known volume: no signal of the valve tells a meter's span from capacity."
    )
    damadics = "f19"
    requires = "a data sheet that gives the trim's characteristic"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * (1.0 + p["gain"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return late or abs(p["gain"]) > tolerance.capacity

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known
