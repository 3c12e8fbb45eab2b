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

import numpy as np
from numpy.typing import ArrayLike, NDArray

DAYS_A_YEAR = 365.25
#: Changes are expected to be about so many times the scatter of the days, squared.
EXPECTED = 4.0
# commissioning days without which the scatter is not known
FEWEST = 5
SHAPES = ("step", "ramp")


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
    table = table[:, None] if table.ndim == 1 else table
    n, many = table.shape
    evidence, onset = np.zeros(n), np.full(n, -1)
    which = np.full((n, 2), -1)
    best = np.zeros(n)
    if commissioned >= n:
        return evidence, onset, which
    for j in range(many):
        for k, shape in enumerate(SHAPES):
            factors = np.exp(np.minimum(_log_factors(table[:, j], commissioned, shape), 600.0))
            # one after the other, so that later days, whose factors are zero, change no digit
            evidence += factors.cumsum(axis=1)[:, -1] / (many * len(SHAPES))
            top = factors.max(axis=1, initial=0.0)
            better = top > best
            best = np.where(better, top, best)
            onset = np.where(better, commissioned + factors.argmax(axis=1), onset)
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
    sound = series[:commissioned]
    scale = np.nanstd(sound, ddof=1) if np.isfinite(sound).sum() > 1 else 0.0
    sums, up, down = np.zeros(len(series)), 0.0, 0.0
    if scale <= 0.0:
        return sums
    away = np.nan_to_num((series - np.nanmean(sound)) / scale)
    for d in range(commissioned, len(series)):
        up = max(up + away[d] - allowance, 0.0)
        down = max(down - away[d] - allowance, 0.0)
        sums[d] = max(up, down)
    return sums


def _log_factors(series: NDArray, commissioned: int, shape: str) -> NDArray:
    """Log Bayes factors [day, onset - commissioned] of changes of one shape; -inf before the onset."""
    n = len(series)
    days = np.arange(n)
    onsets = days[commissioned:]
    out = np.full((n, len(onsets)), -np.inf)
    seen = np.isfinite(series)
    if seen[:commissioned].sum() < FEWEST:
        return out
    # about the sound mean, so that a large zero costs no digits
    y = np.where(seen, series - np.nanmean(series[:commissioned]), 0.0)
    count = np.cumsum(seen)
    total, square = np.cumsum(y), np.cumsum(y * y)
    left = np.maximum(square - total**2 / count.clip(1), 1e-300)
    form = _shape(days, onsets, shape) * seen[:, None]
    mean_form = np.cumsum(form, axis=0) / count.clip(1)[:, None]
    own = np.cumsum(form**2, axis=0) - count[:, None] * mean_form**2
    product = np.cumsum(form * y[:, None], axis=0) - mean_form * total[:, None]
    explained = product**2 / (own + 1.0 / EXPECTED)
    remaining = np.maximum(left[:, None] - explained, 1e-12 * left[:, None])
    factors = -0.5 * np.log1p(EXPECTED * own)
    factors += 0.5 * (count[:, None] - 1) * np.log(left[:, None] / remaining)
    begun = days[:, None] >= onsets
    return np.where(begun, factors, -np.inf)


def _shape(days: NDArray, onsets: NDArray, shape: str) -> NDArray:
    """A step of 1, or a ramp that gains 1 in ten days, from each onset on."""
    since = days[:, None] - onsets
    if shape == "step":
        return (since >= 0).astype(float)
    return np.maximum(since + 1, 0) / 10.0
