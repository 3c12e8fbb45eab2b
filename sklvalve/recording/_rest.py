# SPDX-License-Identifier: BSD-3-Clause
"""A signal that holds one value because what drives it rests: no frozen sensor."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from sklvalve.recording._screen_tools import recorded
from sklvalve.recording.recording import Recording

# role -> what drives it, the nearest first
_DRIVEN_BY = {"opening": ("command",), "flow": ("opening", "command")}
# a drive that moves by no more may stay within an ordinary dead band [1 = travel]
_BAND = 0.02
# a window in which the drive rests; and of those in which it does, so many that jitter show a noisy sensor
_WINDOW, _FEWEST = 20, 3
# a signal that goes to and fro makes this many times the way that it gets on, one that approaches once
_TO_AND_FRO = 2.0


def rests(recording: Recording, role: str, start: int, stop: int) -> bool:
    """Whether rows in which a signal holds one value are a rest of what drives it, and not of its sensor.

    They are where the drive moved by less than a dead band meanwhile, and the signal is as quiet elsewhere
    while its drive rests: the encoder of a motor that stands holds one value exactly. A sensor that jitters
    in other rests, and does not in this one, is frozen all the same.

    Parameters
    ----------
    recording : Recording
    role : str
    start, stop : int
        The rows in which the signal holds one value.

    Returns
    -------
    rests : bool
        False where nothing that drives the signal is recorded.
    """
    drive = next((recording[r] for r in _DRIVEN_BY.get(role, ()) if r in recording), None)
    if drive is None:
        return False
    inside = drive[max(start - 1, 0) : stop]
    if not np.isfinite(inside).any():
        return False
    moved = float(np.nanmax(inside) - np.nanmin(inside))
    return moved <= _BAND and not _jitters_at_rest(recorded(recording, role), drive, moved)


def _jitters_at_rest(values: NDArray[np.float64], drive: NDArray[np.float64], moved: float) -> bool:
    """Whether a signal goes to and fro where its drive moves no more than `moved`."""
    if len(values) < _WINDOW:
        return False
    still = np.ptp(sliding_window_view(drive, _WINDOW), axis=1)[::_WINDOW] <= max(moved, 1e-9)
    windows = sliding_window_view(values, _WINDOW)[::_WINDOW][still]
    steps = np.diff(windows, axis=1)
    way, ahead = np.abs(steps).sum(axis=1), np.abs(windows[:, -1] - windows[:, 0])
    # a reading that changes in most rows, and comes back; comparisons with gaps are false
    jitters = ((steps == 0.0).mean(axis=1) <= 0.5) & (way > _TO_AND_FRO * ahead)
    return int(jitters.sum()) >= _FEWEST
