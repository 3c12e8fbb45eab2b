# SPDX-License-Identifier: BSD-3-Clause
"""Friction that gives way elastically before the stem slides."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import STICKS
from sklvalve.mismatch.effects._shown import FRICTION
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.friction import most_friction
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_REACH = Shown("give before it slides", "% of travel", 100.0)


class Presliding(Effect):
    r"""Soft packing: friction builds up along a reach of travel, and gives part of it back.

    .. math:: F_f = \sigma_0 z, \quad \dot z = \dot x - |\dot x|\, \sigma_0 z / F_c, \quad \sigma_0 = F_c / r

    After a reversal the friction has turned by :math:`1 - e^{-1}` of its way within the reach :math:`r` of
    travel: smooth small loops within what would else be a stick band (Dahl's model, half of LuGre's).
    """

    name = key = "presliding"
    # every packing gives way a little; one that gives way much is worn or too tight
    kind = "either"
    alike = "play"
    block, stage = "actuator", "actuator"
    parameters = (
        Quantity("friction", "1", 0.02, 1.5, (0.1, 0.2, 0.3), log=True, shown=FRICTION),
        Quantity("reach", "1", 0.002, 0.2, (0.01, 0.03, 0.01), log=True, null=None, shown=_REACH),
    )
    needs = ("command",)
    hidden_by = STICKS
    source = "Canudas de Wit et al., A new model for control of systems with friction, IEEE TAC 40 (1995)"
    words = "give of the packing before it slides"
    clause = "the packing gives before it slides"
    phrase = (
        "the packing gives way before the stem slides (over {reach:.1%} of travel, friction "
        "{friction:.0%} of the spring's range)"
    )
    separated_by = (
        "Sine waves of the command of growing size, below the size at which the stem slides: "
        "the loops of soft friction grow with the size, those of play vanish below its width."
    )

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        friction = np.maximum(value["coulomb"], p["friction"])
        return value | {"coulomb": friction, "bristle": p["friction"] / p["reach"]}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["friction"] > most_friction(tolerance)
