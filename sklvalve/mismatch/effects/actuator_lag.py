# SPDX-License-Identifier: BSD-3-Clause
"""An actuator that answers slowly."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import MOVES
from sklvalve.mismatch.effects._response import slowest
from sklvalve.mismatch.effects._shown import AIR
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.stages import first_order_lag
from sklvalve.simulation.tolerance import Tolerance


class ActuatorLag(Effect):
    r"""Lag in the pneumatic signal, as a long line or a large volume before the positioner makes it.

    .. math:: \tau \dot u' = u - u'

    The same share of every step is made in the same time, whatever its size. A positioner answers within 3 s;
    this is what is slower.
    """

    name = key = "actuator_lag"
    kind = "property"
    block, stage = "actuator", "signal"
    parameters: tuple = (Quantity("time_constant", "s", 0.5, 600.0, (6.0, 25.0), log=True),)
    needs = ("command",)
    hidden_by = MOVES
    source = "volume behind a resistance, V dp/dt = (p_s - p) / R"
    requires = "an actuator driven by air"
    words = "a slow actuator"
    clause = "the actuator is slow"
    phrase = "the actuator follows with a lag of {time_constant:.1f} s"
    separated_by = (
        "Steps of three sizes: a lag takes the same time for all, choked air or a slew limit longer "
        "the larger the step, and a dead time shifts all of it."
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return first_order_lag(value, chain.step, p["time_constant"], 1.0)

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["time_constant"] > slowest(chain, tolerance, late)

    def possible(self, chain: Chain) -> bool:
        return not chain.electric


class RestrictedAir(ActuatorLag):
    r"""Air that passes slowly between spool and chamber, through a kinked line or a clogged filter or nozzle.

    .. math:: \dot m' = r\, \dot m

    The flow through a nozzle chokes, so a large step takes longer than a small one; filling and venting
    suffer alike.
    """

    key = "actuator_lag_air"
    # thin tubes of a sound actuator throttle its air as a kinked one does
    kind = "either"
    stage = "actuator"
    family = "air"
    parameters = (Quantity("share", "1", 0.002, 0.95, (0.3, 0.07), log=True, null=1.0, shown=AIR),)
    phrase = "the actuator's air is throttled to {share:.0%} of its flow"
    source = "ISO 6358, critical ratio 0.3"

    def apply(self, value: Any, p: dict[str, float], chain: Chain) -> Any:
        return value | {"capacity": p["share"] - 1.0}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # a capacity constant from the start is calibrated down to a whole stroke in the response time
        return True
