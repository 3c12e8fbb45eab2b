# SPDX-License-Identifier: BSD-3-Clause
"""An outlet pressure sensor that reads off by a constant."""

from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.inlet_pressure_bias import InletPressureBias


class OutletPressureBias(InletPressureBias):
    r"""Recorded outlet pressure is off by b: the drop that drives the flow is :math:`p_1 - p_2 + b`.

    Without choking no signal tells it from a bias of the inlet's sensor.
    """

    name = key = "outlet_pressure_bias"

    def quantities(self, chain):
        (inlet,) = super().quantities(chain)
        return (Quantity("bias", "Pa", -inlet.high, -inlet.low, tuple(-s for s in inlet.starts)),)

    def apply(self, value, p, chain):
        return value | {"p2": value["p2"] - p["bias"]}
