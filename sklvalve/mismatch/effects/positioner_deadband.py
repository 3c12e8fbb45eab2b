# SPDX-License-Identifier: BSD-3-Clause
"""A positioner that leaves small errors alone."""

import numpy as np

from sklvalve.mismatch.effects.base import Effect, Quantity


class PositionerDeadband(Effect):
    r"""Dead band of the positioner, of half width d: errors within it move no air.

    .. math:: e' = \operatorname{sgn}(e)\,\max(|e| - d, 0)
    """

    name = key = "positioner_deadband"
    block, stage = "actuator", "actuator"
    parameters = (Quantity("half_width", "1", 0.002, 0.2, (0.01, 0.03), log=True),)
    needs = ("command",)
    phrase = "the positioner leaves errors of up to {half_width:.1%} of travel uncorrected"
    separated_by = (
        "Small steps of the command (0.25, 0.5, 1, 2 %): in a dead band the stem stays, without a jump after."
    )

    def apply(self, value, p, chain):
        return value | {"dead_band": np.full_like(value["dead_band"], p["half_width"])}

    def beyond_tolerance(self, p, chain, tolerance, late):
        return 2.0 * p["half_width"] > tolerance.static_error
