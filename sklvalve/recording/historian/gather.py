# SPDX-License-Identifier: BSD-3-Clause
"""Points of each tag out of all files of an export, and which tags can be part of a recording."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError, hint
from sklvalve.recording.historian.clean import Points, join_points, read_points
from sklvalve.recording.historian.layout import Layout, Series
from sklvalve.recording.historian.table import Table
from sklvalve.recording.historian.timeline import Timeline
from sklvalve.recording.tags import read_name

_HELD_ROLES = ("command", "setpoint")
_FEW_LEVELS = 10


def gather_points(
    files: Sequence[tuple[Table, Layout]],
    marks: Sequence[str],
    timeline: Timeline,
    keep_uncertain: bool,
    rows_of_run: Sequence[NDArray[np.bool_]] | None = None,
) -> dict[str, Points]:
    """Points by tag, joined over the files.

    Parameters
    ----------
    files : sequence of (Table, Layout)
    marks : sequence of {".", ","}
        Decimal mark of each file.
    timeline : Timeline
    keep_uncertain : bool
        Whether values of uncertain quality count.
    rows_of_run : sequence of ndarray of shape (n,), bool, or None
        For each clock of the only file the rows of the run that is wanted; None takes all rows.

    Returns
    -------
    points : dict
        Tag -> `Points`.

    Raises
    ------
    InputError
        If a file holds a tag twice, files give a tag different units, or files that count seconds overlap.
    """
    parts: dict[str, list[Points]] = {}
    homes: dict[str, list[Path]] = {}
    for number, (table, layout) in enumerate(files):
        shared: dict[tuple[int, bytes], NDArray[np.int64]] = {}
        for series in layout.series:
            if homes.get(series.tag, [None])[-1] == table.file:
                raise InputError(
                    f"{table.file}: two columns are called {series.tag!r}; rename one of the two"
                )
            homes.setdefault(series.tag, []).append(table.file)
            timed = timeline.timed(number, series)
            if rows_of_run is not None:
                timed = timed[rows_of_run[series.clock][series.rows[timed]]]
            rows = series.rows[timed]
            # the columns of a wide table are one stream, whose clock changes are told once
            key = series.clock, rows.tobytes()
            if key not in shared:
                shared[key] = timeline.times(number, series.clock, rows)
            points = read_points(_only(series, timed), shared[key], marks[number], keep_uncertain)
            parts.setdefault(series.tag, []).append(points)
    for tag, found in parts.items():
        _require_one_unit(tag, found, homes[tag])
        if timeline.kind == "seconds":
            _require_apart(found, homes[tag])
    return {tag: join_points(found) for tag, found in parts.items()}


def usable(tags: dict[str, Points], source: str) -> dict[str, Points]:
    """Tags that hold numbers.

    Raises
    ------
    InputError
        If none does.
    """
    kept = {tag: points for tag, points in tags.items() if np.isfinite(points.values).any()}
    if not kept:
        told = "; ".join(f"{tag} {why_left_out(points)}" for tag, points in list(tags.items())[:3])
        raise InputError(
            f"{source}: no tag holds a good number ({told}); export the tags of the measured values"
        )
    return kept


def why_left_out(points: Points) -> str:
    """Why a tag cannot be part of a recording, in words."""
    if points.states:
        return f"holds states ({', '.join(text for text, _ in points.states.most_common(3))}), no numbers"
    if points.bad:
        return f"holds no good value ({', '.join(text for text, _ in points.bad.most_common(3))})"
    return "holds nothing"


def pooled(runs: Sequence[dict[str, Points]]) -> dict[str, Points]:
    """Tags that hold numbers in any of the runs, each with the values of all, whatever their times."""
    together: dict[str, list[Points]] = {}
    for run in runs:
        for tag, points in run.items():
            together.setdefault(tag, []).append(points)
    return {
        tag: replace(
            parts[0],
            times=np.concatenate([part.times for part in parts]),
            values=np.concatenate([part.values for part in parts]),
        )
        for tag, parts in together.items()
    }


def methods(
    kept: dict[str, Points], hold: Sequence[str], linear: Sequence[str]
) -> dict[str, tuple[bool, str]]:
    """Whether each tag holds its last value between reports, and why, in words.

    Raises
    ------
    InputError
        If a tag that is asked for is not there.
    """
    for option, asked in (("--hold", hold), ("--linear", linear)):
        for tag in asked:
            if tag not in kept:
                raise InputError(f"{option} {tag}: the export has no such tag; {hint(tag, kept)}")
    return {tag: _method(points, tag in hold, tag in linear) for tag, points in kept.items()}


def _method(points: Points, hold: bool, linear: bool) -> tuple[bool, str]:
    if hold or linear:
        return hold, "as asked"
    reading = read_name(points.tag, points.unit)
    if reading.role is not None:
        held = reading.role in _HELD_ROLES
        return held, f"{reading.role.replace('_', ' ')}, by {reading.why}"
    levels = len(np.unique(points.values[np.isfinite(points.values)]))
    return levels <= _FEW_LEVELS, f"its name tells no role, and it holds {levels} levels"


def _only(series: Series, timed: NDArray[np.intp]) -> Series:
    if len(timed) == len(series.rows):
        return series
    quality = None if series.quality is None else [series.quality[place] for place in timed]
    return replace(
        series, rows=series.rows[timed], values=[series.values[place] for place in timed], quality=quality
    )


def _require_one_unit(tag: str, parts: list[Points], homes: list[Path]) -> None:
    for part, home in zip(parts, homes, strict=True):
        if part.unit and parts[0].unit and part.unit != parts[0].unit:
            raise InputError(
                f"{home}: {tag} is in {part.unit!r}, but in {parts[0].unit!r} in {homes[0]}; export it in "
                "one unit"
            )


def _require_apart(parts: list[Points], homes: list[Path]) -> None:
    spans = sorted(
        (int(part.times.min()), int(part.times.max()), str(home))
        for part, home in zip(parts, homes, strict=True)
        if len(part.times)
    )
    for (_, end, one), (begin, _, other) in pairwise(spans):
        if begin <= end:
            raise InputError(
                f"{other}: its seconds begin anew, within those of {one}; import each file by itself, "
                "for sklvalve diagnose takes several recordings"
            )
