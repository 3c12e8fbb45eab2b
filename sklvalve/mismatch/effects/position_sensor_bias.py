# SPDX-License-Identifier: BSD-3-Clause
"""A position sensor that reads off by a constant."""

import numpy as np

from sklvalve.mismatch.effects._defects import READING
from sklvalve.mismatch.effects._shown import OFFSET
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class PositionSensorBias(Effect):
    """Recorded opening is off by a constant, the stem is where the positioner wants it.

    Both residuals show it: the opening by the bias itself, the flow by what the bias does to the capacity.
    """

    name = key = "position_sensor_bias"
    block, stage = "measurement", "position_sensor"
    parameters = (Quantity("bias", "1", -0.5, 0.5, (0.03, -0.03), shown=OFFSET),)
    needs = ("opening", "command")
    hidden_by = READING
    family = "position"
    words = "a shifted zero of the position sensor"
    clause = "the position sensor's zero has shifted"
    phrase = "the position sensor reads {bias:+.1%} of travel off"
    separated_by = "Drive the valve to both stops and read the sensor there."
    damadics = "f13"
    requires = "a recorded opening"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value + p["bias"]

    def invert(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        """True opening of a recorded one."""
        return value - p["bias"]

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return late or abs(p["bias"]) > tolerance.position_zero

    def possible(self, chain: Chain) -> bool:
        return chain.measured is not None


class InLoop(PositionSensorBias):
    """A wrong position sensor that is the positioner's too: the plug stands where its reading is right.

    Only the stops of the stem betray it in the position: no reading is below that of a shut valve.
    """

    stage = "plug"
    needs = ("opening", "flow")
    by_drop = "always"
    in_loop = True

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return self.invert(value, p, chain)

    def stops(self, p: dict[str, float], chain: Chain) -> np.ndarray:
        """Readings at both stops of the stem [1]."""
        return super().apply(np.array([0.0, 1.0]), p, chain)


class PositionSensorBiasInLoop(InLoop, PositionSensorBias):
    """The biased sensor is also the positioner's: the position reads right and the flow contradicts it."""

    key = "position_sensor_bias_loop"
