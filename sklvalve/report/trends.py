# SPDX-License-Identifier: BSD-3-Clause
"""Courses over time for the page's script: as fine as a screen shows, and packed."""

from base64 import b64encode

import numpy as np
from numpy.typing import NDArray

from sklvalve.report import signals
from sklvalve.report.courses import Course, recorded_panels, residual_panels

# a wide screen has 4000 columns; of a longer recording each bucket keeps its lowest and highest value
_ROWS, _BUCKETS = 8000, 4000
# the last code is a gap
_STEPS, _GAP = 65534, 65535


def trends(traces: dict) -> dict:
    """What the script draws, as plain data.

    Parameters
    ----------
    traces : dict

    Returns
    -------
    told : dict
        ``time`` (little-endian float32, base64), ``end`` of the last row, ``unit`` and its ``seconds``, the
        ``start`` by the calendar [ms since 1970 by the recording's own clock; None without one], ``label``,
        ``flagged`` times from and to, ``begins`` of joined recordings, ``until``, and ``charts``: by name the
        panels, each a list of courses with ``name``, ``unit``, ``colour``, ``low`` and ``high`` of the scale,
        and
        ``codes`` (little-endian uint16, base64: 0 is `low`, 65534 is `high`, 65535 a gap), one a time, or
        in buckets the lowest and then the highest of each.
    """
    clock = signals.clock(traces)
    starts = _starts(len(clock.values))
    until = traces.get("until")
    shown = until if until and until < len(clock.values) else None
    return {
        "label": signals.time_words(traces),
        "unit": clock.unit,
        "seconds": clock.seconds,
        "start": None if clock.begins is None else clock.stamps[0].astype(np.int64).item(),
        "time": _packed(clock.values[starts].astype("<f4")),
        "end": float(clock.values[-1]),
        "flagged": [list(span) for span in signals.flagged_spans(clock.values, traces["flagged"])],
        "begins": [float(clock.values[row]) for row in list(traces.get("begins", ()))[1:]],
        "until": None if shown is None else float(clock.values[shown]),
        "charts": {
            name: [[_coded(course, starts) for course in panel] for panel in panels]
            for name, panels in (
                ("recording", recorded_panels(traces)),
                ("residual", residual_panels(traces)),
            )
            if panels
        },
    }


def _starts(rows: int) -> NDArray[np.intp]:
    """First rows of the buckets; every row where they are few."""
    if rows <= _ROWS:
        return np.arange(rows)
    return np.unique(np.linspace(0, rows, _BUCKETS + 1).astype(int))[:-1]


def _coded(course: Course, starts: NDArray[np.intp]) -> dict:
    values = course.values
    if len(starts) < len(values):
        lows = np.fmin.reduceat(values, starts)
        highs = np.fmax.reduceat(values, starts)
        values = np.column_stack([lows, highs]).ravel()
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    scale = (high - low) or 1.0
    with np.errstate(invalid="ignore"):
        codes = np.where(np.isfinite(values), np.round((values - low) / scale * _STEPS), _GAP)
    return {
        "name": course.name,
        "unit": course.unit,
        "colour": course.colour,
        "low": low,
        "high": low + scale,
        "codes": _packed(codes.astype("<u2")),
    }


def _packed(values: NDArray) -> str:
    return b64encode(values.tobytes()).decode("ascii")
