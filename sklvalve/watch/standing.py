# SPDX-License-Identifier: BSD-3-Clause
"""What is kept of a valve since an inspection: its days, calls and looks, and the series that they make."""

from __future__ import annotations

import datetime as dt
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from sklvalve.watch.record import NOTHING, DayRecord, Epoch, Finding
from sklvalve.watch.store import Store
from sklvalve.watch.trend import Trend, reference_after, trend_since

#: Days that are diagnosed when a valve calls: those last seen, none of which had a part in the choice.
DIAGNOSED = 2
_UNEXPLAINED = "none_of_these"


@dataclass(frozen=True, eq=False)
class Standing:
    """Days of one history of a valve, and what came of them.

    Parameters
    ----------
    records : sequence of DayRecord
        In the order of their days.
    looks : list of Finding
        Diagnoses that found nothing, before the valve called.
    calls : list of Finding
        The diagnosis by which it called, and those of later days.
    reference : list of date
        Sound days of the commissioning.
    """

    records: Sequence[DayRecord]
    calls: list[Finding]
    looks: list[Finding]
    reference: list[dt.date]

    @property
    def call(self) -> Finding | None:
        """What is known of its call; None without one.

        The last diagnosis that has a name; else the last that found what no effect explains; else the first.
        """
        named = [each for each in self.calls if each.names]
        shown = [each for each in self.calls if each.verdict == _UNEXPLAINED]
        return next(iter(named[-1:] or shown[-1:] or self.calls[:1]), None)

    @property
    def called(self) -> str:
        """Day on which it called; empty where it has not."""
        return self.calls[0].called if self.calls else ""

    @property
    def since(self) -> str:
        """First day of the change, by the diagnosis that tells it earliest; empty where it has not called."""
        return min(self.calls[0].onset, self.call.onset) if self.call else ""

    @property
    def places(self) -> list[int]:
        """Of every diagnosis since it called the place of its last day among those of the trend.

        A day that came again without rows is none of them: the one before it stands for it.
        """
        days = [day.isoformat() for day in self.trend.days]
        return [bisect_right(days, each.called) - 1 for each in self.calls]

    @property
    def named_twice(self) -> frozenset[str]:
        """Names that the last diagnosis shares with one that it shares no day with."""
        if not self.calls:
            return frozenset()
        *before, (last, place) = zip(self.calls, self.places, strict=True)
        apart = (last.shared_with(call) for call, at in before if place - at >= DIAGNOSED)
        return next(filter(None, apart), frozenset())

    @cached_property
    def trend(self) -> Trend:
        """Series since the last look, or since the commissioning."""
        return trend_since(self.records, reference_after(self.records, self.reference, self.looks))


def state_now(state: str, standing: Standing) -> str:
    """State that a run has told of a valve, unless an inspection was entered since.

    Parameters
    ----------
    state : str
        Of `Watch`.
    standing : Standing
    """
    return "commissioning" if state == "calls" and not standing.calls else state


def epochs_of(tag: str, store: Store) -> list[Epoch]:
    """Times between the inspections of a valve, in their order; the last one is now."""
    days = [dt.date.fromisoformat(each.day) for each in store.inspections(tag)]
    return [Epoch(), *map(Epoch, days)]


def standing_of(tag: str, store: Store, epoch: Epoch, records: Sequence[DayRecord] | None = None) -> Standing:
    """What is kept of a valve in an epoch.

    Parameters
    ----------
    tag : str
    store : Store
    epoch : Epoch
    records : sequence of DayRecord, default=None
        Days of the valve that were read from the store already.
    """
    every = store.days(tag) if records is None else records
    made = [each for each in store.findings(tag) if each.since == epoch.label]
    # what a later look finds of a valve that has called is told of that call, whatever it is
    first = next((k for k, f in enumerate(made) if f.verdict != NOTHING), len(made))
    mine = [record for record in every if record.since == epoch.label]
    return Standing(mine, made[first:], made[:first], store.reference(tag, epoch))
