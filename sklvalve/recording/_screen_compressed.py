# SPDX-License-Identifier: BSD-3-Clause
"""A historian's traces: straight lines between the points it kept, values it held, moves it left out."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_lines import different, straight_lines
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

Values = NDArray[np.float64]

_FINEST = 2e-7  # of the largest value; finer steps than that are the computer's
_LEAST_CHORDS = 50
_EXCESS = 4.0  # straight triples, as a multiple of what bends of nearly nought let expect
_BLURRED = 4.0  # written steps; what rounding leaves of a bend that is none
_SHUFFLED = 8.0  # written steps; bends below them are the rounding's
_LEAST_CHANGES = 12
_BESIDE_THE_STEM, _OTHERS_HELD = ("p1", "p2", "temperature"), 2


class _Told(NamedTuple):
    """What was seen, and the historian's dead band in the recorded unit where it has one."""

    detail: str
    band: float | None = None


def screen_compressed(recording: Recording) -> list[Finding]:
    """A sensor's course redrawn from few points: straight lines, a dead band, or a slower scan."""
    found = []
    for role in measured(recording):
        values = recorded(recording, role)
        unit = recording.unit(role)
        detail = _straight_lines(recording.time, values) or _chords(recording.time, values)
        told = _Told(detail) if detail else _held(values, unit) or _edge(values, unit)
        if told:
            band = told.band and told.band / abs(recording.per_si(role))
            found.append(finding("compressed", role, told.detail, size=band))
    return found + _steps_held(recording, found)


def _steps_held(recording: Recording, found: list[Finding]) -> list[Finding]:
    """Coarse readings that were held as well, told where the historian held other signals.

    A stem that sticks moves so too, by several steps at once, and a flow goes with it; but no temperature
    stands still for that, and the pressures seldom do.
    """
    held = {each["role"] for each in found if each.get("size")}
    if len(held.intersection(_BESIDE_THE_STEM)) < _OTHERS_HELD:
        return []
    told, seen = [], {each["role"] for each in found}
    for role in measured(recording):
        if role in seen:
            continue
        values = recorded(recording, role)
        moves = np.abs(np.diff(values))
        moves, rows = moves[moves > 0.0], np.isfinite(moves).sum()
        levels = np.unique(np.round(values[np.isfinite(values)], 9))
        if not _LEAST_CHANGES < len(moves) < 0.5 * rows or len(levels) < _LEAST_CHANGES:
            continue
        step, band = float(np.median(np.diff(levels))), float(np.quantile(moves, 0.02))
        if band > 1.5 * step:
            left_out = _left_out(band, step, recording.unit(role))
            size = band / abs(recording.per_si(role))
            told.append(finding("compressed", role, left_out.detail, size=size))
    return told


def _straight_lines(time: Values, values: Values) -> str | None:
    """Share of the moving rows inside straight lines."""
    largest = np.nanmax(np.abs(values), initial=0.0)
    lines = straight_lines(time, values, max(_written_step(values), quantum(values), 1e-8 * largest))
    if lines is None:
        return None
    return (
        f"{100.0 * lines.share:.0f} % of its course is straight lines of {lines.rows:g} rows in the middle: "
        "a historian kept only their ends, so lags and friction cannot be judged from it"
    )


def _chords(time: Values, values: Values) -> str | None:
    """Short lines, told by how often three samples lie on one exactly.

    Bends of real noise are spread evenly about nought, so those of less than a written step must be as rare
    as those a little larger. A rate limit, or noise below the digits, is told by slopes and breaks.
    """
    written = max(_written_step(values), quantum(values), _FINEST * np.nanmax(np.abs(values), initial=0.0))
    step = np.diff(time)
    if written <= 0.0 or len(values) < 4 * _LEAST_CHORDS:
        return None
    slope = np.diff(values) / step
    rises = np.abs(np.diff(values)) / written
    bend = np.abs(np.diff(slope)) * step[1:] / written
    moving = (rises[1:] > 3.0) & (rises[:-1] > 3.0)
    broken = bend[moving & (bend > 1.5)]
    # a converter's step is no round number: written with more digits it is still the least that a bend can be
    least = float(np.quantile(broken, 0.02)) if len(broken) else 0.0
    edge = 0.5 * least if least > _BLURRED else 1.5
    straight, close = moving & (bend <= edge), moving & (bend > edge) & (bend <= 5.0 * edge)
    lines = runs(straight)
    if len(lines) < max(_LEAST_CHORDS, 0.05 * moving.sum()) or not len(broken):
        return None
    # four times as wide a band of bends, so a quarter of those in it are expected among the straight ones
    if straight.sum() < _EXCESS * (0.25 * close.sum() + 1.0) or np.median(broken) < _SHUFFLED:
        return None
    if not different(np.array([slope[start] for start, _ in lines])):
        return None
    return (
        f"{100.0 * straight.sum() / moving.sum():.0f} % of its moving samples lie on the line through both "
        "neighbours, to the last digit: a historian kept only the ends of lines, so lags, friction and noise "
        "cannot be judged from it"
    )


def _held(values: Values, unit: str) -> _Told | None:
    """Values held between updates: by a dead band of the historian, or by a scan slower than the rows."""
    step = np.abs(np.diff(values))
    changes = np.flatnonzero(step > 0.0)
    moves = step[changes]
    written = max(_written_step(values), quantum(values), resting_quantum(values))
    if len(changes) < _LEAST_CHANGES or len(changes) > 0.5 * len(step):
        return None
    apart = np.bincount(np.diff(changes))
    scan = int(apart.argmax())
    if scan >= 2 and (np.diff(changes) % scan == 0).mean() > 0.95:
        return _Told(
            f"each value is held for {scan} rows: it was scanned more slowly than the rows were written"
        )
    band = float(np.quantile(moves, 0.02))
    small = moves[moves < 5.0 * band] / band
    places = np.exp(2j * np.pi * values[changes] / band)
    near = (np.abs(small - np.round(small)) < 0.15).mean() > 0.8
    if near and (np.abs(places.mean()) > 0.5 or len(changes) > 0.2 * len(step)):
        return None  # a coarse reading, whose steps only vary a little
    if written and band > 10.0 * written and len(np.unique(moves)) > min(20, 0.6 * len(moves)):
        return _left_out(band, written, unit)
    return None


def _edge(values: Values, unit: str) -> _Told | None:
    """Moves that begin at a dead band: none below it, many of all sizes just above.

    A coarse reading moves by its steps and comes back to the same levels; a rate limit gives the same move
    row after row; a stem that answers steps of its command moves by any amount.
    """
    step = np.diff(values)
    changes = np.flatnonzero(np.abs(step) > 0.0)
    written = max(_written_step(values), _FINEST * np.nanmax(np.abs(values), initial=0.0))
    if len(changes) < _LEAST_CHANGES or written <= 0.0 or len(changes) > 0.95 * len(step):
        return None
    moves = np.abs(step[changes])
    band = float(np.quantile(moves, 0.005, method="higher"))
    just, equal = moves < 2.0 * band, moves <= band + 1.5 * written
    levels = np.ptp(values[np.isfinite(values)]) / band + 1.0
    if band < 10.0 * written or just.mean() < 0.25 or just.sum() < _LEAST_CHANGES:
        return None
    if equal.sum() > 0.7 * just.sum() or len(np.unique(values[changes + 1])) < 1.5 * levels:
        return None
    alone = np.concatenate([[True], np.diff(changes) > 1]) & np.concatenate([np.diff(changes) > 1, [True]])
    turns = np.concatenate([[False], np.diff(np.sign(step[changes])) != 0.0])
    if (alone | turns)[just].mean() < 0.5:
        return None
    return _left_out(band, written, unit)


def _left_out(band: float, written: float, unit: str) -> _Told:
    detail = (
        f"changes of less than {band:.3g} {unit} are missing, although its step is {written:.3g} {unit}: "
        "a historian kept larger ones only, so what is smaller cannot be judged"
    )
    return _Told(detail, band)


def _written_step(values: Values) -> float:
    """Power of ten that all values are multiples of, by their digits; 0 for more than six digits."""
    present = values[np.isfinite(values)]
    if not len(present):
        return 0.0
    first = int(np.floor(np.log10(max(np.abs(present).max(), 1e-300))))
    for digits in range(first, first - 7, -1):
        if np.abs(present - np.round(present, -digits)).max() < 1e-6 * 10.0**digits:
            return 10.0**digits
    return 0.0
