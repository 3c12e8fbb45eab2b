# SPDX-License-Identifier: BSD-3-Clause
"""An outlet pressure sensor that reads off by a constant."""

from typing import Any

from sklvalve.mismatch.effects._defects import PRESSURES, hidden
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.inlet_pressure_bias import InletPressureBias
from sklvalve.simulation.chain import Chain


class OutletPressureBias(InletPressureBias):
    r"""Recorded outlet pressure is off by b: the drop that drives the flow is :math:`p_1 - p_2 + b`.

    Without choking no signal tells it from a bias of the inlet's sensor.
    """

    name = key = "outlet_pressure_bias"
    hidden_by = hidden(PRESSURES, saturated=("p2",))
    words = "a shifted zero of the outlet pressure sensor"
    clause = "the outlet pressure sensor's zero has shifted"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        (inlet,) = super().quantities(chain)
        return (Quantity("bias", "Pa", -inlet.high, -inlet.low, tuple(-s for s in inlet.starts)),)

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | {"p2": value["p2"] - p["bias"]}
