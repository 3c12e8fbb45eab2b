# SPDX-License-Identifier: BSD-3-Clause
"""Half periods of the integrated signal: triangles or sines (He et al.)."""

from sklvalve.mismatch.loop.methods.cycles import half_periods, left_over, sines, triangles
from sklvalve.mismatch.loop.methods.result import (
    NOT_APPLICABLE,
    MethodResult,
    by_limits,
    why_not_applicable,
)

METHOD = "curve fitting"
SOURCE = "He, Wang, Pottmann and Qin 2007, doi 10.1021/ie061219a"
LIMITS = (0.4, 0.6)  # published: below no stiction, above stiction
_FEWEST_ROWS = 10.0  # five rows from zero to zero tell a triangle from a sine
_FEWEST_HALVES = 4


def curve_shape(command, value, oscillation, *, is_flow=None):
    r"""Compare triangles and sines on the half periods of the first integrated signal behind the valve.

    .. math:: SI = \frac{MSE_\text{sin}}{MSE_\text{sin} + MSE_\text{tri}}

    A valve that jumps sends steps into the process. The first integrator behind it makes triangles of them:
    the controller (the command is looked at) for a self-regulating process, the process itself (the value)
    for an integrating one. Each half period is fitted from zero to zero by two straight lines with a free
    peak and by half a sine.

    Valid for a regular oscillation of ten rows or more in a period. A process with a long lag rounds the
    triangle off; an outside triangle or square wave is called stiction too.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    is_flow : bool or None
        False looks at the value (a process that integrates), else the command is looked at.

    Returns
    -------
    result : MethodResult

    References
    ----------
    Q. P. He, J. Wang, M. Pottmann, S. J. Qin, A curve fitting method for detecting valve stiction in
    oscillating control loops, Industrial and Engineering Chemistry Research 46 (2007) 4549-4560.
    """
    why = why_not_applicable(oscillation, _FEWEST_ROWS)
    if oscillation.rows is None or oscillation.rows < _FEWEST_ROWS:
        return MethodResult(METHOD, SOURCE, None, LIMITS[1], NOT_APPLICABLE, why)
    name, signal = ("value", value) if is_flow is False else ("command", command)
    shapes = half_periods(signal, oscillation.rows)
    if len(shapes) < _FEWEST_HALVES:
        why = f"The {name} has {len(shapes)} whole half periods, and {_FEWEST_HALVES} are needed."
        return MethodResult(METHOD, SOURCE, None, LIMITS[1], NOT_APPLICABLE, why)
    sine, triangle = left_over(shapes, sines()).sum(), left_over(shapes, triangles()).sum()
    index = float(sine / max(sine + triangle, 1e-300))
    says = by_limits(index, *LIMITS) if why is None else NOT_APPLICABLE
    detail = why or (
        f"Triangles fit the {name}'s {len(shapes)} half periods with {triangle / max(sine, 1e-300):.2g} "
        "times the squared error of sines."
    )
    return MethodResult(METHOD, SOURCE, index, LIMITS[1], says, detail)
