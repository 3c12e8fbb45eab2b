# SPDX-License-Identifier: BSD-3-Clause
r"""Evidence, day after day, that a valve has changed: bounded in how often it calls without a reason.

A series holds one number a day, such as the size of an effect. While nothing changes, its days scatter about
one mean. After a change at day :math:`k` they follow :math:`\mu + \delta\,h_k(d)`, a step or a ramp. For
every :math:`k` and both shapes the evidence is the Bayes factor

.. math::

    B = (1 + g s)^{-1/2} \left( \frac{R_0}{R_1} \right)^{(n - 1) / 2},
    \qquad R_1 = R_0 - \frac{b^2}{s + 1 / g}

with :math:`R_0` the sum of squares about the mean, :math:`s` and :math:`b` the shape's own sum of squares and
its product with the days, both about the mean, and :math:`\delta \sim N(0, g \sigma^2)`. Mean and scatter
have the invariant prior, so neither has to be known. While days are independent and normal its expectation is
1 on every day, whenever one stops: an e-process.

The detector is the sum over all :math:`k` behind the commissioning (Shiryaev and Roberts). Its expectation
grows by 1 a day while nothing changes, so that it reaches a limit :math:`A` after at least :math:`A` days on
average: one false call in :math:`A` valve-days at most.

References
----------
Shin, Ramdas and Rinaldo (2024), E-detectors: a nonparametric framework for sequential change detection. New
England Journal of Statistics in Data Science.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import ArrayLike, NDArray

DAYS_A_YEAR = 365.25
#: Changes are expected to be about so many times the scatter of the days, squared.
EXPECTED = 4.0
# commissioning days without which the scatter is not known
FEWEST = 5
SHAPES = ("step", "ramp")
# of the logarithm of a Bayes factor, so that none overflows
_LARGEST = 600.0


def limit_of(false_calls: float) -> float:
    """Limit of the detector for a rate of false calls, however many series it is the mean of.

    Parameters
    ----------
    false_calls : float
        Most false calls a valve-year.

    Returns
    -------
    limit : float
        Days between false calls, at least.

    Examples
    --------
    >>> from sklvalve.watch import limit_of
    >>> limit_of(0.05)
    7305.0
    """
    return DAYS_A_YEAR / false_calls


def detector(values: ArrayLike, commissioned: int) -> tuple[NDArray, NDArray, NDArray]:
    """Evidence for a change after commissioning, on every day.

    Parameters
    ----------
    values : array-like of shape (n,) or (n, m)
        Series of `m` numbers a day; NaN on days without data.
    commissioned : int
        Days in which nothing changes.

    Returns
    -------
    evidence : ndarray of shape (n,)
        Mean of the detectors of all series; 0 during commissioning.
    onset : ndarray of int, shape (n,)
        Likeliest first day of a change; -1 where there is no evidence.
    which : ndarray of int, shape (n, 2)
        Series and shape (index of `SHAPES`) that have most of the evidence; -1 where there is none.
    """
    table = np.asarray(values, dtype=float)
    table = np.ascontiguousarray(table[:, None] if table.ndim == 1 else table)
    n, many = table.shape
    evidence, onset, which = np.zeros(n), np.full(n, -1), np.full((n, len(SHAPES)), -1)
    best = np.zeros(n)
    for j, series in enumerate(table.T):
        for k, shape in enumerate(SHAPES):
            total, top, first = _factors(np.ascontiguousarray(series), commissioned, shape == "ramp")
            evidence += total / (many * len(SHAPES))
            better = top > best
            best, onset = np.where(better, top, best), np.where(better, first, onset)
            which[better] = j, k
    return evidence, onset, which


def cusum(values: ArrayLike, commissioned: int, allowance: float = 0.5) -> NDArray:
    """Two-sided cumulative sum of a series, the field's own measure beside the evidence.

    Parameters
    ----------
    values : array-like of shape (n,)
    commissioned : int
        Days whose mean and scatter the others are measured by.
    allowance : float, default=0.5
        Scatters by which a day may deviate before it adds up; half of the change that is looked for.

    Returns
    -------
    sums : ndarray of shape (n,)
        The larger of the two sums, in scatters; 0 during commissioning. 5 is reached about once in 930 days
        while nothing changes, were mean and scatter known.

    References
    ----------
    Montgomery (2019), Introduction to Statistical Quality Control, 8th edition, section 9.1.
    """
    series = np.asarray(values, dtype=float)
    # about the first day, so that equal days have no scatter
    series = series - (series[np.argmax(np.isfinite(series))] if len(series) else 0.0)
    sound = series[:commissioned]
    scale = np.nanstd(sound, ddof=1) if np.isfinite(sound).sum() > 1 else 0.0
    if scale <= 0.0:
        return np.zeros(len(series))
    return _both_sides(np.nan_to_num((series - np.nanmean(sound)) / scale), commissioned, allowance)


@nb.njit(cache=True)
def _both_sides(away, commissioned, allowance):
    """The larger of the sums of days above and below, each less an allowance."""
    sums, up, down = np.zeros(len(away)), 0.0, 0.0
    for d in range(commissioned, len(away)):
        up = max(up + away[d] - allowance, 0.0)
        down = max(down - away[d] - allowance, 0.0)
        sums[d] = max(up, down)
    return sums


@nb.njit(cache=True, error_model="numpy")
def _factors(series, commissioned, ramp):
    """Bayes factors of changes of one shape, day by day: their sum over all onsets, the largest, and whose.

    A step is of 1; a ramp gains 1 in ten days.
    """
    n = len(series)
    sums, largest, first = np.zeros(n), np.zeros(n), np.full(n, -1)
    seen = np.isfinite(series)
    if seen[:commissioned].sum() < FEWEST:
        return sums, largest, first
    # about the first day, so that a large zero costs no digits and equal days are zero
    y = np.where(seen, series - series[np.argmax(seen)], 0.0)
    count = np.cumsum(seen)
    per_count, mean = 1.0 / count, np.cumsum(y) / count
    # one over the sum of squares about the mean
    per_left = 1.0 / np.maximum(np.cumsum(y * y) - count * mean**2, 1e-300)
    for k in range(commissioned, n):
        form, form_squared, form_of_days = 0.0, 0.0, 0.0
        # onset after onset, so that later days change no digit of earlier ones
        for d in range(k, n):
            if seen[d]:
                height = (d - k + 1) / 10.0 if ramp else 1.0
                form += height
                form_squared += height * height
                form_of_days += height * y[d]
            own = form_squared - form * form * per_count[d]
            product = form_of_days - form * mean[d]
            remaining = max(1.0 - product * product / (own + 1.0 / EXPECTED) * per_left[d], 1e-12)
            told = -0.5 * (count[d] - 1) * np.log(remaining)
            factor = np.exp(min(told, _LARGEST)) / np.sqrt(1.0 + EXPECTED * own)
            sums[d] += factor
            if factor > largest[d]:
                largest[d], first[d] = factor, k
    return sums, largest, first
