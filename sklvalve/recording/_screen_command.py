# SPDX-License-Identifier: BSD-3-Clause
"""A command that rests in the record while the stem goes on stroking: its channel stood still."""

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_tools import Finding, equal_runs, finding
from sklvalve.recording.noise import noise_floor
from sklvalve.recording.recording import Recording
from sklvalve.recording.runs import runs

_LEAST_ROWS, _SETTLED = 100, 40  # rows; within the latter a stem has come to where it was sent
_LEAST_MOVE, _LEAST_MOVES = 0.015, 3
_QUICK = 15  # rows within which a stroke moves so far, and a drift does not
_BESIDE = 4.0  # times as much as the stem strays elsewhere: a stem that hunts does so at every command


def screen_command(recording: Recording) -> list[Finding]:
    """Stretches in which the command holds one value and the opening moves several times, far from it.

    A stem that drifts moves slowly, one whose air fails goes away and comes back, and one that hunts leaves
    its command elsewhere too. The first rows of a rest are left out: the stem may still be on its way.
    """
    if not {"command", "opening"} <= set(recording.signals) or "command" in recording.constants:
        return []
    command, opening = recording["command"], recording["opening"]
    rests = [span for span in equal_runs(command) if span[1] - span[0] >= _LEAST_ROWS]
    if not rests or not np.ptp(command[np.isfinite(command)]) > 0.0:
        return []
    noise = noise_floor(opening)
    least = max(_LEAST_MOVE, 8.0 * noise if np.isfinite(noise) else 0.0)
    strays = [_strays(opening[start + _SETTLED : stop]) for start, stop in rests]
    frozen = [
        span
        for span, far in zip(rests, strays, strict=True)
        if far > 2.0 * least and _moves(opening[span[0] + _SETTLED : span[1]], least) >= _LEAST_MOVES
    ]
    others = [far for span, far in zip(rests, strays, strict=True) if span not in frozen]
    usual = max([_usual(command, opening, frozen), *others])
    frozen = [span for span in frozen if strays[rests.index(span)] > _BESIDE * usual]
    if not frozen or sum(stop - start for start, stop in frozen) > 0.5 * len(command):
        return []
    longest = max(stop - start for start, stop in frozen) * recording.sample_time
    detail = (
        f"holds one value for up to {longest:g} s while the opening goes on moving: it was not recorded there"
    )
    return [finding("frozen", "command", detail, frozen)]


def _strays(opening: NDArray[np.float64]) -> float:
    """Breadth of an opening's course, its outliers left out."""
    known = opening[np.isfinite(opening)]
    return float(np.ptp(np.quantile(known, [0.02, 0.98]))) if len(known) else 0.0


def _usual(
    command: NDArray[np.float64], opening: NDArray[np.float64], frozen: list[tuple[int, int]]
) -> float:
    """How far the opening is from the command elsewhere."""
    apart = np.abs(opening - command)
    for start, stop in frozen:
        apart[start:stop] = np.nan
    known = apart[np.isfinite(apart)]
    return float(np.quantile(np.abs(known - np.median(known)), 0.9)) if len(known) else np.inf


def _moves(opening: NDArray[np.float64], least: float) -> int:
    """Quick moves of at least such a size; those that touch each other, as there and back, count once."""
    known = opening[np.isfinite(opening)]
    if len(known) < 2 * _QUICK:
        return 0
    steady = np.median(np.lib.stride_tricks.sliding_window_view(known, 5), axis=1)
    return len(runs(np.abs(steady[_QUICK:] - steady[:-_QUICK]) >= least))
