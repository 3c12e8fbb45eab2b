# SPDX-License-Identifier: BSD-3-Clause
"""Screens of single values: coarse steps, a range that ends too early, a value that stands still."""

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._rest import rests
from sklvalve.recording._screen_command import screen_command
from sklvalve.recording._screen_lines import straight_lines
from sklvalve.recording._screen_tools import (
    Finding,
    equal_runs,
    finding,
    measured,
    quantum,
    recorded,
    resting_quantum,
    worth,
)
from sklvalve.recording.noise import noise_floor
from sklvalve.recording.recording import Recording
from sklvalve.recording.signal import OPENING_ROLES

_COARSE, _FINE = 1.0 / 500.0, 1e-3  # of the span; an effect counts from 0.5 % of it
_FEW_ROWS = 20


def screen_quantised(recording: Recording) -> list[Finding]:
    """Steps that are coarse against the noise, or against the span of the signal."""
    found = []
    for role in measured(recording):
        values = recorded(recording, role)
        step, resting = quantum(values), resting_quantum(values)
        low, high = np.nanquantile(values, [0.01, 0.99])
        noise, span = noise_floor(values), max(high - low, step, resting)
        between = ""
        if resting > 2.0 * step:
            step, between = resting, ", redrawn between them"
        if not step or not (
            (step >= noise and step >= _FINE * span) or (step >= 0.6 * noise and step >= _COARSE * span)
        ):
            continue
        if straight_lines(recording.time, values, step):
            continue  # a historian took the noise that its digits are finer than
        unit = recording.unit(role)
        detail = (
            f"read in steps of {step:.4g} {unit}{between}, {100.0 * step / span:.2g} % of its span; "
            f"its noise is {noise:.2g} {unit} between samples"
        )
        found.append(finding("quantised", role, detail, size=step / worth(recording, role)))
    return found


def screen_saturated(recording: Recording) -> list[Finding]:
    """Values that pile up at the end of a range, where neither a stop nor a shut valve puts them."""
    found = []
    for role in measured(recording):
        values = recorded(recording, role)
        for end, limit in (("top", np.nanmax(values)), ("bottom", np.nanmin(values))):
            if _harmless_end(recording, role, values, limit):
                continue
            at_end = values == limit
            spans = [span for span in equal_runs(np.where(at_end, values, np.nan)) if span[1] - span[0] >= 3]
            clipped = sum(stop - start for start, stop in spans)
            if clipped < max(_FEW_ROWS, 0.005 * len(values)) or _repeats(values[~at_end]) > 0.5:
                continue
            if at_end.sum() < 5.0 * _rows_near(values, limit):
                continue
            share = 100.0 * clipped / len(values)
            place = f"the {end} of its range, {limit:g} {recording.unit(role)}"
            detail = f"stands at {place}, in {share:.2g} % of the rows"
            found.append(finding("saturated", role, detail, spans))
    return found


def screen_frozen(recording: Recording) -> list[Finding]:
    """A sensor that repeats one value far longer than its noise allows."""
    found = screen_command(recording)
    for role in measured(recording):
        values = recorded(recording, role)
        present = values[np.isfinite(values)]
        if len(present) >= _FEW_ROWS and (present == present[0]).all():
            detail = f"holds one value, {present[0]:g} {recording.unit(role)}, from first to last row"
            found.append(finding("frozen", role, detail))
            continue
        resting = resting_quantum(values)
        spans = [
            (start, stop)
            for start, stop in equal_runs(values)
            if _too_long(values, start, stop, resting)
            and not _natural_end(recording, role, values, values[start])
            and not rests(recording, role, start, stop)
        ]
        if spans:
            longest = max(stop - start for start, stop in spans) * recording.sample_time
            detail = f"stands still {len(spans)} times, up to {longest:g} s, although it jitters otherwise"
            if len(spans) == 1:
                detail = f"stands still for {longest:g} s, although it jitters otherwise"
            found.append(finding("frozen", role, detail, spans))
    return found


def _too_long(values: NDArray[np.float64], start: int, stop: int, resting: float) -> bool:
    """Whether a run of equal values is longer than chance makes it, by the rows on both its sides."""
    length = stop - start
    if length < _FEW_ROWS:
        return False
    around = np.concatenate([values[max(0, start - 3 * length) : start], values[stop : stop + 3 * length]])
    repeats = max(_repeats(around), 1.0 / len(values))
    if repeats > 0.5:  # a signal this still says nothing by standing still
        return False
    if resting and noise_floor(around) < resting:  # the step of the reading swallows the jitter
        return False
    by_chance = np.log(len(values)) / -np.log(repeats)
    return length > 3.0 * by_chance + 10.0


def _repeats(values: NDArray[np.float64]) -> float:
    """Share of rows that repeat the row before; 1 for less than two rows, which show no jitter."""
    step = np.diff(values[np.isfinite(values)])
    return float((step == 0.0).mean()) if len(step) else 1.0


def _rows_near(values: NDArray[np.float64], limit: float) -> float:
    """Rows that each of the ten distinct values next to a limit holds, on average."""
    distinct, counts = np.unique(values[np.isfinite(values)], return_counts=True)
    order = np.argsort(np.abs(distinct - limit))[1:11]
    return float(counts[order].mean()) if len(order) else float(len(values))


def _harmless_end(recording: Recording, role: str, values: NDArray[np.float64], limit: float) -> bool:
    """Whether a sensor may well stand at a limit: a stop of the stem, or no flow to speak of."""
    if role in OPENING_ROLES:
        place = float(recording.signal(role).to_si([limit])[0])
        return not 0.03 < place < 0.97
    # a meter that cuts small flows off shows nought; below it stands one whose range ends there
    return role == "flow" and -0.005 <= limit / np.nanmax(np.abs(values)) <= 0.03


def _natural_end(recording: Recording, role: str, values: NDArray[np.float64], value: float) -> bool:
    """Whether a value is where a valve rests: a stop of the stem, or the least flow that the meter shows."""
    if role in OPENING_ROLES:
        return value in (np.nanmin(values), np.nanmax(values))
    return role == "flow" and value == np.nanmin(values)
