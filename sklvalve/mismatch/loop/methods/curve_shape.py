# SPDX-License-Identifier: BSD-3-Clause
"""Half periods of the integrated signal: triangles or sines (He et al.)."""

from numpy.typing import ArrayLike

from sklvalve.mismatch.loop.constants import CURVE_LIMITS, ROWS_OF_A_SHAPE
from sklvalve.mismatch.loop.methods.cycles import half_periods, residual_squares, sines, too_few, triangles
from sklvalve.mismatch.loop.methods.result import Method, MethodResult, by_limits
from sklvalve.mismatch.loop.oscillation import Oscillation

_METHOD = Method(
    "curve fitting",
    "He, Wang, Pottmann and Qin 2007, doi 10.1021/ie061219a",
    CURVE_LIMITS[1],
    ROWS_OF_A_SHAPE,
)


def curve_shape(
    command: ArrayLike, value: ArrayLike, oscillation: Oscillation, *, is_flow: bool | None = None
) -> MethodResult:
    r"""Compare triangles and sines on the half periods of the first integrated signal behind the valve.

    .. math:: SI = \frac{MSE_\text{sin}}{MSE_\text{sin} + MSE_\text{tri}}

    A valve that jumps sends steps into the process. The first integrator behind it makes triangles of them:
    the controller (its command counts) for a self-regulating process, the process itself (its value counts)
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
        False takes the value (a process that integrates), else the command is taken.

    Returns
    -------
    result : MethodResult

    References
    ----------
    Q. P. He, J. Wang, M. Pottmann, S. J. Qin, A curve fitting method for detecting valve stiction in
    oscillating control loops, Industrial and Engineering Chemistry Research 46 (2007) 4549-4560.
    """
    obstacle, rows = _METHOD.obstacle(oscillation), oscillation.rows or 0.0
    if rows < _METHOD.fewest_rows:
        return _METHOD.not_applicable(obstacle)
    name, signal = ("value", value) if is_flow is False else ("command", command)
    shapes = half_periods(signal, rows)
    if few := too_few(name, shapes):
        return _METHOD.not_applicable(few)
    sine, triangle = (residual_squares(shapes, each).sum() for each in (sines(), triangles()))
    index = float(sine / max(sine + triangle, 1e-300))
    detail = (
        f"Triangles fit the {name}'s {len(shapes)} half periods with {triangle / max(sine, 1e-300):.2g} "
        "times the squared error of sines."
    )
    return _METHOD.result(index, by_limits(index, *CURVE_LIMITS), detail, obstacle)
