# SPDX-License-Identifier: BSD-3-Clause
"""How far a later part of a valve's history lies from an earlier one of it: what no fault has made."""

from __future__ import annotations

from dataclasses import dataclass


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
    rest : float or None
        The same of what is left over; None where that is not known.
    stem : float, default=0
        The strongest of one that acts throughout on positioner and actuator.
    """

    throughout: float
    within: float
    rest: float | None = None
    stem: float = 0.0
