# SPDX-License-Identifier: BSD-3-Clause
"""Half periods of the value: a relay's answer, triangles or sines (Rossi and Scali)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from sklvalve.mismatch.loop.constants import RELAY_LIMITS, ROWS_OF_A_SHAPE
from sklvalve.mismatch.loop.methods.cycles import (
    POINTS,
    control_error,
    half_periods,
    residual_squares,
    sines,
    too_few,
    triangles,
)
from sklvalve.mismatch.loop.methods.result import Method, MethodResult, by_limits
from sklvalve.mismatch.loop.oscillation import Oscillation

_METHOD = Method(
    "relay fitting",
    "Rossi and Scali 2005, Journal of Process Control 15, 505-514",
    RELAY_LIMITS[1],
    ROWS_OF_A_SHAPE,
)
_LAGS = np.geomspace(0.02, 3.0, 24)  # of a half period: from a square wave to nearly straight flanks


def relay(value: ArrayLike, oscillation: Oscillation, *, setpoint: ArrayLike | None = None) -> MethodResult:
    r"""Compare a relay's answer and triangles with sines on the half periods of the value.

    .. math:: S = \frac{E_\text{sin} - E_\text{rt}}{E_\text{sin} + E_\text{rt}}

    with the mean squared errors of the best sine and of the better of the two other families: triangles with
    a free peak, and the answer of a first-order lag with dead time to a relay (exponential flanks, any lag).

    Valid for a regular oscillation of ten rows or more in a period. A square wave from outside is called
    stiction too.

    Parameters
    ----------
    value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        Of the value's unit; where it is given, the error takes the place of the value.

    Returns
    -------
    result : MethodResult

    References
    ----------
    M. Rossi, C. Scali, A comparison of techniques for automatic detection of stiction: simulation and
    application to industrial data, Journal of Process Control 15 (2005) 505-514.
    """
    obstacle, rows = _METHOD.obstacle(oscillation), oscillation.rows or 0.0
    if rows < _METHOD.fewest_rows:
        return _METHOD.not_applicable(obstacle)
    shapes = half_periods(control_error(value, setpoint), rows)
    if few := too_few("value", shapes):
        return _METHOD.not_applicable(few)
    families = sines(), _RELAYS, triangles()
    sine, answer, triangle = (residual_squares(shapes, each).mean() for each in families)
    other = min(answer, triangle)
    index = float((sine - other) / max(sine + other, 1e-300))
    best = "answers of a relay" if answer <= triangle else "triangles"
    detail = (
        f"Of the value's {len(shapes)} half periods, {best} leave {other / max(sine, 1e-300):.2g} times the "
        "squared error of sines."
    )
    return _METHOD.result(index, by_limits(index, *RELAY_LIMITS), detail, obstacle)


def relays(lags: NDArray) -> NDArray:
    """Half periods of a first-order lag behind a relay with dead time, from zero to zero.

    The value rises as ``1 - exp(-t / lag)`` to the switch, then falls to zero as
    ``(1 + peak) exp(-t / lag) - 1``; the switch lies where both take the whole half period.

    Parameters
    ----------
    lags : ndarray of shape (m,)
        Lag [half periods].

    Returns
    -------
    shapes : ndarray of shape (m, POINTS)
    """
    at = np.linspace(0.0, 1.0, POINTS)
    out = np.empty((len(lags), POINTS))
    for place, lag in enumerate(lags):
        switch = brentq(lambda s, lag=lag: s + lag * np.log(2.0 - np.exp(-s / lag)) - 1.0, 0.0, 1.0)
        peak = 1.0 - np.exp(-switch / lag)
        falling = (1.0 + peak) * np.exp(-np.maximum(at - switch, 0.0) / lag) - 1.0
        out[place] = np.where(at <= switch, 1.0 - np.exp(-at / lag), falling)
    return out


_RELAYS = relays(_LAGS)
