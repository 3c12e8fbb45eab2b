# SPDX-License-Identifier: BSD-3-Clause
"""A stem that rubs."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import MOVES, hidden
from sklvalve.mismatch.effects._events import ByHunting, BySlips
from sklvalve.mismatch.effects._shown import FRICTION
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


class Friction(Effect):
    r"""Friction in motion far beyond that of a sound packing, and no larger at rest.

    .. math:: F_f = F_c \operatorname{sgn} \dot x

    in travels of the spring: :math:`F_c = 0.1` is a tenth of the spring's range. The stem follows late by
    what it takes the positioner to build up :math:`2 F_c` at each reversal, and moves without jumps. Where
    the command is slow, play in the linkage looks the same; a stem that sticks jumps besides.
    """

    name = key = "friction"
    alike = "play"
    block, stage = "actuator", "actuator"
    parameters = (Quantity("friction", "1", 0.02, 1.5, (0.1, 0.3), log=True, shown=FRICTION),)
    needs = ("command",)
    hidden_by = hidden(MOVES, frozen=("opening",))
    source = "Olsson et al., Friction models and friction compensation, Eur. J. Control 4 (1998)"
    words = "raised friction of the stem"
    clause = "the stem's friction is too high"
    phrase = "the stem rubs (friction {friction:.0%} of the spring's range)"
    separated_by = (
        "Ramp the command slowly up and down with the actuator's pressure recorded: "
        "friction opens its loop of pressure over travel, play in the linkage does not."
    )

    def apply(self, value: dict[str, Any], p: dict[str, float], chain: Chain) -> dict[str, Any]:
        return value | {"coulomb": np.maximum(value["coulomb"], p["friction"])}

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["friction"] > most_friction(tolerance)


class FrictionBySlips(BySlips, Friction):
    r"""Friction told by the slips of the stem, which it makes where it falls as the stem begins to move.

    .. math:: |x_{k+1} - x_k| = J, \quad x_{k+1} \notin [\min u, \max u]

    Friction that is larger throughout is larger at rest as well, and a stem that breaks away from it
    overshoots as one that only sticks does: slips alone tell the two apart nowhere.
    """

    key = "friction_slips"
    phrase = (
        "the stem rubs, and slips where it breaks away (it jumps by {jump:.1%} of travel, past what was "
        "commanded); the moments of the slips are not predicted"
    )


class FrictionByHunting(ByHunting, Friction):
    """Friction told by a stem that hunts: its positioner overshoots what breaks it away."""

    key = "friction_hunting"
    phrase = (
        "the stem rubs, and hunts by {swing:.1%} of travel while its command rests; "
        "its swings are not predicted"
    )


def most_friction(tolerance: Tolerance) -> float:
    """Friction that a sound valve may have: what keeps a loop of ordinary gain within its static error."""
    return 2.5 * tolerance.static_error
