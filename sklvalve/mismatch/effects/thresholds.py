# SPDX-License-Identifier: BSD-3-Clause
"""Errors that a recorded motor answers or leaves alone: where a fit of its dead band begins."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sklvalve.recording import Recording

# a motor that has not begun to move by then leaves the error alone [s]
_ANSWERS_WITHIN = 0.8
# what a position sensor shows of a motor at rest [1]
_STILL = 3e-4
_FEWEST = 5


@lru_cache(maxsize=8)
def seen_thresholds(recording: Recording) -> tuple[tuple[float, float], tuple[float, float] | None] | None:
    """Errors from which on a recorded motor starts, going on and turning [1]; None where few are seen.

    Of the errors that it left alone until the next step and of those that it answered, each threshold is the
    one that puts the fewest on the wrong side.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    thresholds : tuple (going on, turning), or None
        Each as (low, high), between an error left alone and one answered; turning is None where too few
        reversals are seen.
    """
    command, x, time = recording.get("command"), recording.get("opening"), recording.time
    if command is None or x is None:
        return None
    steps = np.flatnonzero(np.abs(np.diff(command)) > 1e-6) + 1
    many = max(round(_ANSWERS_WITHIN / recording.sample_time), 1)
    ends = np.append(steps, len(x) - 1)[1:]
    seen: dict[bool, list[tuple[float, bool]]] = {False: [], True: []}
    last = 0.0
    for k, end in zip(steps.tolist(), ends.tolist(), strict=True):
        before, until = max(k - 1, 0), min(end, k + many)
        error, moved = command[k] - x[k], x[until] - x[k]
        resting = abs(x[k] - x[before]) < _STILL
        if not np.isfinite(error + moved) or not resting or time[until] - time[k] < 0.5 * _ANSWERS_WITHIN:
            last = np.sign(moved) if abs(moved) > 10.0 * _STILL else last
            continue
        started = abs(moved) > max(2.0 * _STILL, 0.2 * abs(error)) and moved * error > 0.0
        if last != 0.0:
            seen[bool(error * last < 0.0)].append((abs(error), started))
        last = np.sign(moved) if started else last
    limits = [_limit(seen[False]), _limit(seen[True])]
    if limits[0] is None:
        return None
    return limits[0], limits[1]


def _limit(events: list[tuple[float, bool]]) -> tuple[float, float] | None:
    """Errors left alone and answered beside the threshold; None where one kind is missing."""
    if len(events) < _FEWEST:
        return None
    size, started = map(np.asarray, zip(*sorted(events), strict=True))
    if started.all() or not started.any():
        return None
    # answered below a cut, or left alone above it
    wrong = np.append(0, np.cumsum(started)) + np.append(np.cumsum(~started[::-1])[::-1], 0)
    cut = int(np.argmin(wrong))
    if cut in (0, len(size)):
        return None
    return float(size[cut - 1]), float(size[cut])
