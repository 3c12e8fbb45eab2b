# SPDX-License-Identifier: BSD-3-Clause
"""A fluid that pushes the stem."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import PRESSURES, REACH, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.spring_fault import knows_air
from sklvalve.simulation.chain import Chain

_LOAD = Shown("force at a large drop", "% of the spring range", 100.0)


class StemLoad(Effect):
    r"""Force of the pressure drop on plug and stem.

    .. math:: F = L\, \Delta p / \Delta p_{95}, \quad L = A_s\, \Delta p_{95} / (A_e\, \Delta p_{spring})

    in travels of the spring; :math:`A_s` is the unbalanced area of the plug, :math:`A_e` the diaphragm's. It
    moves a stem whose positioner is weak, and ends its travel early. Positive where it works against the air.
    """

    name = key = "stem_load"
    # an unbalanced plug, or an actuator too weak for it
    kind = "either"
    block, stage = "actuator", "actuator"
    parameters = (Quantity("load", "1", -3.0, 3.0, (0.3, -0.3, 1.0, -1.0), shown=_LOAD),)
    needs = ("command", "p1", "p2")
    hidden_by = hidden(REACH, PRESSURES)
    source = "IEC 60534-1, force of the fluid on an unbalanced plug"
    requires = "an air supply or a spring range in the data sheet, and a pressure drop that varies"
    words = "a flow force that shifts the stem"
    clause = "the flow's force shifts the stem"
    phrase = "the fluid pushes the stem against the air by {load:+.0%} of the spring's range at a large drop"
    separated_by = "Change the pressure drop at a fixed command and watch the stem."

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        drop, size = _drop(chain)
        return value | {"load": p["load"] * drop / size}

    def possible(self, chain: Chain) -> bool:
        if not knows_air(chain):
            return False
        drop, size = _drop(chain)
        return bool(size > 0.0 and np.ptp(drop) > 0.02 * size)


def _drop(chain: Chain) -> tuple[np.ndarray, float]:
    drop = np.where(np.isfinite(chain.dp), chain.dp, np.nanmean(chain.dp))
    return drop, float(np.quantile(np.abs(drop), 0.95))
