# SPDX-License-Identifier: BSD-3-Clause
"""A liquid whose viscosity falls with its temperature in its own way."""

import numpy as np

from sklvalve.mismatch.effects._defects import WARMTH
from sklvalve.mismatch.effects.base import Quantity, Shown
from sklvalve.mismatch.effects.density_change import warms
from sklvalve.mismatch.effects.viscous_flow import SHARPNESS, ViscousFlow
from sklvalve.simulation.chain import Chain

_ROOM = 293.15
_FALL = Shown("fall of viscosity", "%/K", 100.0)


class ViscosityChange(ViscousFlow):
    r"""Viscous flow with a viscosity that depends on temperature other than the sheet's fluid.

    .. math:: \nu = \nu_{20}\, e^{-\beta (T - 293.15\,\mathrm{K})}

    Oils and syrups have :math:`\beta` of 0.02 to 0.1 per kelvin. Seen only where the flow is not turbulent.
    """

    name = key = "viscosity_change"
    # another fluid is no fault of a valve, whenever it comes
    kind = kind_late = "either"
    parameters = (
        Quantity("viscosity", "m2/s", 5e-7, 5e-2, (1e-5, 2e-4, 2e-3), log=True, null=None),
        Quantity("fall", "1/K", 0.02, 0.15, (0.04,), log=True, null=None, shown=_FALL),
        SHARPNESS,
    )
    needs = ("flow", "p1", "p2", "temperature")
    hidden_by = WARMTH
    words = "a change of viscosity"
    clause = "the viscosity has changed"
    phrase = "the flow is viscous ({viscosity:.2g} m2/s at 20 degC), the less so by {fall:.1%} a kelvin"
    separated_by = "Hold a small opening at one pressure drop while the temperature changes by 20 K."
    requires = "a temperature that varies by 2 K or more"

    def possible(self, chain: Chain) -> bool:
        return warms(chain)

    def _viscosity(self, p: dict[str, float], chain: Chain) -> float | np.ndarray:
        return p["viscosity"] * np.exp(-p["fall"] * (chain.temperature - _ROOM))
