# SPDX-License-Identifier: BSD-3-Clause
"""One valve: its days are read, scored and held against its history; a call is diagnosed."""

from __future__ import annotations

import datetime as dt
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from sklvalve.history import ValveHistory
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import Recording, join_recordings
from sklvalve.recording.errors import InputError
from sklvalve.report import write_report
from sklvalve.report.headline import headline
from sklvalve.simulation.parallel_map import with_threads
from sklvalve.watch.days import FEWEST_ROWS, DayFiles, days_of, read_day
from sklvalve.watch.evidence import FEWEST, limit_of
from sklvalve.watch.plant import Commissioning, Watched
from sklvalve.watch.record import REFUSED, DayRecord, Finding
from sklvalve.watch.score import Score, scored
from sklvalve.watch.standing import DIAGNOSED, Standing, epochs_of, standing_of
from sklvalve.watch.store import Store
from sklvalve.watch.trend import Trend

# share of the commissioning days that the simulation is calibrated on; the others are the reference
_LEARNT = 0.5


@dataclass(frozen=True)
class Watch:
    """How a valve stands after a run.

    Parameters
    ----------
    tag : str
    state : {"no data", "commissioning", "sound", "calls", "cannot tell"}
    said : tuple of str
        What a person should know of its data.
    read : int
        Days that were read in this run.
    """

    tag: str
    state: str
    said: tuple[str, ...] = ()
    read: int = 0


def watch_valve(
    watched: Watched, data: str | Path, state: str | Path, false_calls: float, seed: int = 0
) -> tuple[Watch, list[Standing]]:
    """Bring one valve up to date.

    Days that are kept and whose files have not changed are not read again. Whatever is interrupted goes on
    where it was, to the same result.

    Parameters
    ----------
    watched : Watched
    data, state : path-like
    false_calls : float
        Most calls without a reason a valve-year.
    seed : int, default=0
        Of the diagnosis.

    Returns
    -------
    watch : Watch
    standings : list of Standing
        What is kept of it since the beginning, and since each inspection.
    """
    run = _Run(watched, Path(data), Store(state), false_calls, seed)
    try:
        # the processes of the other valves have the other cores
        with threadpool_limits(1, user_api="blas"), with_threads(1):
            now = run.run()
    except InputError as error:
        # one valve that cannot be learnt or diagnosed keeps no other one from being watched
        now = run.cannot_tell(error)
    try:
        return now, run.standings()
    except InputError as error:
        return run.cannot_tell(error), []


class _Run:
    """The steps of `watch_valve`."""

    def __init__(self, watched: Watched, data: Path, store: Store, false_calls: float, seed: int) -> None:
        self.watched, self.data, self.store = watched, data, store
        self.limit, self.seed = limit_of(false_calls), seed
        self.said: list[str] = []
        self.read = 0
        self.earlier = epochs_of(watched.tag, store)
        self.epoch = self.earlier.pop()
        self.standing: Standing | None = None

    def run(self) -> Watch:
        found = days_of(self.data, self.watched)
        if found.unplaced:
            self.said.append(
                f"{len(found.unplaced)} files, first {found.unplaced[0].name}, name no day; name them as "
                "2026-01-31.parquet"
            )
        files = [f for f in found.days if self.epoch.begins is None or f.day >= self.epoch.begins]
        if not files:
            if found.days:
                self.said.append(f"No day since its inspection on {self.epoch.begins}.")
            return self._ends("no data")
        if not self.store.has_history(self.watched.tag, self.epoch) and not self._learn(files):
            return self._ends("commissioning")
        records, by_day = self._scored(files), {f.day: f for f in files}
        self.said += [
            f"{r.day}: {r.score.mend or r.said}"
            for r in records
            if (r.score.mend or r.said) and (r.day in by_day or r.score.rows)
        ]
        return self._judged(records, by_day)

    def cannot_tell(self, why: InputError) -> Watch:
        """How a valve stands whose days or whose state cannot be read."""
        return Watch(self.watched.tag, "cannot tell", (*self.said, str(why)), self.read)

    def standings(self) -> list[Standing]:
        """What is kept of the valve since the beginning, and since each inspection."""
        tag = self.watched.tag
        records = self.store.days(tag) if self.earlier or self.standing is None else ()
        before = [standing_of(tag, self.store, epoch, records) for epoch in self.earlier]
        return [*before, self.standing or standing_of(tag, self.store, self.epoch, records)]

    @cached_property
    def history(self) -> ValveHistory:
        """What was learnt of the valve; read where a day asks for it."""
        return self.store.history(self.watched.tag, self.epoch)

    def _commissioning(self) -> Commissioning:
        """After an inspection the first days with rows are sound, whichever plant.toml names."""
        named = self.watched.commissioning
        return named if self.epoch.begins is None else replace(named, first=self.epoch.begins, last=None)

    def _learn(self, files: Sequence[DayFiles]) -> bool:
        """Learn the valve from the first half of its commissioning days; False while there are too few.

        What it was calibrated on it meets too well: the other half is the reference of later days.
        """
        rows: dict[dt.date, Recording | None] = {}
        while True:
            # a day that cannot be read is none of them; the next one takes its place
            sound = self._sound([f for f in files if rows.get(f.day, ...) is not None])
            if not sound:
                return False
            first = int(len(sound) * _LEARNT)
            new = [f for f in sound[:first] if f.day not in rows]
            if not new:
                break
            for each in new:
                rows[each.day], why = self._rows_of(each)
                if why:
                    self.said.append(f"{each.day}: {why}")
        read = [row for f in sound[:first] if (row := rows[f.day]) is not None]
        self.history = MissingPhysicsFinder(n_jobs=1, random_state=self.seed).history_of(read)
        learnt, reference = ([f.day for f in part] for part in (sound[:first], sound[first:]))
        self.store.save_history(self.watched.tag, self.epoch, self.history, learnt, reference)
        return True

    def _sound(self, files: Sequence[DayFiles]) -> list[DayFiles]:
        """The commissioning days; empty while there are too few, which is said."""
        wanted = self._commissioning()
        days = set(wanted.of([f.day for f in files]))
        sound = [f for f in files if f.day in days]
        complete = bool(files) and files[-1].day > wanted.last if wanted.last else len(sound) >= wanted.days
        if complete and len(sound) >= 2 * FEWEST:
            return sound
        wants = f"from {wanted.first} to {wanted.last}" if wanted.last else f"{wanted.days} days"
        self.said.append(
            f"It is learnt from its sound days, {wants} and at least {2 * FEWEST}; so far there are "
            f"{len(sound)}."
        )
        return []

    def _rows_of(self, files: DayFiles) -> tuple[Recording | None, str]:
        """Rows of a day, or why there are none."""
        self.read += 1
        try:
            recording = read_day(files, self.watched)
        except InputError as error:
            return None, str(error)
        if len(recording) < FEWEST_ROWS:
            return None, f"{len(recording)} rows, fewer than {FEWEST_ROWS}; nothing is told of it"
        return recording, ""

    def _scored(self, files: Sequence[DayFiles]) -> list[DayRecord]:
        """Records of all days since the epoch began; those that are new, or came again, are made."""
        kept = {r.day: r for r in self.store.days(self.watched.tag) if r.since == self.epoch.label}
        newest = max(kept, default=None)
        for each in files:
            before, stamp = kept.get(each.day), each.stamp()
            if before is not None and before.stamp == stamp:
                continue
            checksum = each.checksum()
            if before is not None and before.checksum == checksum:
                record = replace(before, stamp=stamp)
            else:
                said = "came late" if before is None and newest is not None and each.day < newest else ""
                said = "came again with other rows" if before is not None else said
                record = DayRecord(each.day, stamp, checksum, self.epoch.label, self._score(each), said)
            self.store.save_day(self.watched.tag, record)
            kept[each.day] = record
        return [kept[day] for day in sorted(kept)]

    def _score(self, files: DayFiles) -> Score:
        recording, why = self._rows_of(files)
        if recording is None:
            return Score(0, 0.0, mend=why)
        # a history that cannot be read is no fault of the day
        history = self.history
        try:
            return scored(recording, history)
        except InputError as error:
            return Score(len(recording), float(recording.sample_time), mend=str(error))

    def _judged(self, records: Sequence[DayRecord], files: dict[dt.date, DayFiles]) -> Watch:
        """Whether the valve calls; a new call is diagnosed and kept.

        A day that cannot be diagnosed, as one outside the history's range, leaves its turn to the next one.
        """
        self.standing = standing = standing_of(self.watched.tag, self.store, self.epoch, records)
        if standing.calls:
            return self._looked_at_again(standing, files)
        trend = standing.trend
        if standing.looks and trend.reference < FEWEST:
            # what its days are like since the look is not known yet
            return self._ends("sound")
        if trend.reference < FEWEST:
            self.said.append(
                f"Only {trend.reference} days of its commissioning can be used; {FEWEST} are needed."
            )
            return self._ends("cannot tell")
        why: list[str] = []
        seen = standing.looks[-1].called if standing.looks else ""
        for day in trend.reached(self.limit, DIAGNOSED):
            if trend.days[day].isoformat() <= seen:
                continue
            try:
                finding = self._called(trend, day, files)
            except InputError as error:
                why.append(f"{trend.days[day]}: {error}")
                continue
            self.store.save_finding(finding)
            # where nothing is missing the valve works in another way since, and is watched on from there
            return self._judged(records, files)
        self.said += why[:1]
        return self._ends("cannot tell" if why else "sound")

    def _looked_at_again(self, standing: Standing, files: dict[dt.date, DayFiles]) -> Watch:
        """A valve that has called, diagnosed anew until two diagnoses that share no day share a name.

        What grows is told later, and better. The days with rows between two diagnoses double, so that a year
        of a call costs nine. A day whose rows are gone leaves its turn to the next one; one that is refused
        counts as a diagnosis, and the valve calls all the same.
        """
        trend, at = standing.trend, standing.places
        if trend.reference < FEWEST or standing.named_twice:
            return self._ends("calls")
        least = DIAGNOSED if standing.calls[-1].names else 1
        for day in range(at[-1] + max(least, at[-1] - at[0]), len(trend.days)):
            if trend.days[day] not in files or trend.onset[day] < 0:
                continue
            try:
                finding = self._called(trend, day, files)
            except InputError as error:
                self.said.append(f"{trend.days[day]}: the call was not diagnosed again: {error}")
                finding = self._finding(trend, day, REFUSED, f"It was not diagnosed: {error}.")
            self.store.save_finding(finding)
            return self._judged(standing.records, files)
        return self._ends("calls")

    def _called(self, trend: Trend, day: int, files: dict[dt.date, DayFiles]) -> Finding:
        content, report = self._diagnosed(trend.days[: day + 1][-DIAGNOSED:], files)
        # candidates that a diagnosis leaves open are no names
        named = content["effects"] if content["verdict"] == "named" else ()
        names = tuple("/".join(m["name"] for m in effect["members"]) for effect in named)
        return self._finding(trend, day, content["verdict"], headline(content), names, report)

    def _finding(self, trend: Trend, day: int, verdict: str, told: str, *others: Any) -> Finding:
        key, shape, onset = trend.leading(day)
        began, called = onset.isoformat(), trend.days[day].isoformat()
        of_day = (float(trend.evidence[day]), self.limit, key)
        return Finding(
            self.watched.tag, self.epoch.label, called, began, shape, *of_day, verdict, told, *others
        )

    def _diagnosed(self, days: Sequence[dt.date], files: dict[dt.date, DayFiles]) -> tuple[dict, str]:
        """Diagnosis of some days against the history; and where its report lies."""
        read = [self._rows_of(files[day])[0] for day in days if day in files]
        if not any(each is not None for each in read):
            raise InputError(f"the rows of {days[-1]}, from which on it calls, are gone; put them back")
        rows = join_recordings([each for each in read if each is not None])
        finder = MissingPhysicsFinder(n_jobs=1, random_state=self.seed, history=self.history).fit(rows)
        folder = self.store.reports(self.watched.tag, days[-1])
        folder.mkdir(parents=True, exist_ok=True)
        write_report(folder / "report.html", finder.diagnosis_, title=self.watched.tag, source=rows.source)
        finder.diagnosis_.save(folder / "diagnosis.zip")
        place = (folder / "report.html").relative_to(self.store.folder)
        return finder.diagnosis_.to_dict(), place.as_posix()

    def _ends(self, state: str) -> Watch:
        return Watch(self.watched.tag, state, tuple(self.said), self.read)
