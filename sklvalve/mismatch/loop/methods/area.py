# SPDX-License-Identifier: BSD-3-Clause
"""Areas before and after the peak of each half period of the value (Singhal and Salsbury)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.mismatch.loop.constants import PEAK_AREA_LIMIT, PEAK_AREA_SURE, ROWS_OF_A_SHAPE
from sklvalve.mismatch.loop.methods.cycles import POINTS, control_error, half_periods, too_few
from sklvalve.mismatch.loop.methods.result import Method, MethodResult, by_limits
from sklvalve.mismatch.loop.oscillation import Oscillation

_METHOD = Method(
    "peak area",
    "Singhal and Salsbury 2005, Journal of Process Control 15, 371-382",
    PEAK_AREA_LIMIT,
    ROWS_OF_A_SHAPE,
)


def area(
    value: ArrayLike,
    oscillation: Oscillation,
    *,
    setpoint: ArrayLike | None = None,
    is_flow: bool | None = None,
) -> MethodResult:
    r"""Compare the areas of the error before and after its peak.

    .. math:: R = A_1 / A_2

    A value behind a valve that jumps and stays rises to its peak for longer than it falls from it, so that
    the area before the peak is the larger; a controller that is too aggressive gives sines, R = 1. R is the
    geometric mean over the half periods.

    Valid for self-regulating processes that oscillate regularly, ten rows or more in a period.

    Parameters
    ----------
    value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        Of the value's unit; where it is given, the error takes the place of the value.
    is_flow : bool or None
        False: the process may integrate, and the method does not apply.

    Returns
    -------
    result : MethodResult

    References
    ----------
    A. Singhal, T. I. Salsbury, A simple method for detecting valve stiction in oscillating control loops,
    Journal of Process Control 15 (2005) 371-382.
    """
    obstacle, rows = _METHOD.obstacle(oscillation), oscillation.rows or 0.0
    if rows < _METHOD.fewest_rows:
        return _METHOD.not_applicable(obstacle)
    shapes = half_periods(control_error(value, setpoint), rows)
    if few := too_few("value", shapes):
        return _METHOD.not_applicable(few)
    if is_flow is False:
        obstacle = obstacle or "The process may integrate, and the method is for self-regulating ones."
    ratios = np.log(_ratios(shapes))
    mean, error = float(ratios.mean()), float(ratios.std(ddof=1) / np.sqrt(len(ratios)))
    return _METHOD.result(
        float(np.exp(mean)),
        by_limits(mean, -PEAK_AREA_SURE * error, PEAK_AREA_SURE * error),
        f"The area before the peak is {np.exp(mean):.2f} times that after it, in the mean of {len(shapes)} "
        "half periods.",
        obstacle,
    )


def _ratios(shapes: NDArray) -> NDArray:
    """Area before over area after the peak of each shape, the peak's own point shared."""
    up = np.maximum(shapes, 0.0)
    peaks = np.clip(up.argmax(axis=1), 1, POINTS - 2)
    at = np.arange(POINTS)
    weights = np.where(at < peaks[:, None], 1.0, np.where(at == peaks[:, None], 0.5, 0.0))
    before, after = (up * weights).sum(axis=1), (up * (1.0 - weights)).sum(axis=1)
    return np.maximum(before, 1e-300) / np.maximum(after, 1e-300)
