# SPDX-License-Identifier: BSD-3-Clause
"""Half periods of the value: a relay's answer, triangles or sines (Rossi and Scali)."""

import numpy as np
from scipy.optimize import brentq

from sklvalve.mismatch.loop.methods.cycles import POINTS, half_periods, left_over, sines, triangles
from sklvalve.mismatch.loop.methods.result import (
    NOT_APPLICABLE,
    MethodResult,
    by_limits,
    why_not_applicable,
)

METHOD = "relay fitting"
SOURCE = "Rossi and Scali 2005, Journal of Process Control 15, 505-514"
LIMITS = (-0.21, 0.21)  # published: below no stiction, above stiction
_FEWEST_ROWS = 10.0
_FEWEST_HALVES = 4
_LAGS = np.geomspace(0.02, 3.0, 24)  # of a half period: from a square wave to nearly straight flanks


def relay(command, value, oscillation, *, setpoint=None):
    r"""Compare a relay's answer and triangles with sines on the half periods of the value.

    .. math:: S = \frac{E_\text{sin} - E_\text{rt}}{E_\text{sin} + E_\text{rt}}

    with the mean squared errors of the best sine and of the better of the two other families: triangles with
    a free peak, and the answer of a first-order lag with dead time to a relay (exponential flanks, any lag).

    Valid for a regular oscillation of ten rows or more in a period. A square wave from outside is called
    stiction too.

    Parameters
    ----------
    command : array-like of shape (n,)
        Not used; the methods share one form.
    value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        The error is looked at where it is given.

    Returns
    -------
    result : MethodResult

    References
    ----------
    M. Rossi, C. Scali, A comparison of techniques for automatic detection of stiction: simulation and
    application to industrial data, Journal of Process Control 15 (2005) 505-514.
    """
    why = why_not_applicable(oscillation, _FEWEST_ROWS)
    if oscillation.rows is None or oscillation.rows < _FEWEST_ROWS:
        return MethodResult(METHOD, SOURCE, None, LIMITS[1], NOT_APPLICABLE, why)
    signal = value if setpoint is None else np.asarray(value, float) - np.asarray(setpoint, float)
    shapes = half_periods(signal, oscillation.rows)
    if len(shapes) < _FEWEST_HALVES:
        why = f"The value has {len(shapes)} whole half periods, and {_FEWEST_HALVES} are needed."
        return MethodResult(METHOD, SOURCE, None, LIMITS[1], NOT_APPLICABLE, why)
    sine = left_over(shapes, sines()).mean()
    answer, triangle = left_over(shapes, _RELAYS).mean(), left_over(shapes, triangles()).mean()
    other = min(answer, triangle)
    index = float((sine - other) / max(sine + other, 1e-300))
    says = by_limits(index, *LIMITS) if why is None else NOT_APPLICABLE
    best = "answers of a relay" if answer <= triangle else "triangles"
    detail = why or (
        f"Of the value's {len(shapes)} half periods, {best} leave {other / max(sine, 1e-300):.2g} times the "
        "squared error of sines."
    )
    return MethodResult(METHOD, SOURCE, index, LIMITS[1], says, detail)


def relays(lags=_LAGS):
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


_RELAYS = relays()
