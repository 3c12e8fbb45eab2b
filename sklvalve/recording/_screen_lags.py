# SPDX-License-Identifier: BSD-3-Clause
"""By how many rows one signal follows another: impulse responses that may begin before their cause."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

_POLE = 0.95  # of the high-pass: what wanders over more than some twenty rows says nothing about clocks
_RIDGE = 1e-3


@dataclass(frozen=True)
class Lag:
    """How one signal answers another.

    Parameters
    ----------
    peak : int
        Row of the strongest answer; negative where it comes before its cause.
    half : int
        Row by which half of the answer has come.
    early : float
        Share of the answer that comes before its cause.
    prominence : float
        Strongest answer over the largest one elsewhere.
    gain : float
        Sum of the answer in the five rows about its peak.
    searched : int
        Rows to either side that were searched.
    course : tuple of float
        Answer over the lags, smoothed over three rows, as a multiple of the largest elsewhere.
    told : float
        Share of the answering signal's variance that the answers explain.
    """

    peak: int
    half: int
    early: float
    prominence: float
    gain: float
    searched: int
    course: tuple
    told: float


def longest_lag(rows: int) -> int:
    """Rows to either side that a recording of this length can be searched over."""
    return min(40, rows // 60)


def lags_of(answer: Values, causes: list[Values], usable: NDArray[np.bool_], longest: int) -> list[Lag]:
    """Lags at which an answer follows each of its causes, by least squares; [] where they tell nothing.

    ``answer[t] = sum over causes and k from -longest to longest of h[k] cause[t - k]``, of quick signals.
    Sums over rows are correlations, so the cost is that of their Fourier transforms.
    """
    sums = sums_of(answer, causes, usable, longest)
    if sums is None:
        return []
    response = sums.solved()
    if response is None:
        return []
    told = float((2.0 * sums.right @ response - response @ sums.normal @ response) / sums.power)
    return [_lag(each, longest, told) for each in np.split(response, len(causes))]


@dataclass(frozen=True)
class Sums:
    """Normal equations of an answer over all lags of its causes, and the answer's sum of squares."""

    normal: Values
    right: Values
    power: float

    def solved(self) -> Values | None:
        """Answers over all lags, cause by cause; None where they cannot be told."""
        # SciPy at first use: what drafts a valve.toml reads recordings without it
        from scipy.linalg import solve

        try:
            return solve(self.normal + np.diag(_RIDGE * np.diag(self.normal)), self.right, assume_a="pos")
        except np.linalg.LinAlgError:
            return None


def sums_of(answer: Values, causes: list[Values], usable: NDArray[np.bool_], longest: int) -> Sums | None:
    """Sums of products over lags from -longest to longest; None for too few rows, or where nothing moves."""
    from scipy.fft import irfft, next_fast_len, rfft
    from scipy.linalg import toeplitz

    width = 2 * longest + 1
    if usable.sum() < 2 * width * len(causes):
        return None
    padded = next_fast_len(len(answer) + 2 * width, real=True)
    waves = [rfft(np.where(usable, each, 0.0), padded) for each in (*causes, answer)]

    def together(first: int, second: int) -> Values:
        """Sums of products, the second signal later by -2 longest to 2 longest rows."""
        whole = irfft(waves[first].conj() * waves[second], padded)
        return np.concatenate([whole[-2 * longest :], whole[: 2 * longest + 1]])

    count, middle = len(causes), 2 * longest
    normal = np.empty((count * width, count * width))
    for one in range(count):
        for other in range(count):
            sums = together(one, other)
            block = toeplitz(sums[middle : middle + width], sums[middle::-1][:width])
            normal[one * width : (one + 1) * width, other * width : (other + 1) * width] = block
    right = np.concatenate([together(one, count)[longest : longest + width] for one in range(count)])
    power = float(together(count, count)[middle])
    if power <= 0.0 or (np.diag(normal) <= 0.0).any():
        return None
    return Sums(normal, right, power)


def _lag(response: Values, longest: int, told: float) -> Lag:
    smooth = np.convolve(response, np.full(3, 1.0 / 3.0), mode="same")
    place = int(np.argmax(smooth))
    elsewhere = np.abs(np.arange(len(smooth)) - place) > 4
    highest = float(np.abs(smooth[elsewhere]).max(initial=1e-300))
    total, course = float(response.sum()), np.cumsum(response)
    half = int(np.argmax(course >= 0.5 * total)) if total > 0.0 else place
    early = float(course[longest - 1] / total) if total > 0.0 else 0.0
    gain = float(response[max(0, place - 2) : place + 3].sum())
    return Lag(
        place - longest,
        half - longest,
        early,
        float(smooth[place]) / highest,
        gain,
        longest,
        tuple(smooth / highest),
        told,
    )


def quick(values: Values) -> Values:
    """What a signal does within some twenty rows."""
    from scipy.signal import lfilter

    return lfilter([1.0, -1.0], [1.0, -_POLE], values - values[0])


def slow(values: Values, rows: int = 61) -> Values:
    """Mean over the rows about each."""
    rows = min(rows, 2 * (len(values) // 4) + 1)
    padded = np.pad(values, (rows // 2, rows // 2), mode="edge")
    total = np.concatenate([[0.0], np.cumsum(padded)])
    return (total[rows:] - total[:-rows]) / rows


def filled(values: Values) -> Values:
    """Gaps bridged by straight lines."""
    known = np.isfinite(values)
    if known.all():
        return values
    return np.interp(np.arange(len(values)), np.flatnonzero(known), values[known]) if known.any() else values


def rising_curve(cause: Values, consequence: Values, bins: int = 24) -> Values:
    """Consequence as a rising function of its cause, by medians; evaluated at each row."""
    edges = np.unique(np.quantile(cause, np.linspace(0.0, 1.0, bins + 1)))
    if len(edges) < 3:
        return np.full(len(cause), float(np.median(consequence)))
    place = np.clip(np.searchsorted(edges, cause, side="right") - 1, 0, len(edges) - 2)
    order = np.argsort(place, kind="stable")
    groups = np.split(order, np.searchsorted(place[order], np.arange(1, len(edges) - 1)))
    groups = [group for group in groups if len(group)]
    centres = np.array([np.median(cause[group]) for group in groups])
    heights = np.array([np.median(consequence[group]) for group in groups])
    return np.interp(cause, centres, np.maximum.accumulate(heights))
