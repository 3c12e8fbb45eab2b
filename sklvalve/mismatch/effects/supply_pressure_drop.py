# SPDX-License-Identifier: BSD-3-Clause
"""Air supply too low."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import REACH
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_DROP = Shown("loss of supply pressure", "%", 100.0)


class SupplyPressureDrop(Effect):
    r"""Supply of gauge pressure (1 - d) p_s: travel driven by air ends where the spring balances it.

    .. math:: x_{max} = ((1 - d) p_s - p_{low}) / (p_{high} - p_{low})

    Filling is slow near that end; venting is as before. A stem that stands higher comes down to that end: its
    air goes back through the open spool.
    """

    name = key = "supply_pressure_drop"
    block, stage = "actuator", "actuator"
    parameters = (Quantity("drop", "1", 0.1, 0.97, (0.8, 0.87, 0.72), shown=_DROP),)
    needs = ("command",)
    hidden_by = REACH
    by_drop = "unseen"
    words = "low air supply pressure"
    clause = "the air supply pressure is too low"
    phrase = "the air supply is {drop:.0%} below its rated pressure"
    separated_by = (
        "Stroke the valve fully both ways: low supply ends the air-driven travel early "
        "and slows filling only."
    )
    damadics = "f16"

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        atmosphere = 101_325.0 / chain.spring_span
        low = atmosphere + (1.0 - p["drop"]) * (chain.supply - atmosphere)
        return value | {"supply": np.full_like(value["supply"], low)}

    def possible(self, chain: Chain) -> bool:
        # an actuator of which no supply is known may be an electric one
        return chain.valve.supply_pressure is not None

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        if late:
            # what falls while the valve runs is no matter of the sheet
            return True
        # a supply that still carries the whole travel changes the response only
        atmosphere = 101_325.0 / chain.spring_span
        reach = atmosphere + (1.0 - p["drop"]) * (chain.supply - atmosphere) - chain.spring
        return reach < 1.05
