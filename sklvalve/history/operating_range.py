# SPDX-License-Identifier: BSD-3-Clause
"""Where a valve has been: a coarse histogram of opening, pressure drop, temperature, flow and command."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from sklvalve.recording import Recording
from sklvalve.simulation.calibration import span_of

#: What is counted: roles of a recording, and the drop p1 - p2 [Pa].
COUNTED = ("command", "opening", "drop", "temperature", "flow")
# a signal's span has about so many bins; of openings and temperatures they are the same in every recording
_BINS = 64
_STEPS = {"command": 1.0 / 64.0, "opening": 1.0 / 64.0, "temperature": 1.0}
# a bin with fewer rows was not visited: a spike is no operation
_FEWEST = 3
# farther from zero nothing is told apart
_FARTHEST = 1 << 20


@dataclass(frozen=True, eq=False)
class Visited:
    """How often a signal was in each bin.

    Parameters
    ----------
    step : float
        Width of a bin, a power of two [SI]; bin k reaches from ``k * step`` to ``(k + 1) * step``.
    bins : ndarray of shape (m,), int64
        Numbers of the bins that hold a row, in ascending order.
    rows : ndarray of shape (m,), int64
        Rows in each.
    """

    step: float
    bins: np.ndarray
    rows: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray, step: float) -> Visited:
        """Bins of the values of a signal [SI]; gaps count nowhere."""
        return cls(step, *np.unique(_bins(values[np.isfinite(values)], step), return_counts=True))

    def coarser(self, step: float) -> Visited:
        """The same in bins of a larger width, a power of two times this one's."""
        if step <= self.step:
            return self
        bins, place = np.unique(
            np.floor(self.bins * (self.step / step)).astype(np.int64), return_inverse=True
        )
        return Visited(step, bins, np.bincount(place, self.rows, len(bins)).astype(np.int64))

    def merged(self, other: Visited) -> Visited:
        """Both together, in the larger bins of the two."""
        step = max(self.step, other.step)
        one, two = self.coarser(step), other.coarser(step)
        bins, place = np.unique(np.concatenate([one.bins, two.bins]), return_inverse=True)
        rows = np.bincount(place, np.concatenate([one.rows, two.rows]), len(bins))
        return Visited(step, bins, rows.astype(np.int64))

    def limits(self, share: float = 0.01) -> tuple[float, float]:
        """Values [SI] between which the signal stayed but for a share of the rows at either end."""
        total = np.cumsum(self.rows)
        low = np.searchsorted(total, share * total[-1], side="right")
        high = np.searchsorted(total, (1.0 - share) * total[-1])
        return float(self.bins[low] * self.step), float((self.bins[high] + 1) * self.step)

    def outside(self, values: np.ndarray) -> float:
        """Share of values, gaps left out, that are in no visited bin nor beside one."""
        seen = values[np.isfinite(values)]
        return float(1.0 - np.mean(self.holds(seen))) if len(seen) else 0.0

    def holds(self, values: np.ndarray) -> np.ndarray:
        """Whether each value is in a visited bin or beside one; a gap is in none."""
        there = self.bins[self.rows >= _FEWEST]
        near = np.unique(np.concatenate([there - 1, there, there + 1]))
        known, held = np.isfinite(values), np.zeros(len(values), dtype=bool)
        held[known] = np.isin(_bins(values[known], self.step), near)
        return held


@dataclass(frozen=True, eq=False)
class OperatingRange:
    """Where a valve has been in the recordings of its history.

    Parameters
    ----------
    visited : dict of str to Visited
        Signal of `COUNTED` -> how often it was where; those that were recorded.
    """

    visited: dict[str, Visited] = field(default_factory=dict)

    @classmethod
    def of(cls, recordings: Recording | Iterable[Recording]) -> OperatingRange:
        """Range of one recording, or of several together.

        Parameters
        ----------
        recordings : Recording, or iterable of Recording

        Returns
        -------
        operating_range : OperatingRange
        """
        several = [recordings] if isinstance(recordings, Recording) else recordings
        return reduce(cls.merged, (cls._of_one(r) for r in several), cls())

    @classmethod
    def _of_one(cls, recording: Recording) -> OperatingRange:
        signals = counted_in(recording)
        return cls({name: Visited.of(v, _step(name, v)) for name, v in signals.items()})

    def merged(self, other: OperatingRange) -> OperatingRange:
        """This range and another one's together; a signal that one of them lacks is that of the other.

        Parameters
        ----------
        other : OperatingRange

        Returns
        -------
        operating_range : OperatingRange
        """
        both = {
            name: self.visited[name].merged(other.visited[name]) if name in self.visited else theirs
            for name, theirs in other.visited.items()
        }
        return OperatingRange(self.visited | both)

    def outside(self, recording: Recording) -> dict[str, float]:
        """Share of a recording's rows that are where the valve has not been.

        Parameters
        ----------
        recording : Recording

        Returns
        -------
        shares : dict of str to float
            Signal -> share [1], of those that both hold.
        """
        signals = counted_in(recording)
        return {name: each.outside(signals[name]) for name, each in self.visited.items() if name in signals}

    def met(self, recording: Recording, names: Iterable[str]) -> np.ndarray:
        """Rows of a recording in which signals are where the valve has been.

        Parameters
        ----------
        recording : Recording
        names : iterable of str
            Of `COUNTED`; those that either lacks are not asked.

        Returns
        -------
        rows : ndarray of bool, shape (n,)
        """
        signals, rows = counted_in(recording), np.ones(len(recording), dtype=bool)
        for name in names:
            if name in signals and name in self.visited:
                rows &= self.visited[name].holds(signals[name])
        return rows

    def limits(self, share: float = 0.01) -> dict[str, tuple[float, float]]:
        """Signal -> values [SI] between which it stayed but for a share of the rows at either end."""
        return {name: each.limits(share) for name, each in self.visited.items()}


def counted_in(recording: Recording) -> dict[str, np.ndarray]:
    """Signals of a recording whose range counts, those that hold a value; the drop is p1 - p2 [SI]."""
    signals = {name: recording[name] for name in COUNTED if name in recording}
    if {"p1", "p2"} <= set(recording):
        signals["drop"] = recording["p1"] - recording["p2"]
    return {name: signals[name] for name in COUNTED if name in signals and np.isfinite(signals[name]).any()}


def limits_in_recorded_units(operating_range: OperatingRange, recording: Recording) -> dict[str, dict]:
    """Where signals stayed but for one row in a hundred at either end.

    Parameters
    ----------
    operating_range : OperatingRange
    recording : Recording
        For the units.

    Returns
    -------
    limits : dict of dict
        Signal -> ``low``, ``high`` and ``unit``; a pressure drop is in the unit of the inlet pressure.
    """
    found = {}
    for name, (low, high) in operating_range.limits().items():
        if name == "drop":
            per_si = abs(recording.per_si("p1"))
            ends, unit = [low * per_si, high * per_si], recording.unit("p1")
        else:
            # a sense of closing turns them round
            ends = sorted(recording.in_recorded_units(name, np.array([low, high])).tolist())
            unit = recording.unit(name)
        found[name] = {"low": float(ends[0]), "high": float(ends[1]), "unit": unit}
    return found


def _step(name: str, values: np.ndarray) -> float:
    span = span_of(values)
    return _STEPS.get(name) or (2.0 ** np.floor(np.log2(span / _BINS)) if span > 0.0 else 1.0)


def _bins(values: np.ndarray, step: float) -> np.ndarray:
    return np.clip(np.floor(values / step), -_FARTHEST, _FARTHEST).astype(np.int64)
