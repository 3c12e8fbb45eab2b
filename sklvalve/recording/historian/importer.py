# SPDX-License-Identifier: BSD-3-Clause
"""An export's way to a clean recording: text, table, series, points, base; and the account of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.historian import account as told
from sklvalve.recording.historian.clean import Points
from sklvalve.recording.historian.cut import require_one_clock, rows_asked_for
from sklvalve.recording.historian.decimals import Mark, decimal_mark
from sklvalve.recording.historian.gather import gather_points, methods, pooled, usable, why_left_out
from sklvalve.recording.historian.layout import Layout, read_layout
from sklvalve.recording.historian.one_base import common_period, on_one_base, rows_to_keep
from sklvalve.recording.historian.restarts import runs_of_rows
from sklvalve.recording.historian.settings import ImportSettings
from sklvalve.recording.historian.table import Table, read_table
from sklvalve.recording.historian.text import read_text
from sklvalve.recording.historian.timeline import Timeline
from sklvalve.recording.tags import read_unit

#: Most steps that may be bridged.
LARGEST_GAP = 1e6
# shares of the time that are gone by when files are tables, their decimal mark and their times are known, and
# the points of each tag are joined, and laid on one base (long and wide exports of 16 and 33 MB)
_READ, _MARKED, _TIMED, _GATHERED, _ALIGNED = 0.35, 0.5, 0.8, 0.85, 0.95


@dataclass(frozen=True)
class Imported:
    """A clean recording, as columns, and the account of what was done.

    Parameters
    ----------
    stamps : ndarray of shape (m,)
        Times: float64 [s], or ISO 8601 texts.
    columns : dict of ndarray of shape (m,)
        Tag, with its unit in brackets where that is known -> values; NaN where there is none.
    account : dict
        What was read, assumed and done, fit for JSON.
    """

    stamps: NDArray
    columns: dict[str, NDArray[np.float64]]
    account: dict


@dataclass(frozen=True)
class ImportedRuns:
    """The recordings that stand in one export, in its order, and the account of them all.

    Where there is one, `account` is that of the recording; where there are several, it holds what they have
    in common, and a list `runs` with the first line of each in the file, and what was done to it.
    """

    runs: tuple[Imported, ...]
    account: dict


def import_export(
    paths: Sequence[str | PathLike[str]],
    settings: ImportSettings | None = None,
    callback: Callable[[str, float], None] | None = None,
) -> Imported:
    """Make the files of a historian's export one clean recording.

    Parameters
    ----------
    paths : sequence of str or path-like
        Text files, in long format (tag, time, value, quality) or wide (a column for each tag).
    settings : ImportSettings or None, default=None
    callback : callable or None, default=None
        Called as ``callback(stage, done)`` with a plain word and the share done.

    Returns
    -------
    imported : Imported

    Raises
    ------
    InputError
        With one sentence that names file, line, what was expected and the mend; also where the clock starts
        again, because then there are several recordings: `import_runs`.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from sklvalve.recording.historian import import_export
    >>> text = "Tag;Time;Value;Quality\\n" + "".join(
    ...     f"FIC1.PV;28.06.2024 14:35:{s:02};{s},5;{'Bad' if s == 3 else 'Good'}\\n" for s in range(12)
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "export.csv"
    ...     _ = path.write_text(text)
    ...     made = import_export([path])
    >>> made.stamps[0], float(made.columns["FIC1.PV"][2]), float(made.columns["FIC1.PV"][3])
    ('2024-06-28T14:35:00', 2.5, nan)
    >>> made.account["tags"]["FIC1.PV"]["bad"]
    {'quality Bad': 1}
    """
    made = import_runs(paths, settings, callback)
    if len(made.runs) > 1:
        again = made.account["runs"][1]["line"]
        raise InputError(
            f"{paths[0]}, line {again}: the clock starts again, so these are {len(made.runs)} recordings; "
            "take them by import_runs, or export each to a file of its own"
        )
    return made.runs[0]


def import_runs(
    paths: Sequence[str | PathLike[str]],
    settings: ImportSettings | None = None,
    callback: Callable[[str, float], None] | None = None,
) -> ImportedRuns:
    """Make the files of a historian's export clean recordings: one, or one for each run that stands in it.

    Parameters
    ----------
    paths, settings, callback
        As in `import_export`.

    Returns
    -------
    made : ImportedRuns
        All its recordings have the same columns and the same period.

    Raises
    ------
    InputError
        As in `import_export`; and where the clock starts again in one of several files.
    """
    settings, say = settings or ImportSettings(), callback or _silent
    if not 0.0 < settings.gap <= LARGEST_GAP:
        raise InputError(f"expected a --gap above 0 and at most {LARGEST_GAP:g} steps; got {settings.gap:g}")
    reads = [read_text(path, settings.encoding) for path in paths]
    files = []
    for number, read in enumerate(reads):
        say(f"reading {read.file.name}", _READ * number / len(reads))
        table = read_table(
            read, skip_rows=settings.skip_rows, header=settings.header, time_column=settings.time_column
        )
        files.append((table, read_layout(table, settings.time_column)))
    say("reading the numbers", _READ)
    marks = [_mark(table, layout, settings.decimal) for table, layout in files]
    say("reading the times", _MARKED)
    timeline = Timeline(files, settings.zone, settings.day_first)
    say("joining the reports of each tag", _TIMED)
    source = str(reads[0].file)
    lines, runs, empty = _gather_runs(files, [mark.mark for mark in marks], timeline, settings, source)
    kept = [usable(tags, source) for tags in runs]
    held = methods(pooled(kept), settings.hold, settings.linear)
    say("laying all tags on one time base", _GATHERED)
    require_one_clock(len(kept), settings, source)
    step = common_period(kept, settings, source)
    laid = [on_one_base(each, held, step, settings, source) for each in kept]
    say("writing", _ALIGNED)
    common = {
        "schema": told.SCHEMA,
        "files": [
            told.of_file(read, *file, mark) for read, file, mark in zip(reads, files, marks, strict=True)
        ],
        "times": told.of_times(timeline),
    }
    columns = {tag: _column(points) for each in reversed(kept) for tag, points in each.items()}
    columns = {tag: columns[tag] for tag in held}
    made: list[tuple[int, Imported]] = []
    for line, tags, good, (base, silence, aligned) in zip(lines, runs, kept, laid, strict=True):
        some = rows_to_keep(np.any([np.isfinite(each.values) for each in aligned.values()], axis=0))
        some = rows_asked_for(base, some, timeline, settings, source)
        stamps = timeline.stamps(base[some])
        asked = settings.period is not None
        if settings.cuts:
            aligned = {tag: each for tag, each in aligned.items() if np.isfinite(each.values[some]).any()}
            columns = {tag: name for tag, name in columns.items() if tag in aligned}
        own = {
            "base": told.of_base(base, some, stamps, step, asked, settings, silence),
            "tags": {tag: told.of_tag(good[tag], each, held[tag][1]) for tag, each in aligned.items()},
            "left_out": {
                tag: _why_left_out(points, tag in good) for tag, points in tags.items() if tag not in aligned
            },
        }
        nothing = np.full(int(some.sum()), np.nan)
        values = {
            name: aligned[tag].values[some] if tag in aligned else nothing for tag, name in columns.items()
        }
        made.append((line, Imported(stamps, values, own)))
    if len(made) == 1:
        only = made[0][1]
        whole = Imported(only.stamps, only.columns, common | only.account)
        return ImportedRuns((whole,), whole.account)
    runs_told = [{"line": line} | each.account for line, each in made]
    account = common | {"runs": runs_told, "runs_left_out": empty}
    return ImportedRuns(tuple(each for _, each in made), account)


def _gather_runs(
    files: Sequence[tuple[Table, Layout]],
    marks: Sequence[str],
    timeline: Timeline,
    settings: ImportSettings,
    source: str,
) -> tuple[list[int], list[dict[str, Points]], int]:
    """First line and points by tag of each run; how many runs hold no values at two times, and are none."""
    labels = [runs_of_rows(*file, timeline, number) for number, file in enumerate(files)]
    counts = [max(int(each.max(initial=0)) for each in found) + 1 for found in labels]
    if len(files) > 1 and max(counts) > 1:
        number = int(np.argmax(counts))
        table, again = files[number][0], int(np.flatnonzero(labels[number][0] == 1)[0])
        raise InputError(
            f"{table.place(again)}: the clock starts again, so this file holds {counts[number]} runs; import "
            "it by itself"
        )
    if counts[0] == 1:
        tags = gather_points(files, marks, timeline, settings.keep_uncertain)
        return [files[0][0].lines[0]], [tags], 0
    lines, runs = [], []
    for run in range(counts[0]):
        rows = [each == run for each in labels[0]]
        tags = gather_points(files, marks, timeline, settings.keep_uncertain, rows)
        good = [points.times[np.isfinite(points.values)] for points in tags.values()]
        if any(len(np.unique(times)) > 1 for times in good):
            lines.append(files[0][0].lines[int(np.flatnonzero(rows[0])[0])])
            runs.append(tags)
    if not runs:
        raise InputError(
            f"{source}: the clock starts again {counts[0] - 1} times, and no run holds values at two "
            "different times; export longer runs"
        )
    return lines, runs, counts[0] - len(runs)


def _why_left_out(points: Points, good: bool) -> str:
    return "holds no value between the times asked for" if good else why_left_out(points)


def _silent(stage: str, done: float) -> None:
    """Where nobody listens."""


def _column(points: Points) -> str:
    """The tag, and its unit, where there is one, as a valve.toml spells it."""
    reading = read_unit(points.unit)
    if reading is None:
        return f"{points.tag} [{points.unit}]" if points.unit else points.tag
    gauge = {True: "(g)", False: "(a)", None: ""}[reading.gauge]
    return f"{points.tag} [{reading.unit}{gauge}]"


def _mark(table: Table, layout: Layout, given: str | None) -> Mark:
    if given is not None:
        return Mark(given)
    cells = (
        (cell, table.place(int(row)))
        for series in layout.series
        for cell, row in zip(series.values, series.rows, strict=True)
        if "," in cell or "." in cell
    )
    return decimal_mark(cells, table.separator)
