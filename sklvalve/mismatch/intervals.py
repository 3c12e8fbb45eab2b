# SPDX-License-Identifier: BSD-3-Clause
"""Intervals of parameters: what noise leaves open, and what a simulation gets wrong of the effect itself."""

import numpy as np

from sklvalve.mismatch.distance import SHARE_MISTAKEN

# of its value, or of its range where it is about zero: how far a parameter is moved to see what it does
_STEP, _OF_RANGE = 0.02, 1e-3


def interval_of(workbench, member, fitted, quantity):
    r"""Interval that holds a parameter of an effect with 95 %.

    .. math:: h^2 = (1.96\, s)^2 + (0.15\, \Delta / \Delta')^2

    with the standard deviation s of the fit, the rms change :math:`\Delta` that the effect makes, and the rms
    change :math:`\Delta'` per unit of the parameter: a simulation gets 15 % of an effect wrong, and a
    parameter may make up for that.

    Parameters
    ----------
    workbench : Workbench
    member : Member
    fitted : Model
        That holds it.
    quantity : Quantity

    Returns
    -------
    low, high : float
        Within what is physically possible; None where the fit knows no deviation.
    """
    key = f"{member.effect.key}.{quantity.name}"
    value, spread = fitted.values[key], fitted.spreads.get(key, np.nan)
    if not np.isfinite(spread):
        return None
    half = np.hypot(1.96 * spread, _systematic(workbench, member, fitted, quantity, key))
    if quantity.log:
        ends = value * np.exp(-half), value * np.exp(half)
    else:
        ends = value - half, value + half
    return tuple(float(np.clip(e, quantity.low, quantity.high)) for e in ends)


def _systematic(workbench, member, fitted, quantity, key):
    """How far the parameter may be off to make up for what the simulation gets wrong of its effect."""
    value = fitted.values[key]
    step = _STEP if quantity.log else max(_STEP * abs(value), _OF_RANGE * (quantity.high - quantity.low))
    moved = value * np.exp(step) if quantity.log else value + step
    if moved > quantity.high:
        step = -step
        moved = value * np.exp(step) if quantity.log else value + step
    rest = tuple(m for m in fitted.members if m.effect.key != member.effect.key)
    own = workbench.simulate(fitted.members, fitted.values)
    without = workbench.simulate(rest, fitted.values)
    beside = workbench.simulate(fitted.members, fitted.values | {key: moved})
    change, slope = _gap(workbench, own, without), _gap(workbench, own, beside) / abs(step)
    return SHARE_MISTAKEN * change / slope if slope > 0.0 else 0.0


def _gap(workbench, one, other):
    """Rms difference of two simulations, each channel in its span [1]."""
    squares = [
        np.nanmean((one.predictions[c] - other.predictions[c]) ** 2) / workbench.spans[c] ** 2
        for c in workbench.channels
    ]
    return float(np.sqrt(sum(squares)))
