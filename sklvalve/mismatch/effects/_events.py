# SPDX-License-Identifier: BSD-3-Clause
"""Forms of an effect that are told by events in the recording: not simulated, and taken up by no search."""

from typing import Any

from sklvalve.mismatch.effects.base import Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class Event:
    """What all of them share: seen in command and opening, and no part of the simulation.

    When each event comes hangs on friction to a per cent. So the simulation does not time them, and what it
    makes is left as it is.
    """

    stage = "stem"
    needs: tuple = ("command", "opening")

    def apply(self, value: Any, p: dict[str, float], chain: Chain) -> Any:
        """What the stage makes, unchanged."""
        return value

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        """True: what is told by an event was seen."""
        return True


class BySlips(Event):
    """Told by slips of the stem: its parameter is the median jump."""

    parameters: tuple = (Quantity("jump", "1", 0.0, 1.0, (0.03,), shown=Shown("jump", "% of travel", 100.0)),)


class ByHunting(Event):
    """Told by a stem that moves while its command rests: its parameter is the standard deviation it has."""

    parameters: tuple = (Quantity("swing", "1", 0.0, 1.0, (0.01,)),)
