# SPDX-License-Identifier: BSD-3-Clause
"""A fluid that pushes the stem."""

import numpy as np

from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.mismatch.effects.spring_fault import knows_air


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
    parameters = (Quantity("load", "1", -3.0, 3.0, (0.3, -0.3, 1.0, -1.0)),)
    needs = ("command", "p1", "p2")
    source = "IEC 60534-1, force of the fluid on an unbalanced plug"
    requires = "an air supply or a spring range in the data sheet, and a pressure drop that varies"
    phrase = "the fluid pushes the stem against the air by {load:+.0%} of the spring's range at a large drop"
    separated_by = "Change the pressure drop at a fixed command and watch the stem."

    def apply(self, value, p, chain):
        drop, size = _drop(chain)
        return value | {"load": p["load"] * drop / size}

    def possible(self, chain):
        if not knows_air(chain):
            return False
        drop, size = _drop(chain)
        return bool(size > 0.0 and np.ptp(drop) > 0.02 * size)


def _drop(chain):
    drop = np.where(np.isfinite(chain.dp), chain.dp, np.nanmean(chain.dp))
    return drop, float(np.quantile(np.abs(drop), 0.95))
