# SPDX-License-Identifier: BSD-3-Clause
"""Areas before and after the peak of each half period of the value (Singhal and Salsbury)."""

import numpy as np

from sklvalve.mismatch.loop.methods.cycles import POINTS, half_periods
from sklvalve.mismatch.loop.methods.result import (
    NOT_APPLICABLE,
    SOUND,
    STICTION,
    UNDECIDED,
    MethodResult,
    why_not_applicable,
)

METHOD = "peak area"
SOURCE = "Singhal and Salsbury 2005, Journal of Process Control 15, 371-382"
LIMIT = 1.0  # published: above stiction, else an aggressive controller
_FEWEST_ROWS = 10.0
_FEWEST_HALVES = 4
_SURE = 2.0  # standard errors of the mean from the limit; nearer is undecided


def area(command, value, oscillation, *, setpoint=None, is_flow=None):
    r"""Compare the areas of the error before and after its peak.

    .. math:: R = A_1 / A_2

    A value behind a valve that jumps and stays rises to its peak for longer than it falls from it, so that
    the area before the peak is the larger; a controller that is too aggressive gives sines, R = 1. R is the
    geometric mean over the half periods.

    Valid for self-regulating processes that oscillate regularly, ten rows or more in a period.

    Parameters
    ----------
    command : array-like of shape (n,)
        Not used; the methods share one form.
    value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        The error is looked at where it is given.
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
    why = why_not_applicable(oscillation, _FEWEST_ROWS)
    if oscillation.rows is None or oscillation.rows < _FEWEST_ROWS:
        return MethodResult(METHOD, SOURCE, None, LIMIT, NOT_APPLICABLE, why)
    signal = value if setpoint is None else np.asarray(value, float) - np.asarray(setpoint, float)
    shapes = half_periods(signal, oscillation.rows)
    if len(shapes) < _FEWEST_HALVES:
        why = f"The value has {len(shapes)} whole half periods, and {_FEWEST_HALVES} are needed."
        return MethodResult(METHOD, SOURCE, None, LIMIT, NOT_APPLICABLE, why)
    if is_flow is False:
        why = why or "The process may integrate, and the method is for self-regulating ones."
    ratios = np.log(_ratios(shapes))
    mean, error = float(ratios.mean()), float(ratios.std(ddof=1) / np.sqrt(len(ratios)))
    says = STICTION if mean > _SURE * error else SOUND if mean < -_SURE * error else UNDECIDED
    detail = why or (
        f"The area before the peak is {np.exp(mean):.2f} times that after it, in the mean of {len(shapes)} "
        "half periods."
    )
    return MethodResult(METHOD, SOURCE, float(np.exp(mean)), LIMIT, NOT_APPLICABLE if why else says, detail)


def _ratios(shapes):
    """Area before over area after the peak of each shape, the peak's own point shared."""
    up = np.maximum(shapes, 0.0)
    peaks = np.clip(up.argmax(axis=1), 1, POINTS - 2)
    at = np.arange(POINTS)
    weights = np.where(at < peaks[:, None], 1.0, np.where(at == peaks[:, None], 0.5, 0.0))
    before, after = (up * weights).sum(axis=1), (up * (1.0 - weights)).sum(axis=1)
    return np.maximum(before, 1e-300) / np.maximum(after, 1e-300)
