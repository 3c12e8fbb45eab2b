# SPDX-License-Identifier: BSD-3-Clause
"""A position sensor whose span is wrong."""

import numpy as np

from sklvalve.mismatch.effects._shown import DEVIATION
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.position_sensor_bias import InLoop, PositionSensorBias
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class PositionSensorGain(PositionSensorBias):
    r"""Recorded travel is off in proportion to how far the stem has left its rest.

    .. math:: x' = x_r + (1 + g)(x - x_r)

    The rest :math:`x_r` is where the spring holds the stem without air: shut, or open for a valve that fails
    open. The stem itself is where the positioner wants it.
    """

    name = key = "position_sensor_gain"
    parameters = (Quantity("gain", "1", -0.5, 1.0, (0.06, -0.06), shown=DEVIATION),)
    family = "position_gain"
    words = "a wrong span of the position sensor"
    clause = "the position sensor's span is wrong"
    phrase = "the position sensor's span is {gain:+.1%} off"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        fail_position = 1.0 if chain.air_closes else 0.0
        return fail_position + (1.0 + p["gain"]) * (value - fail_position)

    def invert(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        """True opening of a recorded one."""
        fail_position = 1.0 if chain.air_closes else 0.0
        return fail_position + (value - fail_position) / (1.0 + p["gain"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # at the far end of the travel it is as much as a zero may be off
        return late or abs(p["gain"]) > tolerance.position_zero


class PositionSensorGainInLoop(InLoop, PositionSensorGain):
    """The wrong sensor is also the positioner's: the position reads right and the flow contradicts it."""

    key = "position_sensor_gain_loop"
