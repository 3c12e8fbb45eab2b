# SPDX-License-Identifier: BSD-3-Clause
"""Rates with exact intervals, and other figures with intervals found by drawing the records anew."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.stats import beta, binom

DRAWS = 2000


def exact(count, of):
    """Clopper and Pearson's 95 % interval of a rate, in percent."""
    low = beta.ppf(0.025, count, of - count + 1) if count > 0 else 0.0
    high = beta.ppf(0.975, count + 1, of - count) if count < of else 1.0
    return 100.0 * float(low), 100.0 * float(high)


@dataclass(frozen=True)
class Rate:
    """So many of so many; as text "88 % (81-94)", or "-" of none."""

    count: int
    of: int

    @property
    def value(self):
        """The rate itself, from 0 to 1; not a number where it is of none."""
        return self.count / self.of if self.of else float("nan")

    @property
    def ends(self):
        """Exact 95 % interval, from 0 to 1."""
        low, high = exact(self.count, self.of)
        return low / 100.0, high / 100.0

    def __str__(self):
        """Percent and the ends of the interval, or "-"."""
        if self.of == 0:
            return "-"
        low, high = exact(self.count, self.of)
        # tenths of a percent are noise below a hundred records
        digits = 1 if self.of >= 100 else 0
        return f"{100.0 * self.value:.{digits}f} % ({low:.{digits}f}-{high:.{digits}f})"


@dataclass(frozen=True)
class Estimate:
    """A figure of so many records, with the ends of its 95 % interval where there are any.

    Attributes
    ----------
    value, low, high : float
        Not a number where there is none.
    of : int
        Records that it is made of.
    unit : str
        "%" tells a share in percent; "" tells the number itself.
    digits : int
        Digits after the point.
    """

    value: float
    low: float
    high: float
    of: int
    unit: str = ""
    digits: int = 2

    def __str__(self):
        if not np.isfinite(self.value):
            return "-"
        scale, sign = (100.0, " %") if self.unit == "%" else (1.0, f" {self.unit}" if self.unit else "")
        text = f"{scale * self.value:.{self.digits}f}{sign}"
        if not (np.isfinite(self.low) and np.isfinite(self.high)):
            return text
        dash = "-" if min(self.value, self.low) >= 0.0 else " to "
        return f"{text} ({scale * self.low:.{self.digits}f}{dash}{scale * self.high:.{self.digits}f})"


def rate_of(answers: Iterable[bool | None]):
    """Rate of True among those that are not None."""
    known = [bool(answer) for answer in answers if answer is not None]
    return Rate(sum(known), len(known))


def nothing(unit="", digits=2):
    """The estimate of no records."""
    nan = float("nan")
    return Estimate(nan, nan, nan, 0, unit, digits)


def resampled(columns, statistic: Callable, unit="", digits=2, seed=0):
    """A figure made of sums over records, its interval by drawing the records anew.

    Parameters
    ----------
    columns : array-like of shape (n_records, n_columns)
    statistic : callable
        Takes sums of shape (n_columns, ...) and gives the figure.
    unit, digits
        Of the `Estimate`.
    seed : int
        Of the draws.

    Returns
    -------
    estimate : Estimate
        Without interval where there is a single record.
    """
    columns = np.asarray(columns, dtype=float)
    n = len(columns)
    if n == 0:
        return nothing(unit, digits)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = float(statistic(columns.sum(axis=0)))
        if n == 1:
            return Estimate(value, float("nan"), float("nan"), n, unit, digits)
        drawn = np.asarray(statistic((_times_drawn(n, seed) @ columns).T), dtype=float)
    drawn = drawn[np.isfinite(drawn)]
    low, high = np.quantile(drawn, (0.025, 0.975)) if drawn.size else (float("nan"),) * 2
    return Estimate(value, float(low), float(high), n, unit, digits)


def _times_drawn(n, seed):
    """How often each of n records comes in each of the draws, an array of shape (DRAWS, n)."""
    picked = np.random.default_rng(seed).integers(n, size=(DRAWS, n)) + n * np.arange(DRAWS)[:, None]
    return np.bincount(picked.ravel(), minlength=DRAWS * n).reshape(DRAWS, n).astype(float)


def mean_of(values, unit="", digits=2):
    """Mean of one value a record; gaps (None, not a number) are left out."""
    known = [float(v) for v in values if v is not None and np.isfinite(v)]
    return resampled([[v, 1.0] for v in known], lambda sums: sums[0] / sums[1], unit, digits)


def quantile_of(values, share=0.5, unit="", digits=2):
    """Quantile of one value a record, its interval from the ranks, whatever the law of the values.

    Few records hold no such interval (fewer than six for a median): then none is told.
    """
    known = np.sort([float(v) for v in values if v is not None and np.isfinite(v)])
    n = known.size
    if n == 0:
        return nothing(unit, digits)
    # ranks between which the quantile lies with 95 %: how many of n draws fall below it is binomial
    below, above = int(binom.ppf(0.025, n, share)), int(binom.ppf(0.975, n, share)) + 1
    held = below >= 1 and above <= n
    low, high = (known[below - 1], known[above - 1]) if held else (float("nan"),) * 2
    return Estimate(float(np.quantile(known, share)), float(low), float(high), n, unit, digits)


def macro_of(rates, unit="%", digits=1):
    """Mean of several rates, each of them weighing the same; rates of none are left out.

    Half the width of its interval is 1.96 sqrt(sum p (1 - p) / n) over the number of rates. There p is
    (count + 1/2) / (n + 1), since a rate of 5 of 5 is no certainty.
    """
    rates = [rate for rate in rates if rate.of]
    if not rates:
        return nothing(unit, digits)
    shrunk = np.array([(rate.count + 0.5) / (rate.of + 1.0) for rate in rates])
    of = np.array([rate.of for rate in rates])
    half = 1.96 * np.sqrt(np.sum(shrunk * (1.0 - shrunk) / of)) / len(rates)
    value = float(np.mean([rate.value for rate in rates]))
    low, high = max(value - half, 0.0), min(value + half, 1.0)
    return Estimate(value, float(low), float(high), int(of.sum()), unit, digits)
