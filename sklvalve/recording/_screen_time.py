# SPDX-License-Identifier: BSD-3-Clause
"""Screens of the course in time: gaps, a historian's straight lines and holds."""

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_tools import (
    Finding,
    finding,
    measured,
    quantum,
    recorded,
    resting_quantum,
    runs,
)
from sklvalve.recording.recording import Recording

_LEAST_LINES = 10


def screen_gaps(recording: Recording) -> list[Finding]:
    """Rows missing between the times, and values missing within the rows."""
    found = []
    step = np.diff(recording.time)
    typical = recording.sample_time
    wide = np.flatnonzero(step > 1.5 * typical)
    if len(wide):
        detail = (
            f"rows missing between samples of {typical:g} s; gaps: {len(wide)}, longest: {step.max():g} s"
        )
        found.append(finding("gap", None, detail, [(int(row), int(row) + 2) for row in wide]))
    for role, values in recording.signals.items():
        spans = runs(np.isnan(values))
        if spans:
            missing = sum(stop - start for start, stop in spans)
            longest = max(stop - start for start, stop in spans)
            detail = f"{missing} of {len(values)} values missing; gaps: {len(spans)}, longest: {longest} rows"
            found.append(finding("gap", role, detail, spans))
    return found


def screen_compressed(recording: Recording) -> list[Finding]:
    """A sensor's course redrawn from few points: straight lines, a dead band, or a slower scan."""
    found = []
    for role in measured(recording):
        values = recorded(recording, role)
        detail = _straight_lines(recording.time, values) or _held(values, recording.unit(role))
        if detail:
            found.append(finding("compressed", role, detail))
    return found


def _straight_lines(time: NDArray[np.float64], values: NDArray[np.float64]) -> str | None:
    """Share of the moving rows inside straight lines.

    Noise read in steps puts three samples on a line by chance, but hardly six. A valve at its rate limit also
    runs straight, but always at the same slope; between a historian's points each line has its own.
    """
    slope = np.diff(values) / np.diff(time)
    written = max(_written_step(values), quantum(values), 1e-8 * np.nanmax(np.abs(values), initial=0.0))
    room = 2.1 * written / np.diff(time)[1:]
    bends = np.abs(np.diff(slope)) > room
    lines = [(start, stop + 2) for start, stop in runs(~bends & (slope[1:] != 0.0)) if stop - start >= 4]
    slopes = [(values[stop - 1] - values[start]) / (time[stop - 1] - time[start]) for start, stop in lines]
    rises = [abs(values[stop - 1] - values[start]) for start, stop in lines]
    # a line must rise far more than the digits it is written in, or noise below these would count as one
    kept = [place for place, rise in enumerate(rises) if rise > 10.0 * written]
    moving = int((slope != 0.0).sum())
    inside = sum(lines[place][1] - lines[place][0] - 1 for place in kept)
    if len(kept) < _LEAST_LINES or inside < 0.6 * moving:
        return None
    sizes = np.array([slopes[place] for place in kept])
    different = len(np.unique(np.round(np.log(np.abs(sizes)) / 0.02)))
    if different < 0.3 * min(len(kept), 100):
        return None
    rows = float(np.median([lines[place][1] - lines[place][0] for place in kept]))
    return (
        f"{100.0 * inside / moving:.0f} % of its course is straight lines of {rows:g} rows in the middle: "
        "a historian kept only their ends, so lags and friction cannot be judged from it"
    )


def _held(values: NDArray[np.float64], unit: str) -> str | None:
    """Values held between updates: by a dead band of the historian, or by a scan slower than the rows."""
    step = np.abs(np.diff(values))
    changes = np.flatnonzero(step > 0.0)
    moves = step[changes]
    written = max(_written_step(values), quantum(values), resting_quantum(values))
    if len(changes) < 12 or len(changes) > 0.5 * len(step):
        return None
    apart = np.bincount(np.diff(changes))
    scan = int(apart.argmax())
    if scan >= 2 and (np.diff(changes) % scan == 0).mean() > 0.95:
        return f"each value is held for {scan} rows: it was scanned more slowly than the rows were written"
    band = float(np.quantile(moves, 0.02))
    small = moves[moves < 5.0 * band] / band
    places = np.exp(2j * np.pi * values[changes] / band)
    near = (np.abs(small - np.round(small)) < 0.15).mean() > 0.8
    if near and (np.abs(places.mean()) > 0.5 or len(changes) > 0.2 * len(step)):
        return None  # a coarse reading, whose steps only vary a little
    if written and band > 10.0 * written and len(np.unique(moves)) > min(20, 0.6 * len(moves)):
        return (
            f"changes of less than {band:.3g} {unit} are missing, although its step is {written:.3g} {unit}: "
            f"a historian kept larger ones only, so lags and friction cannot be judged"
        )
    return None


def _written_step(values: NDArray[np.float64]) -> float:
    """Power of ten that all values are multiples of, by their digits; 0 for more than six digits."""
    present = values[np.isfinite(values)]
    if not len(present):
        return 0.0
    first = int(np.floor(np.log10(max(np.abs(present).max(), 1e-300))))
    for digits in range(first, first - 7, -1):
        if np.abs(present - np.round(present, -digits)).max() < 1e-6 * 10.0**digits:
            return 10.0**digits
    return 0.0
