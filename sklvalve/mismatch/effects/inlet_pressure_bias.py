# SPDX-License-Identifier: BSD-3-Clause
"""An inlet pressure sensor that reads off by a constant, or stands at another height than the valve."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import PRESSURES, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.calibration import span_of
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

# two metres of water between sensor and valve [Pa]
_HEAD = 2e4


class InletPressureBias(Effect):
    r"""Recorded inlet pressure is off by b: the flow is driven by :math:`p_1 - b - p_2`, and chokes by
    :math:`p_1 - b - F_F p_v`.

    So it is where a sensor, or the tank whose level is taken for a pressure, stands higher than the valve.
    """

    name = key = "inlet_pressure_bias"
    block, stage = "measurement", "pressures"
    parameters = (Quantity("bias", "Pa", -1e5, 1e5, (1e3,)),)
    needs = ("flow", "p1", "p2")
    hidden_by = hidden(PRESSURES, saturated=("p1",))
    family = "pressure"
    words = "a shifted zero of the inlet pressure sensor"
    clause = "the inlet pressure sensor's zero has shifted"
    phrase = "the recorded pressures are off by {bias:+.3g} {pressure_unit} against the drop over the valve"
    separated_by = "Equalise the pressures over the closed valve and compare the two sensors."
    damadics = "f14"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        size = float(np.nanquantile(np.abs(chain.dp), 0.95))
        starts = (0.1 * size, -0.1 * size)
        # off by more than the drop it is no sensor any more, but it may stand metres above the valve
        return (Quantity("bias", "Pa", -max(0.9 * size, _HEAD), 0.9 * size, starts),)

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | {"p1": value["p1"] - p["bias"]}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        span = span_of(chain.p1)
        return late or abs(p["bias"]) > 2.0 * tolerance.pressure_zero * span
