# SPDX-License-Identifier: BSD-3-Clause
"""All valves of a plant, over processes of this machine or workers of a cluster."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sklvalve.recording.errors import InputError, hint
from sklvalve.watch.plant import Plant, Watched
from sklvalve.watch.processes import side_by_side
from sklvalve.watch.record import Inspection
from sklvalve.watch.standing import Standing
from sklvalve.watch.store import Store, trends_table
from sklvalve.watch.valve import Watch, watch_valve

if TYPE_CHECKING:
    import pyarrow as pa

# it may be tomorrow already where the valve is
_AHEAD = dt.timedelta(days=1)


def watch(
    plant: Plant,
    data: str | PathLike[str],
    state: str | PathLike[str],
    *,
    n_jobs: int | None = None,
    scheduler: str | None = None,
    random_state: int = 0,
    report: Callable[[int, int, str], object] | None = None,
) -> list[Watch]:
    """Bring all valves of a plant up to date.

    Parameters
    ----------
    plant : Plant
    data : path-like
        Folder in which each valve has its own.
    state : path-like
        Folder for what is kept; made if it is not there.
    n_jobs : int, default=None
        Processes; None is one for each processor.
    scheduler : str, default=None
        Address of a Dask scheduler whose workers see both folders; processes of this machine unless given.
    random_state : int, default=0
    report : callable, default=None
        ``report(done, all, tag)``, told of every valve.

    Returns
    -------
    watches : list of Watch
        In the order of the plant.

    Raises
    ------
    InputError
        If a folder cannot be used, or another run works on the state.
    """
    folder, store = Path(data), Store(state)
    if not folder.is_dir():
        raise InputError(f"--data {folder}: no such folder; name the one in which each valve has its own")
    store.prepare(plant.name)
    with store.alone():
        jobs = [(each, folder, store.folder, plant.false_calls, random_state) for each in plant.valves]
        made: dict[str, tuple[Watch, pa.Table]] = {}
        for now, trends in _each(jobs, n_jobs, scheduler):
            made[now.tag] = now, trends
            if report is not None:
                report(len(made), len(jobs), now.tag)
        in_order = [made[each.tag] for each in plant.valves]
        findings = (asdict(f) for each in plant.valves for f in store.findings(each.tag))
        store.write_tables(findings, [trends for _, trends in in_order])
    return [now for now, _ in in_order]


def inspected(plant: Plant, state: str | PathLike[str], tag: str, day: dt.date, note: str = "") -> None:
    """Enter that somebody has inspected or mended a valve: from that day on its history begins anew.

    Parameters
    ----------
    plant : Plant
    state : path-like
    tag : str
    day : date
    note : str, default=""

    Raises
    ------
    InputError
        If the plant has no such valve, the day is yet to come, or it lies before an inspection that was
        entered already.
    """
    if day > dt.date.today() + _AHEAD:
        raise InputError(
            f"the inspection of {tag} cannot be on {day}, which is yet to come; enter the day on which it was"
        )
    tags = [each.tag for each in plant.valves]
    if tag not in tags:
        raise InputError(f"the plant has no valve {tag}; {hint(tag, tags)}")
    store = Store(state)
    store.prepare(plant.name)
    with store.alone():
        before = store.inspections(tag)
        if before and day < dt.date.fromisoformat(before[-1].day):
            raise InputError(
                f"{tag} was inspected on {before[-1].day} already; enter a day from then on, so that its "
                "history does not overlap"
            )
        store.save_inspection(Inspection(tag, day.isoformat(), note))


def _each(
    jobs: Sequence[tuple], n_jobs: int | None, scheduler: str | None
) -> Iterator[tuple[Watch, pa.Table]]:
    if scheduler is None:
        return side_by_side(_one, jobs, n_jobs)
    return _on_a_cluster(jobs, scheduler)


def _one(watched: Watched, *job: Any) -> tuple[Watch, pa.Table]:
    """One valve brought up to date, and its part of the table of trends."""
    now, standings = watch_valve(watched, *job)
    return now, trends_table(row for standing in standings for row in _trends_of(watched.tag, standing))


def _trends_of(tag: str, standing: Standing) -> Iterator[tuple]:
    trend = standing.trend
    at = {day: k for k, day in enumerate(trend.days)}
    for record in standing.records:
        k = at.get(record.day)
        told = (None, None) if k is None else (float(trend.evidence[k]), float(trend.cusum[k]))
        yield tag, record.day, record.score.rows, record.score.mend, *told


def _on_a_cluster(jobs: Sequence[tuple], scheduler: str) -> Iterator[tuple[Watch, pa.Table]]:
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise ImportError('--scheduler needs distributed: pip install "sklvalve[distributed]"') from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(
            f"--scheduler {scheduler}: no scheduler answers there ({error}); give its address, such as "
            "tcp://127.0.0.1:8786"
        ) from None
    with client:
        # a worker that dies is replaced by another, which goes on with the days that are kept
        futures = [client.submit(_one, *job, pure=False, retries=5) for job in jobs]
        for future in as_completed(futures):
            yield future.result()
