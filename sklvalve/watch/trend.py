# SPDX-License-Identifier: BSD-3-Clause
"""A valve's days as series, and the evidence in them."""

from __future__ import annotations

import datetime as dt
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.watch.evidence import SHAPES, cusum, detector
from sklvalve.watch.record import DayRecord, Finding

# a day on which a size is so many times less sure than on the usual one says nothing of it
_BLIND = 3.0
# sizes that fewer of the reference days show are no series
_SHOWN = 0.8


@dataclass(frozen=True, eq=False)
class Trend:
    """Sizes of all effects of one valve, day by day, and what speaks for a change.

    Parameters
    ----------
    days : tuple of date
    keys : tuple of str
        Of the effects, and names of the channels.
    sizes : ndarray of shape (n_days, n_keys)
        Of effects, share of span [1]; of channels the logarithm of what the simulation leaves over. NaN
        where a day says nothing.
    left : dict of str to ndarray of shape (n_days,)
        Channel -> rms of what the simulation leaves over, share of span [1].
    reference : int
        Days at the beginning that are taken for sound.
    evidence, cusum : ndarray of shape (n_days,)
        The detector; the largest cumulative sum of all effects, in scatters.
    onset : ndarray of int, shape (n_days,)
        Likeliest first day of a change, -1 where nothing speaks for one.
    which : ndarray of int, shape (n_days, 2)
        Effect and shape with most of the evidence.
    """

    days: tuple[dt.date, ...]
    keys: tuple[str, ...]
    sizes: NDArray
    left: dict[str, NDArray]
    reference: int
    evidence: NDArray
    cusum: NDArray
    onset: NDArray
    which: NDArray

    def reached(self, limit: float, days: int) -> list[int]:
        """Numbers of the days on which the evidence is at a limit, and has been for some days before.

        The days between are fresh: they had no part in the choice. A day that was chosen because it is unlike
        the others would take its own chance for a finding.

        Parameters
        ----------
        limit : float
        days : int
        """
        high = self.evidence >= limit
        lasting = np.all([high[k : len(high) - days + k] for k in range(days + 1)], axis=0)
        return (np.flatnonzero(lasting) + days).tolist()

    def leading(self, day: int) -> tuple[str, str, dt.date]:
        """Key of the effect with most of the evidence on a day, the shape of its change and its onset."""
        j, shape = self.which[day]
        return self.keys[j], SHAPES[shape], self.days[int(self.onset[day])]

    @property
    def channel(self) -> str:
        """Channel whose error has grown most since the reference days, in their scatters."""

        def grown(channel: str) -> float:
            logs = np.log(self.left[channel])
            sound = logs[: self.reference]
            return float((np.nanmax(logs[-3:]) - np.nanmean(sound)) / max(np.nanstd(sound, ddof=1), 1e-9))

        return max(self.left, key=grown)

    def off(self, channel: str, day: int) -> tuple[float, float]:
        """Error of the simulation on some day, mean of the last three, and on the reference days [1]."""
        series = self.left[channel]
        late = series[max(day - 2, self.reference) : day + 1]
        return float(np.nanmean(late)), float(np.nanmean(series[: self.reference]))


def reference_after(
    records: Sequence[DayRecord], reference: Sequence[dt.date], looks: Sequence[Finding]
) -> list[dt.date]:
    """Days that later ones are compared with, once a valve was looked at and nothing was missing.

    Another programme, season or load makes other days of the same valve. The first days since then, as many
    as there were before, take the place of those of the commissioning.

    Parameters
    ----------
    records : sequence of DayRecord
        In the order of their days.
    reference : sequence of date
        Those of the commissioning.
    looks : sequence of Finding
        Diagnoses that found nothing, in their order.
    """
    if not looks:
        return list(reference)
    begins = dt.date.fromisoformat(looks[-1].onset)
    since = [r.day for r in records if r.day >= begins and not r.score.mend]
    return since[: len(reference)] if len(since) >= len(reference) else []


def trend_since(records: Sequence[DayRecord], reference: Sequence[dt.date]) -> Trend:
    """Series from the first of some sound days on, without the days whose data are to be mended.

    Parameters
    ----------
    records : sequence of DayRecord
        In the order of their days.
    reference : sequence of date
        The sound days.
    """
    sound = set(reference)
    told = [r for r in records if sound and r.day >= min(sound) and not r.score.mend]
    return trend_of(told, sum(r.day in sound for r in told))


def trend_of(records: Sequence[DayRecord], reference: int) -> Trend:
    """Series of the days of one history.

    Parameters
    ----------
    records : sequence of DayRecord
        In the order of their days, the first `reference` of them sound.
    reference : int
    """
    shown = [record.score.shares for record in records]
    every = sorted({key for shares in shown[:reference] for key in shares})
    keys = [k for k in every if sum(k in shares for shares in shown[:reference]) >= _SHOWN * reference]
    sizes = np.array([[s[k].size if k in s else np.nan for k in keys] for s in shown])
    deviations = np.array([[s[k].deviation if k in s else np.nan for k in keys] for s in shown])
    sizes = sizes.reshape(len(records), len(keys))
    if keys:
        usual = np.nanmedian(deviations[:reference], axis=0)
        sizes = np.where(deviations > _BLIND * usual, np.nan, sizes)
    channels = sorted({c for record in records[:reference] for c in record.score.left})
    left = {c: np.array([r.score.left.get(c, np.nan) for r in records]) for c in channels}
    sizes = np.column_stack([sizes, *(np.log(np.maximum(left[c], 1e-9)) for c in channels)])
    evidence, onset, which = detector(sizes, reference)
    sums = [cusum(column, reference) for column in sizes.T]
    largest = np.max(sums, axis=0) if sums else np.zeros(len(records))
    days = tuple(record.day for record in records)
    return Trend(days, (*keys, *channels), sizes, left, reference, evidence, largest, onset, which)
