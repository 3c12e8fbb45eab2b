# SPDX-License-Identifier: BSD-3-Clause
"""Likelihood of the parts of a noise, with its slopes, and the likeliest parts within bounds.

The noise is white noise, a quick part and a wander (Ornstein-Uhlenbeck processes), filtered by Kalman. The
slopes are carried along in the same pass as the likelihood (forward mode), so a fit takes some thirty passes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba as nb
import numpy as np
from scipy.optimize import OptimizeResult, minimize

#: Parts of a noise, in the order in which all of this module takes them.
PARTS = ("base", "share", "timing", "fast_time", "fast", "slow_time", "slow")
_MANY = len(PARTS)

_BASE, _SHARE, _TIMING, _FAST_TIME, _FAST, _SLOW_TIME, _SLOW = range(_MANY)
# a part of so small a share of its usual size is as good as none, and none is so many times as large
_AS_GOOD_AS_NONE, _LARGEST = 1e-7, 1e12
# of the logarithms: weak priors keep parts that are not there from running off. With 5 four of twelve hard
# records had a wrong name more
_SPREAD = 2.0
_OPTIONS = {"maxiter": 60, "ftol": 1e-7}
# logarithms beside those of the usual parts at which the ascent begins: noise that grows with the signal, and
# a wander that is quick and large. With a spread of 5, of 556 fits one ended lower from there than a simplex
# did by more than 1; from the usual parts a third do
_BEGINNING = np.zeros(_MANY)
_BEGINNING[[_SHARE, _SLOW_TIME, _SLOW]] = np.log([100.0, 0.01, 10.0])


@nb.njit(cache=True, nogil=True, fastmath={"contract"})
def loss_and_slopes(
    parts: np.ndarray, residuals: np.ndarray, step: np.ndarray, level: np.ndarray, moving: np.ndarray
) -> tuple[float, np.ndarray]:
    """Negative robust log likelihood of residuals, and its derivatives by the parts.

    The white variance of a row is ``base + share level + timing moving``. A row costs
    ``9 (sqrt(1 + i**2 / 9) - 1) + log(v) / 2`` with its innovation i in standard deviations, and v the
    innovation's variance.

    Parameters
    ----------
    parts : ndarray of shape (7,)
        Variances, and correlation times [s], in the order of `PARTS`.
    residuals, step, level, moving : ndarray of shape (n,)
        Residuals with NaN in gaps, time since the row before [s], and what `share` and `timing` multiply.

    Returns
    -------
    loss : float
    slopes : ndarray of shape (7,)
    """
    fast_time, fast, slow_time, slow = parts[3], parts[4], parts[5], parts[6]
    # variances of the two parts and their covariance, their means, and the derivatives of all
    p11, p12, p22, f, s = fast, 0.0, slow, 0.0, 0.0
    d11, d12, d22 = np.zeros(_MANY), np.zeros(_MANY), np.zeros(_MANY)
    df, ds, dv, slopes = np.zeros(_MANY), np.zeros(_MANY), np.zeros(_MANY), np.zeros(_MANY)
    d11[_FAST] = d22[_SLOW] = 1.0
    a = b = da = db = last = total = 0.0
    product = 1.0
    for k in range(len(residuals)):
        if step[k] != last:
            last = step[k]
            a, b = np.exp(-last / fast_time), np.exp(-last / slow_time)
            da, db = a * last / fast_time**2, b * last / slow_time**2
        # a step ahead: the last terms are those of the part itself
        aa, ab, bb = a * a, a * b, b * b
        for i in range(_MANY):
            d11[i] *= aa
            d12[i] *= ab
            d22[i] *= bb
            df[i] *= a
            ds[i] *= b
        d11[_FAST_TIME] += 2.0 * a * da * (p11 - fast)
        d22[_SLOW_TIME] += 2.0 * b * db * (p22 - slow)
        d12[_FAST_TIME] += da * b * p12
        d12[_SLOW_TIME] += a * db * p12
        df[_FAST_TIME] += da * f
        ds[_SLOW_TIME] += db * s
        d11[_FAST] += 1.0 - aa
        d22[_SLOW] += 1.0 - bb
        p11 = aa * p11 + (1.0 - aa) * fast
        p22 = bb * p22 + (1.0 - bb) * slow
        p12 *= ab
        f *= a
        s *= b
        e = residuals[k]
        if e != e:
            continue
        # what the row itself tells
        v = p11 + 2.0 * p12 + p22 + parts[0] + parts[1] * level[k] + parts[2] * moving[k]
        inverse = 1.0 / v
        of_fast, of_slow = (p11 + p12) * inverse, (p12 + p22) * inverse
        left = e - f - s
        for i in range(_MANY):
            dv[i] = d11[i] + 2.0 * d12[i] + d22[i]
        dv[_BASE] += 1.0
        dv[_SHARE] += level[k]
        dv[_TIMING] += moving[k]
        square = left * left * inverse
        root = np.sqrt(1.0 + square / 9.0)
        by_left, by_v = left * inverse / root, 0.5 * inverse * (1.0 - square / root)
        for i in range(_MANY):
            away = -df[i] - ds[i]
            slopes[i] += by_left * away + by_v * dv[i]
            by_fast, by_slow = d11[i] + d12[i], d12[i] + d22[i]
            # of the gains, times v
            d_fast, d_slow = by_fast - of_fast * dv[i], by_slow - of_slow * dv[i]
            df[i] += d_fast * inverse * left + of_fast * away
            ds[i] += d_slow * inverse * left + of_slow * away
            d11[i] -= of_fast * (by_fast + d_fast)
            d12[i] -= of_fast * by_slow + of_slow * d_fast
            d22[i] -= of_slow * (by_slow + d_slow)
        total += 9.0 * (root - 1.0)
        product *= v
        if product < 1e-200 or product > 1e200:
            total += 0.5 * np.log(product)
            product = 1.0
        f += of_fast * left
        s += of_slow * left
        p11 -= of_fast * of_fast * v
        p12 -= of_fast * of_slow * v
        p22 -= of_slow * of_slow * v
    return total + 0.5 * np.log(product), slopes


@dataclass(frozen=True)
class Bounds:
    """Where the parts of a noise may lie.

    Parameters
    ----------
    least, most : ndarray of shape (7,)
        In the order of `PARTS`; zero and infinity where there is no bound.
    """

    least: np.ndarray
    most: np.ndarray


def likeliest(usual: np.ndarray, bounds: Bounds, fixed: float, rows: tuple[np.ndarray, ...]) -> np.ndarray:
    """Parts of the largest posterior: the likelihood, and a weak prior about usual parts.

    Parameters
    ----------
    usual : ndarray of shape (7,)
        Where the prior stands: the logarithm of each part has a standard deviation of 2 about its logarithm.
    bounds : Bounds
    fixed : float
        White variance that is there beside `base`.
    rows : tuple of ndarray
        Residuals, step, level, moving, as `loss_and_slopes` takes them.

    Returns
    -------
    parts : ndarray of shape (7,)
        Those at a bound exactly there.

    Notes
    -----
    The likelihood has more than one summit, so there are two ascents; the higher summit is taken.
    """
    centre = np.log(usual)
    high = np.log(np.minimum(bounds.most, usual * _LARGEST))
    low = np.log(np.maximum(bounds.least, usual * _AS_GOOD_AS_NONE))
    low = np.minimum(low, high)

    def cost(logs: np.ndarray) -> tuple[float, np.ndarray]:
        parts = np.exp(logs)
        whole = parts.copy()
        whole[_BASE] += fixed
        loss, slopes = loss_and_slopes(whole, *rows)
        away = (logs - centre) / _SPREAD
        return loss + 0.5 * float(away @ away), slopes * parts + away / _SPREAD

    def least_from(logs: np.ndarray) -> OptimizeResult:
        begin, within = np.clip(logs, low, high), np.stack([low, high], axis=1)
        return minimize(cost, begin, method="L-BFGS-B", jac=True, bounds=within, options=_OPTIONS)

    found = least_from(centre + _BEGINNING)
    # a wander at one end of its times may be likelier at the other
    other = found.x.copy()
    other[_SLOW_TIME] = low[_SLOW_TIME] + high[_SLOW_TIME] - other[_SLOW_TIME]
    logs = min(found, least_from(other), key=lambda each: each.fun).x
    parts = np.where(logs >= high, bounds.most, np.exp(logs))
    return np.where(logs <= low, bounds.least, parts)
