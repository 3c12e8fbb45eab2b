# SPDX-License-Identifier: BSD-3-Clause
"""Liquid lost to the surroundings between valve and flow meter."""

import numpy as np

from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.mismatch.effects._defects import PRESSURES, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import ATMOSPHERE, Chain


class ExternalLeakage(Effect):
    r"""Leak to the atmosphere before the trim, behind a meter that stands upstream: it reads too much.

    .. math:: F' = F + N_1 K_{leak} \sqrt{(p_1 - p_{atm}) / \rho}

    whatever the opening. The atmosphere is taken at 101 325 Pa, the hole as turbulent.
    """

    name = key = "external_leakage"
    block, stage = "valve", "flow"
    parameters: tuple = (Quantity("leak_kv", "m3/h", 0.0, 1.0, (0.3,)),)
    needs: tuple = ("flow", "p1", "p2")
    hidden_by = hidden(PRESSURES, saturated=("p1",))
    words = "a leak to the outside"
    clause = "liquid leaks to the outside"
    phrase = "liquid leaks out before the trim (Kv {leak_kv:.2g} m3/h)"
    separated_by = (
        "Shut the valve and raise the pressures on both sides by 1 bar: a leak to the outside grows, a "
        "meter's zero and an inner leak do not."
    )
    damadics = "f5"
    requires = "a pressure above the atmosphere's that varies"
    _role, _sign = "p1", 1.0

    def _gauge(self, chain: Chain) -> np.ndarray:
        return np.maximum(getattr(chain, self._role) - ATMOSPHERE, 0.0)

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        rated = chain.trim.rated
        return (Quantity("leak_kv", "m3/h", 0.0, 0.2 * rated, (0.005 * rated, 0.03 * rated)),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        lost = FLOW_CONSTANT * p["leak_kv"] * np.sqrt(self._gauge(chain) / chain.density)
        return value + self._sign * (lost * chain.density if chain.recording.mass_flow else lost)

    def possible(self, chain: Chain) -> bool:
        # at one pressure it is a meter's zero and nothing else
        gauge = np.sqrt(self._gauge(chain))
        low, high = np.nanquantile(gauge, (0.02, 0.98))
        return bool(high > 0.0 and high - low > 0.01 * high)


class OutletLeakage(ExternalLeakage):
    r"""Leak to the atmosphere behind the trim, before a meter that stands downstream: it reads too little.

    .. math:: F' = F - N_1 K_{leak} \sqrt{(p_2 - p_{atm}) / \rho}
    """

    key = "external_leakage_outlet"
    phrase = "liquid leaks out behind the trim (Kv {leak_kv:.2g} m3/h)"
    _role, _sign = "p2", -1.0
