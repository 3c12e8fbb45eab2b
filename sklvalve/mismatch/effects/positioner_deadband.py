# SPDX-License-Identifier: BSD-3-Clause
"""A positioner that leaves small errors alone."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import STICKS
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.thresholds import seen_thresholds
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_HALF_BAND = Shown("dead band each way", "% of travel", 100.0)
_REVERSAL = Shown("dead band where it turns, as a multiple")


def _dead_band(half_width: float) -> float:
    """Whole dead band, as valve.toml has it [% of travel]."""
    return 200.0 * half_width


class PositionerDeadband(Effect):
    r"""Dead band of the positioner, of half width d: errors within it move no air.

    .. math:: e' = \operatorname{sgn}(e)\,\max(|e| - d, 0)
    """

    name = key = "positioner_deadband"
    # a setting of some positioners, a fault of others
    kind, declared_as = "either", "dead_band"
    alike = "play"
    block, stage = "actuator", "actuator"
    parameters: tuple = (
        Quantity(
            "half_width", "1", 0.002, 0.2, (0.01, 0.03), log=True, shown=_HALF_BAND, declared=_dead_band
        ),
    )
    needs = ("command",)
    hidden_by = STICKS
    words = "a dead band of the positioner"
    clause = "the positioner has a dead band"
    phrase = "the positioner leaves errors of up to {half_width:.1%} of travel uncorrected"
    separated_by = (
        "Small steps of the command (0.25, 0.5, 1, 2 %): in a dead band the stem stays, without a jump after."
    )

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | {"dead_band": np.full_like(value["dead_band"], p["half_width"])}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        declared = (1.0 + tolerance.declared) * (chain.valve.dead_band or 0.0)
        return 2.0 * p["half_width"] > max(tolerance.static_error, declared)


class MotorDeadband(PositionerDeadband):
    r"""Dead band of the comparator that starts a motor, wider where the motor would have to turn.

    .. math:: \text{start when } |e| > d, \text{ or } |e| > \rho d \text{ against the last run;
        stop when } |e| \to 0

    Makers give both: the sensitivity, and the reversal. Once the motor runs it corrects the whole error.
    """

    key = "positioner_deadband_motor"
    # no comparator of a motor does without
    kind = "property"
    motor = True
    parameters = (
        Quantity(
            "half_width",
            "1",
            0.0005,
            0.2,
            (0.005, 0.01, 0.01, 0.02, 0.02, 0.05),
            log=True,
            shown=_HALF_BAND,
            declared=_dead_band,
        ),
        Quantity(
            "reversal", "1", 0.2, 10.0, (1.0, 1.0, 2.5, 1.0, 2.5, 1.0), log=True, null=None, shown=_REVERSAL
        ),
    )
    phrase = (
        "the motor leaves errors of up to {half_width:.2%} of travel uncorrected, "
        "{reversal:.2g} times that where it would have to turn"
    )
    separated_by = "Small steps of the command (0.25, 0.5, 1, 2, 4 %), up, and then the same down."

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        seen = seen_thresholds(chain.recording)
        if seen is None:
            return self.parameters
        # a threshold that some steps exceed and others do not has no slope for a fit to follow: it is looked
        # for between the errors that show it, and only there
        width, factor = self.parameters
        (low, high), turning = seen
        if turning is None:
            return _between(width, low, high), factor
        middle = 0.5 * (low + high)
        return _between(width, low, high), _between(factor, turning[0] / middle, turning[1] / middle)

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        changed = super().apply(value, p, chain)
        return changed | {"reversal": np.full_like(value["reversal"], p["reversal"])}


def _between(quantity: Quantity, low: float, high: float) -> Quantity:
    low, high = np.clip([0.99 * low, 1.01 * high], 1.01 * quantity.low, 0.99 * quantity.high)
    return Quantity(
        quantity.name, quantity.unit, float(low), float(1.001 * high), (float(0.5 * (low + high)),), log=True
    )
