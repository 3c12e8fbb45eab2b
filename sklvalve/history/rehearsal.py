# SPDX-License-Identifier: BSD-3-Clause
"""How far a later part of a valve's history lies from an earlier one of it: what no fault has made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

# what older files call one of the looks
_ONCE = {"rest": "residual"}


@dataclass(frozen=True)
class Rehearsal:
    """Evidence against one part of a history that was held against another, by the whole search.

    Parameters
    ----------
    throughout : float
        The strongest that any effect makes of it that acts throughout on valve and meters, relative to what
        is typical of healthy valves [1].
    within : float
        The same of one that begins within it.
    residual : float or None
        The same of what is left over; None where that is not known.
    stem : float, default=0
        The strongest of one that acts throughout on positioner and actuator.
    """

    throughout: float
    within: float
    residual: float | None = None
    stem: float = 0.0

    @classmethod
    def from_dict(cls, looks: Mapping[str, Any]) -> Rehearsal:
        """Put back what `dataclasses.asdict` made of one, under older names too; ``TypeError`` for others."""
        return cls(**{_ONCE.get(look, look): value for look, value in looks.items()})
