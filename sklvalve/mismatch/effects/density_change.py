# SPDX-License-Identifier: BSD-3-Clause
"""A liquid of another density than the sheet's, or one that changes otherwise with temperature."""

import numpy as np

from sklvalve.mismatch.effects._defects import WARMTH
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_ROOM = 293.15
# over a smaller range of temperature a density that follows it is one that does not
_RANGE = 2.0
_RATIO = Shown("density, as a multiple of the sheet's,")
_EXPANSION = Shown("change of density", "%/K", 100.0)


def warms(chain: Chain) -> bool:
    """Whether a recorded temperature varies by enough to speak of what hangs on it."""
    if "temperature" not in chain.recording:
        return False
    low, high = np.nanquantile(chain.temperature, (0.02, 0.98))
    return bool(high - low >= _RANGE)


class DensityChange(Effect):
    r"""Density off by one factor: volume flow :math:`Q' = Q / \sqrt{r}`, mass flow :math:`M' = M \sqrt{r}`.

    A constant one is a factor on the flow, as a wrong capacity is; liquids bound the factor.
    """

    name = key = "density_change"
    # another fluid is no fault of a valve, whenever it comes
    kind = kind_late = "either"
    block, stage = "valve", "flow"
    parameters: tuple = (Quantity("ratio", "1", 0.6, 1.7, (1.25, 0.85), null=1.0, shown=_RATIO),)
    needs: tuple = ("flow",)
    hidden_by = WARMTH
    by_drop = "always"
    family = "gain"
    words = "a change of density"
    clause = "the density has changed"
    phrase = "the liquid's density is {ratio:.2f} times the sheet's"
    separated_by = (
        "Take a sample of the liquid and weigh it: no signal of the valve tells density from capacity."
    )

    def _ratio(self, p: dict[str, float], chain: Chain) -> float | np.ndarray:
        return p["ratio"]

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        root = np.sqrt(self._ratio(p, chain))
        return value * root if chain.recording.mass_flow else value / root

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        factor = np.sqrt(p["ratio"])
        factor = factor if chain.recording.mass_flow else 1.0 / factor
        return late or abs(factor - 1.0) > tolerance.capacity

    def possible(self, chain: Chain) -> bool:
        # a trim learnt from this very recording would take it up
        return chain.trim.known


class ThermalDensity(DensityChange):
    r"""Density that falls with temperature by more, or less, than the sheet's fluid has it.

    .. math:: \rho' = \rho\, e^{-\beta (T - 293.15\,\mathrm{K})}

    Organic liquids expand by about 0.001 per kelvin, water by 0.0002 to 0.0007, liquefied gases by 0.003 and,
    the nearer their critical point, by 0.01 and more.
    """

    key = "density_change_thermal"
    parameters = (Quantity("expansion", "1/K", -0.002, 0.02, (0.001, -0.0005), shown=_EXPANSION),)
    needs = ("flow", "temperature")
    family = ""
    phrase = "the liquid's density changes by {expansion:+.3%} a kelvin more than the sheet has it"
    separated_by = "Warm the liquid by 20 K at a fixed opening and pressure drop."
    requires = "a temperature that varies by 2 K or more"

    def _ratio(self, p: dict[str, float], chain: Chain) -> float | np.ndarray:
        return np.exp(-p["expansion"] * (chain.temperature - _ROOM))

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return True

    def possible(self, chain: Chain) -> bool:
        return warms(chain)
