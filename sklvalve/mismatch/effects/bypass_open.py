# SPDX-License-Identifier: BSD-3-Clause
"""Flow beside the valve, through a bypass that is not shut."""

import numpy as np

from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.seat_leakage import SeatLeakage
from sklvalve.simulation.chain import Chain


class BypassOpen(SeatLeakage):
    r"""Open bypass: the same equation as a leak, :math:`K_v' = K_v + K_{bypass}`, so no signal of the valve
    tells the two apart."""

    name = key = "bypass_open"
    parameters = (Quantity("bypass_kv", "m3/h", 0.0, 1.0, (0.3,)),)
    words = "an open bypass"
    clause = "a bypass is open"
    phrase = "a bypass is open (Kv {bypass_kv:.2g} m3/h)"
    damadics = "f18"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value + p["bypass_kv"]
