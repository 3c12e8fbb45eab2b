# SPDX-License-Identifier: BSD-3-Clause
"""A positioner that drives the valve to its stop when the command comes near the end."""

import numpy as np

from sklvalve.mismatch.effects._defects import hidden
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

# over so much of the command the cut-off sets in: a fit needs a slope to follow
_EDGE = 0.002
_CUT_OFF = Shown("cut-off", "% of the command", 100.0)


class TightShutoff(Effect):
    r"""Cut-off of small commands, to press the plug into its seat.

    .. math:: u' = 0 \;\text{for}\; u < c, \quad u' = u \;\text{above}

    The stem jumps near the shut end, at the same command both ways; one that sticks in its seat jumps on the
    way up only.
    """

    name = key = "tight_shutoff"
    kind = "property"
    block, stage = "actuator", "signal"
    parameters: tuple = (Quantity("cut_off", "1", 0.003, 0.4, (0.02, 0.06, 0.15), log=True, shown=_CUT_OFF),)
    needs = ("command",)
    hidden_by = hidden(saturated=("opening",))
    source = "tight closing function of positioners"
    requires = "a command that comes near the end of its travel"
    words = "a tight shut-off setting of the positioner"
    clause = "the positioner shuts the valve early (tight shut-off)"
    phrase = "the positioner shuts the valve below a command of {cut_off:.1%}"
    separated_by = "Ramp the command slowly through the end of its travel, both ways."

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        (cut_off,) = self.parameters
        seen = self._seen(chain)
        if seen is None:
            return self.parameters
        starts = (float(np.clip(seen, cut_off.low, cut_off.high)), *cut_off.starts)
        return (Quantity(cut_off.name, cut_off.unit, cut_off.low, cut_off.high, starts, log=True),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * np.clip((value - p["cut_off"]) / _EDGE + 1.0, 0.0, 1.0)

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["cut_off"] > tolerance.static_error

    def possible(self, chain: Chain) -> bool:
        left = self._from_end(chain.command)
        return bool(np.nanmin(left) < max(self.parameters[0].starts))

    def _seen(self, chain: Chain) -> float | None:
        """Largest command at which the stem stands at its stop nevertheless; None where none does."""
        if chain.measured is None:
            return None
        left, stands = self._from_end(chain.command), self._from_end(chain.measured)
        cut = (left > 0.003) & (left < 0.4) & (stands < 0.02) & (stands < 0.5 * left)
        return float(np.quantile(left[cut], 0.98)) if cut.sum() >= 5 else None

    @staticmethod
    def _from_end(signal: np.ndarray) -> np.ndarray:
        return signal


class FullOpening(TightShutoff):
    r"""The same at the open end: :math:`u' = 1` for :math:`u > 1 - c`."""

    key = "tight_shutoff_open"
    phrase = "the positioner opens the valve wholly within {cut_off:.1%} of its open end"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return 1.0 - super().apply(1.0 - value, p, chain)

    @staticmethod
    def _from_end(signal: np.ndarray) -> np.ndarray:
        return 1.0 - signal
