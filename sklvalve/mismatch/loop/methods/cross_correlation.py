# SPDX-License-Identifier: BSD-3-Clause
"""Cross-correlation of command and value, odd or even (Horch)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.mismatch.loop.constants import HEIGHT_LIMITS, LAG_LIMITS
from sklvalve.mismatch.loop.methods.filters import low_passed, without_drift
from sklvalve.mismatch.loop.methods.result import SOUND, STICTION, UNDECIDED, Method, MethodResult
from sklvalve.mismatch.loop.oscillation import Oscillation, zero_crossings

_METHOD = Method("cross-correlation", "Horch 1999, doi 10.1016/S0967-0661(99)00100-8", LAG_LIMITS[1], 4.0)
_ROWS = 40.0  # kept of a period


def cross_correlation(
    command: ArrayLike, value: ArrayLike, oscillation: Oscillation, *, is_flow: bool | None = None
) -> MethodResult:
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
    obstacle, rows = _METHOD.obstacle(oscillation), oscillation.rows or 0.0
    if rows < _METHOD.fewest_rows:
        return _METHOD.not_applicable(obstacle)
    if is_flow is False:
        obstacle = obstacle or "The process may integrate, and the method is for self-regulating ones."
    every = max(1, int(rows / _ROWS))
    first, second = (low_passed(without_drift(each, rows), 0.4 / every)[::every] for each in (command, value))
    ratios = _ratios(first, second, int(np.ceil(rows / every)))
    if ratios is None:
        return _METHOD.result(None, UNDECIDED, "Command and value are not correlated within a period.")
    lags, heights = ratios
    detail = (
        f"The ratio of lags is {lags:.2f} (stiction above {LAG_LIMITS[1]:.2f}) and the ratio of heights "
        f"{heights:.2f} (stiction above {HEIGHT_LIMITS[1]:.2f})."
    )
    return _METHOD.result(lags, _says(lags, heights), detail, obstacle)


def _says(lags: float, heights: float) -> str:
    """Stiction or none where both ratios agree."""
    if lags > LAG_LIMITS[1] and heights > HEIGHT_LIMITS[1]:
        return STICTION
    return SOUND if lags <= LAG_LIMITS[0] and heights <= HEIGHT_LIMITS[0] else UNDECIDED


def _ratios(first: NDArray, second: NDArray, most: int) -> tuple[float, float] | None:
    """Ratios of lags and of heights, or None without a zero crossing on either side."""
    most = min(most, len(first) - 2)
    padded = np.concatenate([np.zeros(most), second, np.zeros(most)])
    correlation = np.correlate(padded, first, mode="valid")  # lags -most to most
    scale = np.sqrt((first @ first) * (second @ second))
    if scale <= 0.0:
        return None
    correlation = correlation / scale
    crossings = zero_crossings(correlation) - most
    before, after = crossings[crossings <= 0.0], crossings[crossings > 0.0]
    if not len(before) or not len(after):
        return None
    left, right = -before[-1], after[0]
    lags = np.arange(-most, most + 1)
    here = abs(correlation[most])
    best = max(here, float(np.abs(correlation[(lags >= -left) & (lags <= right)]).max()))
    return float(abs(left - right) / max(left + right, 1e-12)), float((best - here) / max(best + here, 1e-12))
