# SPDX-License-Identifier: BSD-3-Clause
"""Two-parameter stiction before a linear process, by least prediction error (Jelali; Lee, Ren and Huang)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.mismatch.loop.methods.result import SOUND, STICTION, Method, MethodResult
from sklvalve.mismatch.loop.operators import JUMPS, SHARES, stick_slip
from sklvalve.mismatch.loop.oscillation import Oscillation
from sklvalve.mismatch.loop.signals import block_means, span_of

_NAME = "Hammerstein fit"
_SOURCE = "Jelali 2008, doi 10.1016/j.jprocont.2007.11.004; Lee, Ren and Huang 2008"
_ORDER = 3  # lags of the value and of the stem
_DELAYS = 6  # dead times tried [rows kept]
_ROWS = 20.0  # kept of a period
_MOST = 3000  # rows kept
_FEWEST = 60
_FINER = np.geomspace(0.8, 1.25, 7)  # of the best band of the grid
_FINER_JUMPS = (0.0, 0.15, 0.3, 0.5, 0.7, 0.85, 1.0)


def hammerstein(command: ArrayLike, value: ArrayLike, oscillation: Oscillation) -> MethodResult:
    r"""Fit stick-slip and a linear process to the value, and compare with the linear process alone.

    .. math:: A(q)\, y_k = B(q)\, x_{k-d} + c + e_k, \quad x = \text{stick-slip}(u; S, J)

    S and J over a grid, then a finer one around the best; the process has three lags of value and stem, dead
    time d of one row to six, all by least squares. The statistic is the gain in log likelihood over the
    command itself, ``n / 2 log(s0 / s1)``; the limit is that of the Bayesian information criterion for two
    parameters, ``log n``. The papers call stiction where the best S is not zero, which noise makes nearly
    always so.

    Valid for a process that is linear over the record; it needs no regular oscillation. Outside oscillations
    and an order too low make bands that are not there.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
        Long periods are thinned to 20 rows.

    Returns
    -------
    result : MethodResult
        `band` is S [command's unit].

    References
    ----------
    M. Jelali, Estimation of valve stiction in control loops using separable least-squares and global search
    algorithms, Journal of Process Control 18 (2008) 632-642. K. H. Lee, Z. Ren, B. Huang, Novel closed-loop
    stiction detection and quantification method via system identification, ADCONIP, Jasper, 2008.
    """
    command, value = np.asarray(command, dtype=float), np.asarray(value, dtype=float)
    span = span_of(command)
    every = max(1, int((oscillation.rows or 0.0) / _ROWS), -(-len(command) // _MOST))
    count = len(command) // every
    if span <= 0.0 or np.ptp(value) <= 0.0 or count < _FEWEST:
        why = "Command or value does not move." if count >= _FEWEST else f"Only {count} rows are kept."
        return Method(_NAME, _SOURCE, float(np.log(max(count, 2)))).not_applicable(why)
    kept, fitted_rows = block_means(value, every), count - _ORDER - _DELAYS
    linear = _residual_squares(kept, block_means(command[None], every))[0]
    least, band, jump = _best_band(command, kept, every, span)
    gain = float(0.5 * fitted_rows * np.log(max(linear, 1e-300) / max(least, 1e-300)))
    method = Method(_NAME, _SOURCE, float(np.log(fitted_rows)))
    detail = (
        f"A band of {band / span:.0%} of the command's movement with a jump of {jump:.0%} of it takes "
        f"{1.0 - least / max(linear, 1e-300):.1%} off the squared prediction error ({gain:.0f} nats)."
    )
    if gain > method.limit:
        return method.result(gain, STICTION, detail, band=float(band))
    return method.result(gain, SOUND, detail)


def _best_band(command: NDArray, kept: NDArray, every: int, span: float) -> tuple[float, float, float]:
    """Least sum of squares over a grid and a finer one around its best, the band and its share that jumps."""
    sizes = np.array([(share * span, jump) for share in SHARES for jump in JUMPS])
    for _ in range(2):
        stems = stick_slip(command, sizes[:, 0], sizes[:, 0] * sizes[:, 1])
        squares = _residual_squares(kept, block_means(stems, every))
        best = int(squares.argmin())
        least, (band, jump) = squares[best], sizes[best]
        sizes = np.array([(band * factor, share) for factor in _FINER for share in _FINER_JUMPS])
    return least, band, jump


def _residual_squares(value: NDArray, stems: NDArray) -> NDArray:
    """Least sum of squared prediction errors of the value, for each stem, over dead times.

    Parameters
    ----------
    value : ndarray of shape (n,)
    stems : ndarray of shape (m, n)

    Returns
    -------
    squares : ndarray of shape (m,)
        [value's unit squared]
    """
    first = _ORDER + _DELAYS
    rows = np.arange(first, len(value))
    known = np.column_stack([np.ones(len(rows)), *(value[rows - lag] for lag in range(1, _ORDER + 1))])
    basis = np.linalg.qr(known)[0]
    target = value[rows] - basis @ (basis.T @ value[rows])
    lags = np.arange(1, first)
    windows = stems[:, rows[None] - lags[:, None]]
    windows = windows - (windows @ basis) @ basis.T
    gram = windows @ windows.transpose(0, 2, 1)
    moment = windows @ target
    best = np.full(len(stems), target @ target)
    for delay in range(_DELAYS):
        used = slice(delay, delay + _ORDER)
        inner = gram[:, used, used]
        scale = np.trace(inner, axis1=1, axis2=2)[:, None, None]
        ridge = 1e-10 * scale * np.eye(_ORDER) + 1e-300 * np.eye(_ORDER)
        weights = np.linalg.solve(inner + ridge, moment[:, used, None])[..., 0]
        best = np.minimum(best, target @ target - (weights * moment[:, used]).sum(axis=1))
    return np.maximum(best, 0.0)
