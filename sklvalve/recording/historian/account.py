# SPDX-License-Identifier: BSD-3-Clause
"""What was read, assumed and done with an export, as plain data."""

from collections import Counter
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.historian.align import Aligned
from sklvalve.recording.historian.clean import Points
from sklvalve.recording.historian.decimals import Mark
from sklvalve.recording.historian.layout import Layout
from sklvalve.recording.historian.moments import SECOND
from sklvalve.recording.historian.settings import ImportSettings
from sklvalve.recording.historian.table import SEPARATORS, Table
from sklvalve.recording.historian.text import ExportText
from sklvalve.recording.historian.timeline import Timeline

SCHEMA = "sklvalve.import/1"


def of_file(read: ExportText, table: Table, layout: Layout, mark: Mark) -> dict:
    """How one file was understood."""
    return {
        "file": str(read.file),
        "sha256": read.sha256,
        "encoding": read.encoding,
        "separator": SEPARATORS.get(table.separator, table.separator),
        "decimal": mark.mark,
        "decimal_assumed": mark.assumed,
        "format": layout.format,
        "rows": len(table.lines),
        "lines_above": table.above,
        "lines_skipped": table.skipped,
    }


def of_times(timeline: Timeline) -> dict:
    """What kind of times these are, and what clock changes made of them."""
    return {
        "kind": timeline.kind,
        "zone": None if timeline.zone is None else str(timeline.zone),
        "day_first_assumed": timeline.order.assumed,
        "repeated_hour": timeline.changes.told_apart,
        "repeated_hour_assumed_first": timeline.changes.assumed,
        "missing_hour": timeline.changes.late,
    }


def of_base(
    base: NDArray[np.int64],
    held: NDArray[np.bool_],
    stamps: NDArray,
    period: int,
    asked: bool,
    settings: ImportSettings,
    silence: float,
) -> dict:
    """The regular base, and which of its rows the recording has.

    The gap of `settings` is counted in usual steps; `silence` [us] is the longest of all tags through which
    one by exception is followed.
    """
    first, last = np.flatnonzero(held)[[0, -1]]
    within = held[first : last + 1] if settings.cuts else held
    return {
        "period": period / SECOND,
        "chosen_by": "--period" if asked else "stamps",
        "rows": int(held.sum()),
        "rows_without_any_value": int((~within).sum()),
        "first": _plain(stamps[0]),
        "last": _plain(stamps[-1]),
        "cut": {"from": settings.begin, "until": settings.end} if settings.cuts else None,
        "gap": settings.gap,
        "longest_silence": silence / SECOND,
    }


def of_tag(points: Points, aligned: Aligned, why: str) -> dict:
    """What was done to one tag, as counts of reports and of rows; times in s."""
    return {
        "unit": points.unit,
        "reports": points.rows,
        "bad": _counts(points.bad),
        "states": _counts(points.states),
        "out_of_order": points.out_of_order,
        "doubled": points.doubled,
        "contradicting": points.contradicting,
        "reports_by": "scan" if aligned.scanned else "exception",
        "step": aligned.step,
        "method": aligned.method,
        "method_because": why,
        "exact": aligned.exact,
        "resampled": aligned.between,
        "filled": aligned.filled,
        "missing": aligned.missing,
        "gaps": aligned.gaps,
        "longest_gap": aligned.longest_gap,
        "longest_bridged": aligned.longest_bridged,
        "unused": aligned.unused,
    }


def _counts(counted: Counter[str]) -> Mapping[str, int]:
    return dict(counted.most_common())


def _plain(stamp: object) -> str | float:
    return stamp if isinstance(stamp, str) else float(stamp)  # type: ignore[arg-type]
