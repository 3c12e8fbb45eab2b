# SPDX-License-Identifier: BSD-3-Clause
"""A positioner that is told the wrong position."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import REACH
from sklvalve.mismatch.effects._events import ByHunting
from sklvalve.mismatch.effects._shown import DEVIATION, OFFSET, PLAY
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.mismatch.effects.transducer_fault import TransducerFault
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class PositionerFeedbackFault(TransducerFault):
    r"""Lever of the positioner with a wrong span or zero.

    .. math:: x_{fb} = (1 + g)\, x + b \quad\Rightarrow\quad x \to (u - b) / (1 + g)

    The stem truly follows the wrong value: the recorded opening shows it, and the flow agrees with it.
    """

    name = key = "positioner_feedback_fault"
    words = "a fault of the positioner's feedback"
    clause = "the positioner's feedback is faulty"
    phrase = "the positioner's feedback is off (span {gain:+.1%}, zero {bias:+.1%} of travel)"
    parameters = (
        Quantity("gain", "1", -0.6, 1.5, (0.1, -0.1, 0.0, 0.0), shown=DEVIATION),
        Quantity("bias", "1", -0.5, 0.5, (0.0, 0.0, 0.04, -0.04), shown=OFFSET),
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return (value - p["bias"]) / (1.0 + p["gain"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        off = max(abs(p["bias"]), abs(p["gain"] + p["bias"])) / (1.0 + p["gain"])
        return late or off > tolerance.position_zero


class FeedbackPlay(Effect):
    r"""Play between the stem and the positioner's lever.

    .. math:: x_{fb}(t) = \min(\max(x_{fb}(t^-), x - w/2), x + w/2)

    The stem overshoots by half the gap each way, and the positioner hunts where it integrates.
    """

    name = "positioner_feedback_fault"
    key = "positioner_feedback_play"
    alike = "play"
    block, stage = "actuator", "actuator"
    parameters = (Quantity("width", "1", 0.002, 0.9, (0.02, 0.04, 0.08, 0.16, 0.4), log=True, shown=PLAY),)
    needs = ("command",)
    hidden_by = REACH
    by_drop = "onset"
    source = "play operator"
    words, clause = PositionerFeedbackFault.words, PositionerFeedbackFault.clause
    phrase = "there is play of {width:.1%} of travel between stem and positioner"
    separated_by = (
        "Step the command up and down by 1, 2 and 5 %: with play in the feedback the stem goes too far, "
        "with play in the linkage not far enough."
    )
    damadics = "f15"

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | {"feedback_play": p["width"]}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["width"] > tolerance.static_error


class FeedbackByHunting(ByHunting, FeedbackPlay):
    """Play in the feedback told by a stem that hunts: the positioner feels late that it has moved."""

    key = "feedback_hunting"
    phrase = (
        "there is play between stem and positioner, which hunts by {swing:.1%} of travel while its command "
        "rests; its swings are not predicted"
    )
