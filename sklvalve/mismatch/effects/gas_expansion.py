# SPDX-License-Identifier: BSD-3-Clause
"""A gas that expands in the valve."""

import numpy as np

from sklvalve.mismatch.effects._defects import PRESSURES, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain

_GAS = ("molar_mass", "heat_capacity_ratio", "compressibility")
_DIATOMIC = 1.4


class GasExpansion(Effect):
    r"""Expansion of a gas, for a simulation that computes it like a liquid of the inlet's density.

    .. math:: K_v' = K_v\, Y \sqrt{\min(x, x_c) / x}, \quad Y = 1 - \frac{\min(x, x_c)}{3 x_c}, \quad
              x = \frac{\Delta p}{p_1}, \quad x_c = \frac{\gamma}{1.4}\, x_T

    A residual of the pressure drop ratio alone; choked from :math:`x_c` on, with :math:`Y = 2/3`.
    """

    name = key = "gas_expansion"
    kind, fluid = "property", "gas"
    block, stage = "valve", "capacity"
    parameters = (Quantity("xt", "1", 0.15, 0.9, (0.7, 0.4), null=None, shown=Shown("x_T")),)
    needs = ("flow", "p1", "p2")
    hidden_by = hidden(PRESSURES, saturated=("p1", "p2"))
    words = "expansion of the gas"
    clause = "the gas expands in the valve"
    phrase = "the gas expands in the valve (x_T about {xt:.2f})"
    separated_by = (
        "Lower the outlet pressure at a fixed opening, from a small drop to half the inlet pressure."
    )
    source = "IEC 60534-2-1"
    requires = "a gas"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        gamma = chain.valve.fluid.get("heat_capacity_ratio", _DIATOMIC)
        choked = p["xt"] * gamma / _DIATOMIC
        with np.errstate(divide="ignore", invalid="ignore"):
            x = np.where(chain.p1 > 0.0, np.abs(chain.dp) / chain.p1, 0.0)
            root = np.sqrt(np.where(x > choked, choked / x, 1.0))
        return value * (1.0 - np.minimum(x / choked, 1.0) / 3.0) * root

    def possible(self, chain: Chain) -> bool:
        return any(datum in chain.valve.fluid for datum in _GAS)
