# SPDX-License-Identifier: BSD-3-Clause
"""Flow that no longer follows the outlet pressure."""

from typing import Any

import numpy as np

from sklvalve.mechanism import at_travel
from sklvalve.mismatch.effects._defects import PRESSURES, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class ChokedFlow(Effect):
    r"""Choking, or choking earlier than the sheet's F_L says.

    .. math:: \Delta p_{eff} = \min(\Delta p,\; F_L^2 (p_1 - F_F p_v))

    with a rounded corner, as real valves have it. IEC 60534-2-1.
    """

    name = key = "choked_flow"
    kind, fluid = "property", "liquid"
    block, stage = "valve", "choking"
    parameters = (
        Quantity("fl", "1", 0.25, 0.99, (0.85, 0.65, 0.5), null=None, shown=Shown("F_L")),
        Quantity("knee", "1", 3.0, 40.0, (12.0,), log=True, null=None, shown=Shown("sharpness of the knee")),
        Quantity("slope", "1", 0.0, 0.25, (0.05,), null=None, silent=True),
    )
    needs = ("flow", "p1", "p2")
    hidden_by = hidden(PRESSURES, saturated=("flow", "p2"))
    words = "choked flow"
    clause = "the flow chokes"
    phrase = "the flow chokes (F_L about {fl:.2f})"
    separated_by = "Lower the outlet pressure at a fixed opening through the knee: choked flow stops rising."
    damadics = "f7"
    source = "IEC 60534-2-1"
    requires = "the liquid's vapour pressure"

    def possible(self, chain: Chain) -> bool:
        return chain.margin is not None

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        n = len(chain.time)
        # F_L falls with travel; `fl` is its value half open
        fl = p["fl"] * (1.0 - p["slope"] * (chain.plug - 0.5))
        return {"fl": fl, "knee": np.full(n, p["knee"])}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # F_L belongs to the trim: one that the simulation holds must be off by more than a sheet may be
        if late or not chain.choking:
            return True
        sheet = chain.valve.fl
        typical = float(np.mean(at_travel(sheet, np.linspace(0.1, 1.0, 10)))) if sheet is not None else 0.9
        return abs(p["fl"] / typical - 1.0) > tolerance.recovery
