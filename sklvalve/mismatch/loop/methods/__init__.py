# SPDX-License-Identifier: BSD-3-Clause
"""Published methods for sticking valves, from a loop's command and value alone."""

from numpy.typing import ArrayLike

from sklvalve.mismatch.loop.methods.cross_correlation import cross_correlation
from sklvalve.mismatch.loop.methods.ellipse import ellipse
from sklvalve.mismatch.loop.methods.half_periods import area, curve_shape, relay
from sklvalve.mismatch.loop.methods.hammerstein import hammerstein
from sklvalve.mismatch.loop.methods.result import MethodResult
from sklvalve.mismatch.loop.oscillation import Oscillation, find_oscillation
from sklvalve.recording.gaps import filled

__all__ = [
    "MethodResult",
    "area",
    "cross_correlation",
    "curve_shape",
    "ellipse",
    "hammerstein",
    "published_methods",
    "relay",
]


def published_methods(
    command: ArrayLike,
    value: ArrayLike,
    sample_time: float,
    *,
    oscillation: Oscillation | None = None,
    setpoint: ArrayLike | None = None,
    is_flow: bool | None = None,
) -> list[MethodResult]:
    """Apply every published method to a loop.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit; rows that are not finite are interpolated.
    sample_time : float
        Between rows [s].
    oscillation : Oscillation, optional
        As `find_oscillation` gives it; found here unless given.
    setpoint : array-like of shape (n,), optional
        Of the value's unit.
    is_flow : bool or None, default=None
        Whether the value is the flow through the valve (a self-regulating process); False: the process may
        integrate.

    Returns
    -------
    results : list of MethodResult
        One of each method, in the order of their years.
    """
    command, value = filled(command), filled(value)
    setpoint = None if setpoint is None else filled(setpoint)
    if oscillation is None:
        oscillation = find_oscillation(command, value, sample_time, setpoint)
    return [
        cross_correlation(command, value, oscillation, is_flow=is_flow),
        relay(value, oscillation, setpoint=setpoint),
        area(value, oscillation, setpoint=setpoint, is_flow=is_flow),
        ellipse(command, value, oscillation, setpoint=setpoint),
        curve_shape(command, value, oscillation, is_flow=is_flow),
        hammerstein(command, value, oscillation),
    ]
