# SPDX-License-Identifier: BSD-3-Clause
"""A liquid so viscous that the flow is no longer turbulent."""

import numpy as np

from sklvalve.mismatch.effects._defects import hidden
from sklvalve.mismatch.effects._reynolds import viscous_share
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain

_ROOM = 293.15
#: Exponent between laminar and turbulent flow: 2 where their losses add up, 1.2 as the standard's curve.
SHARPNESS = Quantity("sharpness", "1", 1.0, 4.0, (2.0,), log=True, null=None, silent=True)


class ViscousFlow(Effect):
    r"""Flow below full turbulence: :math:`K_v' = F_R(Re_v)\, K_v`.

    .. math:: Re_v = \frac{N_4 F_d Q}{\nu \sqrt{K_v F_L}} \Bigl(\frac{(F_L K_v)^2}{N_2 D^4} + 1\Bigr)^{1/4}

    in closed form. Laminar flow is that of annex A; how it goes over into turbulent flow, on which the
    editions of the standard differ, is fitted. The viscosity is that at 20 degC; where the fluid is known it
    follows the temperature as the fluid's own does. Without choking and without reducers.
    """

    name = key = "viscous_flow"
    kind = "property"
    block, stage = "valve", "capacity"
    parameters: tuple = (
        Quantity("viscosity", "m2/s", 5e-7, 2e-2, (1e-5, 2e-4, 2e-3), log=True, null=None),
        SHARPNESS,
    )
    needs: tuple = ("flow", "p1", "p2")
    hidden_by = hidden(unmeasured=("temperature",))
    words = "viscous, no longer turbulent flow"
    clause = "the flow is viscous, no longer turbulent"
    phrase = "the flow is not turbulent (viscosity about {viscosity:.2g} m2/s at 20 degC)"
    separated_by = (
        "Hold a small opening at three pressure drops, cold and warm: viscous flow is nearer to proportional "
        "to the drop, and the more so the colder."
    )
    source = "IEC 60534-2-1, annex A"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * viscous_share(value, self._viscosity(p, chain), p["sharpness"], chain)

    def _viscosity(self, p: dict[str, float], chain: Chain) -> float | np.ndarray:
        if not chain.fluid.knows("kinematic_viscosity"):
            return p["viscosity"]
        known = chain.fluid.kinematic_viscosity
        return p["viscosity"] * known(chain.temperature, warn=False) / known(_ROOM, warn=False)
