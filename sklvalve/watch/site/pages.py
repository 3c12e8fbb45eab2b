# SPDX-License-Identifier: BSD-3-Clause
"""What the pages say, as plain data for their templates."""

from __future__ import annotations

import datetime as dt
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sklvalve.report.words import spoken
from sklvalve.watch.evidence import limit_of
from sklvalve.watch.plant import Plant
from sklvalve.watch.record import DayRecord, Finding, Inspection
from sklvalve.watch.site.chart import chart
from sklvalve.watch.standing import Standing, state_now
from sklvalve.watch.store import Store
from sklvalve.watch.trend import Trend
from sklvalve.watch.valve import Watch

#: States in the order of their urgency, and their words.
STATES = {
    "calls": "calls for attention",
    "cannot tell": "cannot be told",
    "no data": "no data",
    "commissioning": "being learnt",
    "sound": "no change found",
}
_SILENT = 3  # days without rows after which a valve is said to be silent


@dataclass(frozen=True)
class ValvePage:
    """What is told of one valve.

    Attributes
    ----------
    tag, state, words : str
    what, since, how_large, how_sure : str
        Of the call; empty without one.
    growing : bool
        Whether its size still grows.
    said : tuple of str
        What is to be looked at in its data.
    """

    tag: str
    state: str
    words: str
    what: str = ""
    since: str = ""
    called: str = ""
    how_large: str = ""
    how_sure: str = ""
    growing: bool = False
    report: str = ""
    headline: str = ""
    pictures: tuple[tuple[str, str], ...] = ()
    said: tuple[str, ...] = ()
    done: tuple[Inspection, ...] = ()
    earlier: tuple[Finding, ...] = ()
    days: int = 0
    last: str = ""
    weight: float = field(default=0.0, repr=False)


def page_of(
    watch: Watch, standing: Standing, store: Store, false_calls: float, newest: dt.date | None
) -> ValvePage:
    """What is told of a valve.

    Parameters
    ----------
    watch : Watch
    standing : Standing
        Since the last inspection.
    store : Store
    false_calls : float
        Calls a valve-year that plant.toml allows without a reason.
    newest : date or None
        Last day that any valve of the plant has.
    """
    tag = watch.tag
    done = tuple(store.inspections(tag))
    records, now, state = standing.records, standing.call, state_now(watch.state, standing)
    said = list(watch.said)
    if records and newest is not None and (newest - records[-1].day).days >= _SILENT:
        said.append(f"No rows since {records[-1].day}.")
    page: dict[str, Any] = {
        "tag": tag,
        "state": state,
        "words": STATES[state],
        "said": tuple(said),
        "done": done,
        "earlier": tuple(f for f in store.findings(tag) if f != now),
        "days": len(records),
        "last": records[-1].day.isoformat() if records else "",
    }
    if now is not None:
        page |= _call(now, standing) | {"since": standing.since, "called": standing.called}
    trend = standing.trend
    if not trend.days or not trend.reference:
        return ValvePage(**page)
    if now is not None:
        page |= _size(standing.called, trend)
    return ValvePage(**page, pictures=_pictures(trend, standing.calls[:1], done, records, false_calls))


def _call(finding: Finding, standing: Standing) -> dict[str, Any]:
    first = standing.calls[0]
    names = " + ".join(" or ".join(spoken(n) for n in each.split("/")) for each in finding.names)
    unknown = {"none_of_these": "a change that no known effect explains"}
    return {
        "what": names or unknown.get(finding.verdict, "a change that is not identified"),
        # how often a sound valve calls was not measured on plants: no frequency is given
        "how_sure": f"evidence {_number(first.evidence)}, where the limit is {_number(first.limit)}"
        + (f"; {_named_by(finding, standing)}" if names else ""),
        "report": finding.report,
        "headline": finding.headline,
    }


def _named_by(finding: Finding, standing: Standing) -> str:
    """By how many diagnoses a name is given, and which of several names."""
    twice, many = standing.named_twice, len(standing.calls)
    if not twice:
        return f"named by one of {many} diagnoses so far" if many > 1 else "named by one diagnosis so far"
    which = "" if twice == finding.members else " or ".join(sorted(map(spoken, twice))) + " "
    return f"{which}named by two diagnoses that share no day"


def _number(value: float) -> str:
    """A number that may have thirty digits."""
    return f"{value:,.0f}" if value < 1e6 else f"about 10^{np.log10(value):.0f}"


def _size(called: str, trend: Trend) -> dict[str, Any]:
    """How far the valve is from what it was, and whether that grows."""
    channel = trend.channel
    off, sound = trend.off(channel, len(trend.days) - 1)
    # the day of the call itself may have come again since, without rows
    before = [k for k, day in enumerate(trend.days) if day.isoformat() <= called]
    then, _ = trend.off(channel, max(before, default=0))
    return {
        "how_large": f"the {channel} is {100.0 * off:.2g} % of its span away from the sound valve "
        f"({100.0 * sound:.2g} % before)",
        "growing": off > 1.2 * then,
        "weight": off - sound,
    }


def _pictures(
    trend: Trend,
    calls: Sequence[Finding],
    done: Sequence[Inspection],
    records: Sequence[DayRecord],
    false_calls: float,
) -> tuple[tuple[str, str], ...]:
    marks = [(dt.date.fromisoformat(f.called), "called") for f in calls]
    marks += [(dt.date.fromisoformat(i.day), "inspected") for i in done]
    marks = [mark for mark in marks if trend.days[0] <= mark[0] <= trend.days[-1]]
    made = []
    for channel, left in sorted(trend.left.items()):
        label = f"How far the {channel} is from the sound valve's, percent of span, rms of each day"
        made.append((chart(trend.days, 100.0 * left, label=label, marks=marks, unit=" %"), f"{label}."))
    evidence = np.log10(np.maximum(trend.evidence, 1.0))
    limit = float(np.log10(limit_of(false_calls)))
    label = "Evidence for a change, powers of ten, and the limit at which the valve calls"
    made.append((chart(trend.days, evidence, label=label, limit=limit, marks=marks), f"{label}."))
    if missing := [r.day for r in records if r.score.mend]:
        made.append(("", f"{len(missing)} days say nothing, the last {missing[-1]}."))
    return tuple(made)


def in_order(pages: Sequence[ValvePage]) -> list[ValvePage]:
    """Pages by urgency: those that call first, the largest change before the others."""
    order = list(STATES)
    return sorted(pages, key=lambda p: (order.index(p.state), not p.growing, -p.weight, p.tag))


def headline_of(plant: Plant, pages: Sequence[ValvePage]) -> str:
    """What a planner has to know first."""
    calling = [p for p in pages if p.state == "calls"]
    if not calling:
        watched = sum(p.state == "sound" for p in pages)
        others = len(pages) - watched
        rest = f" Of {others} more nothing is known yet." if others else ""
        return f"Nothing to do today: no change was found in {watched} watched valves.{rest}"
    first = in_order(calling)[0]
    count = "One valve calls" if len(calling) == 1 else f"{len(calling)} valves call"
    return f"{count} for attention. First: {first.tag}, {first.what}, since {first.since}."
