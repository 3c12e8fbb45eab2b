# SPDX-License-Identifier: BSD-3-Clause
"""Air that is lost from the actuator's chamber."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import REACH
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.spring_fault import knows_air
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_LEAK = Shown("leak", "% of the positioner's capacity", 100.0)


class ActuatorLeak(Effect):
    r"""Leak of the chamber to the air, at housing, fitting or terminal.

    .. math:: \dot m = \dot m_{spool} - l\, C\, p\, \psi(p_a / p)

    :math:`C` is the spool's capacity and :math:`l` the leak's share of it. Filling is slower, venting faster;
    the positioner must keep its spool open, so a stem held against the spring droops where it does not
    integrate.
    """

    name = key = "actuator_leak"
    block, stage = "actuator", "actuator"
    parameters: tuple = (Quantity("leak", "1", 0.003, 3.0, (0.1, 0.4), log=True, shown=_LEAK),)
    needs = ("command",)
    hidden_by = REACH
    by_drop = "unseen"
    source = "ISO 6358, critical ratio 0.3"
    requires = "an air supply or a spring range in the data sheet"
    words = "an air leak of the actuator"
    clause = "the actuator leaks air"
    phrase = "the actuator loses air (a leak of {leak:.0%} of the positioner's capacity)"
    separated_by = (
        "Soap the housing, the fittings and the vent hole with the valve half open: "
        "a torn diaphragm blows at the vent, a leaking housing elsewhere."
    )
    damadics = "f9"

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | {"leak": p["leak"]}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # the spool stands open by the leak's share of its flow, and a gain of ten turns that into an error
        droop = 0.1 * p["leak"] * (chain.spring + 0.5) / chain.supply
        return late or droop > 0.5 * tolerance.static_error

    def possible(self, chain: Chain) -> bool:
        return knows_air(chain)


class DiaphragmLeak(ActuatorLeak):
    r"""Torn diaphragm: it leaks, and less of its area carries the pressure.

    .. math:: (1 - a)(p - p_a) = F_0 + x + F_f

    Divided by :math:`1 - a` it is a stronger spring with more friction.
    """

    key = "actuator_leak_diaphragm"
    parameters = (
        *ActuatorLeak.parameters,
        Quantity("lost_area", "1", 0.0, 0.9, (0.2, 0.5), shown=Shown("area without pressure", "%", 100.0)),
    )
    phrase = (
        "the diaphragm is torn (a leak of {leak:.0%} of the positioner's capacity, "
        "{lost_area:.0%} of the area carry no pressure)"
    )
    damadics = "f10"

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # what still carries the whole travel changes the response only
        reach = (1.0 - p["lost_area"]) * (chain.supply - chain.atmosphere) - (chain.spring - chain.atmosphere)
        return reach < 1.05 or super().beyond_tolerance(p, chain, tolerance, late)

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        excess = p["lost_area"] / (1.0 - p["lost_area"])
        return super().apply(value, p, chain) | {
            "coulomb": np.multiply(value["coulomb"], 1.0 + excess),
            "stick": np.multiply(value["stick"], 1.0 + excess),
            "preload": excess * (chain.spring - chain.atmosphere),
            "stiffness": excess,
        }
