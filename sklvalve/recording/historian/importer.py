# SPDX-License-Identifier: BSD-3-Clause
"""An export's way to a clean recording: text, table, series, points, base; and the account of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.historian import account as told
from sklvalve.recording.historian.align import Aligned, Pace, align, base_of, choose_period, pace_of, silences
from sklvalve.recording.historian.clean import Points
from sklvalve.recording.historian.decimals import Mark, decimal_mark
from sklvalve.recording.historian.gather import gather_points, methods, usable, why_left_out
from sklvalve.recording.historian.layout import Layout, read_layout
from sklvalve.recording.historian.moments import SECOND
from sklvalve.recording.historian.table import Table, read_table
from sklvalve.recording.historian.text import read_text
from sklvalve.recording.historian.timeline import Timeline
from sklvalve.recording.tags import read_unit

_MOST_ROWS = 5_000_000
# periods [s]: times are kept to microseconds, and none of a plant is further from the next than years
_SHORTEST, _LONGEST = 1e-6, 1e9
#: Most steps that may be bridged.
LARGEST_GAP = 1e6
# rows without any value that are kept in between; a recording may lack rows, but need not in every short gap
_LONGEST_EMPTY = 100
# shares of the time that are gone by when files are tables, their decimal mark and their times are known, and
# the points of each tag are joined, and laid on one base (long and wide exports of 16 and 33 MB)
_READ, _MARKED, _TIMED, _GATHERED, _ALIGNED = 0.35, 0.5, 0.8, 0.85, 0.95


@dataclass(frozen=True)
class ImportSettings:
    """How an export is to be read, where it does not tell itself.

    Parameters
    ----------
    zone : str or None
        Time zone of local times, by name or offset from UTC.
    period : float or None
        Period of the recording [s]; None chooses it from the stamps.
    gap : float
        Longest stretch without a report that is bridged, in a tag's usual steps.
    day_first : bool or None
        Whether 03/04/2024 is the third of April; None finds out.
    decimal : {".", ","} or None
        Decimal mark; None finds it.
    encoding : str or None
        Encoding of the files; None finds it.
    keep_uncertain : bool
        Whether values of uncertain quality count.
    hold, linear : tuple of str
        Tags that hold their last value, or run straight, between reports, whatever their names say.
    """

    zone: str | None = None
    period: float | None = None
    gap: float = 5.0
    day_first: bool | None = None
    decimal: str | None = None
    encoding: str | None = None
    keep_uncertain: bool = False
    hold: tuple[str, ...] = ()
    linear: tuple[str, ...] = ()


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


def import_export(
    paths: Sequence[str | PathLike[str]],
    settings: ImportSettings = ImportSettings(),
    callback: Callable[[str, float], None] | None = None,
) -> Imported:
    """Make the files of a historian's export one clean recording.

    Parameters
    ----------
    paths : sequence of str or path-like
        Text files, in long format (tag, time, value, quality) or wide (a column for each tag).
    settings : ImportSettings
    callback : callable or None, default=None
        Called as ``callback(stage, done)`` with a plain word and the share done.

    Returns
    -------
    imported : Imported

    Raises
    ------
    InputError
        With one sentence that names file, line, what was expected and the mend.

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
    say = callback or _silent
    if not 0.0 < settings.gap <= LARGEST_GAP:
        raise InputError(f"expected a --gap above 0 and at most {LARGEST_GAP:g} steps; got {settings.gap:g}")
    reads = [read_text(path, settings.encoding) for path in paths]
    files = []
    for number, read in enumerate(reads):
        say(f"reading {read.file.name}", _READ * number / len(reads))
        table = read_table(read)
        files.append((table, read_layout(table)))
    say("reading the numbers", _READ)
    marks = [_mark(table, layout, settings.decimal) for table, layout in files]
    say("reading the times", _MARKED)
    timeline = Timeline(files, settings.zone, settings.day_first)
    say("joining the reports of each tag", _TIMED)
    tags = gather_points(files, [mark.mark for mark in marks], timeline, settings.keep_uncertain)
    kept = usable(tags, str(reads[0].file))
    held = methods(kept, settings.hold, settings.linear)
    say("laying all tags on one time base", _GATHERED)
    base, period, silence, aligned = _on_one_base(kept, held, settings, str(reads[0].file))

    say("writing", _ALIGNED)
    some = _rows_to_keep(np.any([np.isfinite(each.values) for each in aligned.values()], axis=0))
    stamps = timeline.stamps(base[some])
    account = {
        "schema": told.SCHEMA,
        "files": [
            told.of_file(read, *file, mark) for read, file, mark in zip(reads, files, marks, strict=True)
        ],
        "times": told.of_times(timeline),
        "base": told.of_base(base, some, stamps, period, settings.period is not None, settings.gap, silence),
        "tags": {tag: told.of_tag(kept[tag], each, held[tag][1]) for tag, each in aligned.items()},
        "left_out": {tag: why_left_out(points) for tag, points in tags.items() if tag not in kept},
    }
    return Imported(stamps, {_column(kept[tag]): each.values[some] for tag, each in aligned.items()}, account)


def _silent(stage: str, done: float) -> None:
    """Where nobody listens."""


def _on_one_base(
    kept: dict[str, Points], held: dict[str, tuple[bool, str]], settings: ImportSettings, source: str
) -> tuple[NDArray[np.int64], int, float, dict[str, Aligned]]:
    """Base, its period, the longest usual silence of all tags [us], and all tags on it."""
    paces = {tag: pace for tag, points in kept.items() if (pace := pace_of(points))}
    if not paces:
        raise InputError(
            f"{source}: no tag has values at two different times, so there is no course; export a longer "
            "time range"
        )
    all_points = list(kept.values())
    wanted = settings.period or choose_period(list(paces.values())) / SECOND
    _require_bearable(all_points, wanted, source)
    period = round(SECOND * wanted)
    base = base_of(all_points, period)
    typical = float(np.median([pace.step for pace in paces.values()]))
    quiet, silence = silences(all_points, settings.gap)
    aligned = {
        tag: align(
            points,
            paces.get(tag, Pace(typical, scanned=False)),
            base,
            hold=held[tag][0],
            multiple=settings.gap,
            quiet=quiet,
        )
        for tag, points in kept.items()
    }
    if not any(np.isfinite(each.values).any() for each in aligned.values()):
        raise InputError(
            f"{source}: no row of a base of {period / SECOND:g} s holds a value; give a shorter --period, or "
            "a larger --gap"
        )
    return base, period, silence, aligned


def _rows_to_keep(some: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """All rows but those before and after all values, and those of long stretches without any."""
    kept = some.copy()
    places = np.flatnonzero(some)
    steps = np.diff(places)
    for gap in np.flatnonzero((steps > 1) & (steps <= _LONGEST_EMPTY)):
        kept[places[gap] : places[gap + 1]] = True
    return kept


def _require_bearable(all_points: list[Points], period: float, source: str) -> None:
    """Refuse a period [s] of too many rows, and one that no time can be told to or no count can hold."""
    times = np.concatenate([points.times[[0, -1]] for points in all_points])
    rows = (float(times.max()) - float(times.min())) / SECOND / period + 1.0
    if rows > _MOST_ROWS:
        raise InputError(
            f"{source}: from first to last time there are {rows:.7g} rows of {period:g} s, more than "
            f"{_MOST_ROWS}; give a longer --period, or export a shorter time range"
        )
    if not _SHORTEST <= period <= _LONGEST:
        raise InputError(
            f"{source}: expected a --period from {_SHORTEST:g} to {_LONGEST:g} s; got {period:g} s"
        )


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
