# SPDX-License-Identifier: BSD-3-Clause
"""Cross-correlation of command and value, odd or even (Horch)."""

import numpy as np

from sklvalve.mismatch.loop.methods.cycles import low_passed, without_drift
from sklvalve.mismatch.loop.methods.result import (
    NOT_APPLICABLE,
    SOUND,
    STICTION,
    UNDECIDED,
    MethodResult,
    why_not_applicable,
)

METHOD = "cross-correlation"
SOURCE = "Horch 1999, doi 10.1016/S0967-0661(99)00100-8"
LAG_LIMITS = (1.0 / 3.0, 2.0 / 3.0)  # of the ratio of lags: phase shifts of 30 and 60 degrees off even
HEIGHT_LIMITS = ((2.0 - 3.0**0.5) / (2.0 + 3.0**0.5), 1.0 / 3.0)  # the same shifts, in the ratio of heights
_FEWEST_ROWS = 4.0
_ROWS = 40.0  # kept of a period


def cross_correlation(command, value, oscillation, *, is_flow=None):
    r"""Tell stiction from an outside oscillation by the phase between command and value.

    .. math::
        \Delta\tau = \frac{|\tau_l - \tau_r|}{\tau_l + \tau_r}, \quad
        \Delta\rho = \frac{|r_0 - r_\text{opt}|}{|r_0 + r_\text{opt}|}

    from the zero crossings of the cross-correlation either side of lag zero, its height there and its
    greatest height between. Odd (both ratios large) is stiction, even is an outside oscillation or bad
    tuning: a self-regulating process behind a stuck valve under integral action swings a quarter of a period
    off. The limits are those of pure sines shifted by 30 and 60 degrees.

    Valid for self-regulating processes under PI control that oscillate regularly; not for levels.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    is_flow : bool or None
        False: the process may integrate, and the method does not apply.

    Returns
    -------
    result : MethodResult
        `statistic` is the ratio of lags.

    References
    ----------
    A. Horch, A simple method for detection of stiction in control valves, Control Engineering Practice 7
    (1999) 1221-1231. Limits: A. Horch, Condition Monitoring of Control Loops, thesis, KTH Stockholm, 2000.
    """
    why = why_not_applicable(oscillation, _FEWEST_ROWS)
    if oscillation.rows is None or oscillation.rows < _FEWEST_ROWS:
        return MethodResult(METHOD, SOURCE, None, LAG_LIMITS[1], NOT_APPLICABLE, why)
    if is_flow is False:
        why = why or "The process may integrate, and the method is for self-regulating ones."
    every = max(1, int(oscillation.rows / _ROWS))
    rows = oscillation.rows / every
    first, second = (
        low_passed(without_drift(signal, oscillation.rows), 0.4 / every)[::every]
        for signal in (command, value)
    )
    found = _ratios(first, second, int(np.ceil(rows)))
    if found is None:
        why = "Command and value are not correlated within a period."
        return MethodResult(METHOD, SOURCE, None, LAG_LIMITS[1], UNDECIDED, why)
    lags, heights = found
    says = UNDECIDED
    if lags > LAG_LIMITS[1] and heights > HEIGHT_LIMITS[1]:
        says = STICTION
    elif lags <= LAG_LIMITS[0] and heights <= HEIGHT_LIMITS[0]:
        says = SOUND
    detail = why or (
        f"The ratio of lags is {lags:.2f} (stiction above {LAG_LIMITS[1]:.2f}) and the ratio of heights "
        f"{heights:.2f} (stiction above {HEIGHT_LIMITS[1]:.2f})."
    )
    return MethodResult(METHOD, SOURCE, lags, LAG_LIMITS[1], NOT_APPLICABLE if why else says, detail)


def _ratios(first, second, most):
    """Ratios of lags and of heights, or None without a zero crossing on either side."""
    count = len(first)
    most = min(most, count - 2)
    padded = np.concatenate([np.zeros(most), second, np.zeros(most)])
    alike = np.correlate(padded, first, mode="valid")  # lags -most to most
    scale = np.sqrt((first @ first) * (second @ second))
    if scale <= 0.0:
        return None
    alike = alike / scale
    signs = alike > 0.0
    before = np.flatnonzero(signs[1:] != signs[:-1])
    crossings = before + alike[before] / (alike[before] - alike[before + 1]) - most
    left, right = crossings[crossings <= 0.0], crossings[crossings > 0.0]
    if not len(left) or not len(right):
        return None
    left, right = -left[-1], right[0]
    lags = np.arange(-most, most + 1)
    between = np.abs(alike[(lags >= -left) & (lags <= right)])
    here = abs(alike[most])
    best = max(here, float(between.max()))
    return float(abs(left - right) / max(left + right, 1e-12)), float((best - here) / max(best + here, 1e-12))
