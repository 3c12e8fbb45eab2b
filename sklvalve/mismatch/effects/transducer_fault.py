# SPDX-License-Identifier: BSD-3-Clause
"""A signal transducer, before or behind the positioner's comparison, that is off."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import REACH
from sklvalve.mismatch.effects._shown import AIR, DEVIATION, OFFSET
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class TransducerFault(Effect):
    r"""Transducer before the positioner with a wrong span or zero: the positioner is told another command.

    .. math:: u' = (1 + g)\, u + b

    The stem goes where it is told. A lever of the positioner's feedback with a wrong span or zero does the
    same: no signal but the positioner's own input tells the two apart.
    """

    name = key = "transducer_fault"
    block, stage = "actuator", "signal"
    parameters: tuple = (
        Quantity("gain", "1", -0.6, 1.5, (0.1, -0.1, 0.0, 0.0), shown=DEVIATION),
        Quantity("bias", "1", -0.5, 0.5, (0.0, 0.0, 0.04, -0.04), shown=OFFSET),
    )
    needs: tuple = ("command",)
    hidden_by = REACH
    by_drop = "unseen"
    family = "positioner_scale"
    source = "linear span and zero"
    words = "a fault of the I/P transducer"
    clause = "the I/P transducer is faulty"
    phrase = "the signal's transducer is off (span {gain:+.1%}, zero {bias:+.1%} of travel)"
    separated_by = (
        "Measure the positioner's input signal at two commands, and the stem's true travel with a rule."
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return (1.0 + p["gain"]) * value + p["bias"]

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # what the stem is off at either end of the travel
        off = max(abs(p["bias"]), abs(p["gain"] + p["bias"]))
        return late or off > tolerance.position_zero

    def possible(self, chain: Chain) -> bool:
        # without a position a trim learnt from this very recording would take it up
        return chain.measured is not None or chain.trim.known


class TransducerOutput(TransducerFault):
    r"""Transducer behind the comparison, between controller and spool: its gain is the loop's.

    .. math:: \dot m' = r\, \dot m

    Feedback hides it but for the speed of strokes.
    """

    key = "transducer_fault_output"
    stage = "actuator"
    family = "air"
    parameters = (Quantity("share", "1", 0.01, 3.0, (0.3, 0.07, 2.0), log=True, null=1.0, shown=AIR),)
    by_drop = ""
    source = "ISO 6358, critical ratio 0.3"
    requires = "an actuator driven by air"
    phrase = "the positioner's transducer gives {share:.0%} of its air"
    separated_by = (
        "Measure the positioner's output pressure while the command steps: a weak transducer opens little, "
        "a throttled line loses pressure along it."
    )
    damadics = "f12"

    def apply(self, value: Any, p: dict[str, float], chain: Chain) -> Any:
        return value | {"capacity": p["share"] - 1.0}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return True
