# SPDX-License-Identifier: BSD-3-Clause
"""A stem that sticks and then slips."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import STICKS
from sklvalve.mismatch.effects._events import ByHunting, BySlips
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain

_STATIC_FRICTION = Shown("friction at rest", "% of the spring range", 100.0)
_SLIDING_SHARE = Shown("sliding friction", "% of that at rest", 100.0)


class Stiction(Effect):
    r"""Friction at rest that far exceeds friction in motion.

    .. math:: |F_f| \le F_s \text{ at rest}, \quad F_f = F_c \operatorname{sgn} v + (F_s - F_c) e^{-(v/v_s)^2}
        \operatorname{sgn} v

    The stem stays while the pressure under the diaphragm changes, then jumps; with a positioner that
    integrates it hunts. Forces in travels of the spring.
    """

    name = key = "stiction"
    alike = "play"
    block, stage = "actuator", "actuator"
    parameters: tuple = (
        Quantity("static_friction", "1", 0.02, 0.6, (0.06, 0.2), log=True, shown=_STATIC_FRICTION),
        Quantity("sliding_share", "1", 0.1, 0.95, (0.4,), null=None, shown=_SLIDING_SHARE),
    )
    needs: tuple = ("command",)
    hidden_by = STICKS
    words = "stiction"
    clause = "the stem sticks and jumps (stiction)"
    phrase = "the stem sticks and slips (friction at rest {static_friction:.0%} of the spring's range)"
    separated_by = (
        "Ramp the command slowly through a reversal with the actuator's pressure recorded: "
        "jumps are stiction."
    )
    damadics = "f4"

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        sliding = p["static_friction"] * p["sliding_share"]
        changed = dict(value)
        changed["coulomb"] = np.maximum(value["coulomb"], sliding)
        changed["stick"] = np.full_like(value["stick"], p["static_friction"] - sliding)
        return changed


class StictionBySlips(BySlips, Stiction):
    r"""Friction at rest told by its slips: the stem rests, jumps, and lands beyond every command.

    .. math:: |x_{k+1} - x_k| = J, \quad x_{k+1} \notin [\min u, \max u]

    The slips are seen in the recording itself.
    """

    key = "stiction_slips"
    phrase = (
        "the stem sticks and slips (it jumps by {jump:.1%} of travel, past what was commanded); "
        "the moments of the slips are not predicted"
    )


class StictionByHunting(ByHunting, Stiction):
    """Friction at rest told by a stem that hunts: what breaks it away carries it past its command."""

    key = "stiction_hunting"
    phrase = (
        "the stem sticks, and hunts by {swing:.1%} of travel while its command rests; "
        "its swings are not predicted"
    )
