# SPDX-License-Identifier: BSD-3-Clause
"""Play, between the stem's sensor and the plug or in the linkage before the sensor."""

import numpy as np

from sklvalve.mismatch.effects._defects import MOVES, hidden
from sklvalve.mismatch.effects._shown import PLAY
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.stages import play, play_with_overshoot
from sklvalve.simulation.tolerance import Tolerance


class Backlash(Effect):
    r"""Play between the stem, where its position is taken, and the plug.

    .. math:: x_{plug}(t) = \min(\max(x_{plug}(t^-), x - w/2), x + w/2)

    It shows in the flow only, as a constant shift of opening by direction of travel; without jumps, and
    whatever the rate. After a stroke the stem swings beyond where the next sample sees it, and the plug stays
    where the peak took it, until the stem comes back by the whole gap: hence the overshoot, a share of the
    stroke. Without it a recording with large strokes shows play that changes, or too little of it. Until the
    first reversals the plug stands where it was left: on the `first_side` of its gap.
    """

    name = key = "backlash"
    block, stage = "valve", "plug"
    parameters: tuple = (
        Quantity("width", "1", 0.002, 0.4, (0.015, 0.05), log=True, shown=PLAY),
        Quantity("overshoot", "1", 0.0, 0.3, (0.03,), null=None, silent=True),
        Quantity("first_side", "1", -1.0, 1.0, (0.0,), null=None, silent=True),
    )
    needs: tuple = ("flow",)
    hidden_by = hidden(MOVES, compressed=("flow",), quantised=("opening", "flow"))
    by_drop = "onset"
    family = "play"
    words = "backlash"
    clause = "the stem has play (backlash)"
    phrase = "there is play between stem and plug of {width:.1%} of travel"
    separated_by = (
        "Step the command up and down by 1, 2 and 5 % at a slow and at a fast rate: play is the same at both."
    )
    damadics = "f4"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return play_with_overshoot(value, chain.step, p["width"], p["overshoot"], p["first_side"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["width"] > tolerance.play


class LinkageBacklash(Backlash):
    """Play in the linkage between actuator and position sensor: the recorded opening itself shows it."""

    key = "backlash_linkage"
    alike = "play"
    block, stage = "actuator", "stem"
    parameters = (Quantity("width", "1", 0.002, 0.4, (0.015, 0.05), log=True, shown=PLAY),)
    needs = ("command", "opening")
    by_drop = ""
    phrase = "there is play of {width:.1%} of travel between actuator and stem"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        changed, begun = value.copy(), slice(chain.first_row(self), None)
        # a gap that opens opens around the stem: where it stood in none before says nothing
        changed[begun] = play(value[begun], p["width"])
        return changed

    def possible(self, chain: Chain) -> bool:
        return chain.measured is not None
