# SPDX-License-Identifier: BSD-3-Clause
"""Gas in the liquid before the valve."""

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW, UNSTEADY, hidden
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain

# fine enough that where the mixture chokes moves smoothly with its share of gas
_OUTLET = np.linspace(0.02, 1.0, 2000)
_LOG_OUTLET = np.log(_OUTLET)
_GAS_SHARE = Shown("gas share", "% of the volume", 100.0)


class TwoPhase(Effect):
    r"""Gas bubbles that enter with the liquid, a share :math:`\alpha` of the volume at the inlet.

    .. math:: \frac{Q'}{Q} = \frac{1}{\alpha p_1 / p + 1 - \alpha}
              \sqrt{\frac{(1 - \alpha)(p_1 - p) + \alpha p_1 \ln(p_1 / p)}{(1 - \alpha)(p_1 - p_2)}},
              \quad p = \max(p_2, p^*)

    Volume at the inlet, of bubbles that move with the liquid and keep its temperature; :math:`p^*` is where
    that flow is largest: a mixture chokes earlier than the liquid. Bubbles make the flow unsteady as well,
    which is not modelled.
    """

    name = key = "two_phase"
    # another fluid is no fault of a valve, whenever it comes
    kind = kind_late = "either"
    block, stage = "line", "capacity"
    parameters = (Quantity("gas_share", "1", 0.0, 0.6, (0.03, 0.15), shown=_GAS_SHARE),)
    needs = ("flow", "p1", "p2")
    hidden_by = hidden(UNSTEADY, END_OF_FLOW)
    words = "gas carried in the liquid"
    clause = "the liquid carries gas"
    phrase = "gas enters with the liquid, about {gas_share:.0%} of the volume"
    separated_by = (
        "Bleed the line before the valve, or raise both pressures at a constant drop: what bubbles do "
        "shrinks."
    )
    source = "homogeneous frozen flow, e.g. Brennen, Fundamentals of Multiphase Flow, chapter 9"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        alpha = p["gas_share"]
        with np.errstate(divide="ignore", invalid="ignore"):
            outlet = chain.p2 / chain.p1
            # backwards, or without a drop, nothing is known of the gas
            forward = (outlet < 1.0 - 1e-9) & (chain.p1 > 0.0)
            outlet = np.where(forward, outlet, 0.5)
            choked = _OUTLET[int(np.argmax(_mixture(_OUTLET, _LOG_OUTLET, alpha)))]
            mixture = np.maximum(outlet, choked)
            # of the liquid alone the square root of the whole drop, choked or not
            ratio = _mixture(mixture, np.log(mixture), alpha) / np.sqrt((1.0 - alpha) * (1.0 - outlet))
        if chain.recording.mass_flow:
            ratio = ratio * (1.0 - alpha)
        return np.where(forward, value * ratio, value)


def _mixture(outlet: np.ndarray, log_outlet: np.ndarray, alpha: float) -> np.ndarray:
    """Flow of the mixture over that of its inlet density and the whole inlet pressure, by p / p1."""
    work = (1.0 - alpha) * (1.0 - outlet) - alpha * log_outlet
    return np.sqrt(work) / (alpha / outlet + 1.0 - alpha)
