# SPDX-License-Identifier: BSD-3-Clause
"""Nozzles that fill and vent the chamber of an actuator, compiled into its scan."""

from math import sqrt

import numba as nb

# from this ratio on air that flows back does so in proportion to what is missing from one
_LAMINAR = 0.98
_STEEP = sqrt(1.0 - ((_LAMINAR - 0.3) / 0.7) ** 2) / (1.0 - _LAMINAR)


@nb.njit(cache=True, inline="always")
def _nozzle(ratio):
    # ISO 6358, critical ratio 0.3: share of the choked mass flow that a pressure ratio leaves, and its slope,
    # which is kept finite where it is upright
    if ratio <= 0.3:
        return 1.0, 0.0
    if ratio >= 1.0:
        return 0.0, -70.0
    part = (ratio - 0.3) * (1.0 / 0.7)
    share = sqrt(1.0 - part * part)
    return share, -part / (0.7 * max(share, 0.02))


@nb.njit(cache=True, inline="always")
def supply_nozzle(pressure, ps):
    """Mass flow that fills a chamber, below zero into a lower supply, and its slope in the pressure."""
    if pressure <= ps:
        share, slope = _nozzle(pressure / ps)
        return ps * share, slope
    ratio = ps / pressure
    if ratio > _LAMINAR:
        # by a line: upright at no flow, it would shake a chamber that has come to its supply
        share, slope = _STEEP * (1.0 - ratio), -_STEEP
    else:
        share, slope = _nozzle(ratio)
    return -pressure * share, slope * ratio - share


@nb.njit(cache=True, inline="always")
def vent_nozzle(pressure, atmosphere, width):
    """Mass flow that a chamber loses through a nozzle of this width, and its slope in the pressure."""
    ratio = atmosphere / pressure
    share, slope = _nozzle(ratio)
    return width * pressure * share, width * (share - slope * ratio)
