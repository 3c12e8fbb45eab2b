# SPDX-License-Identifier: BSD-3-Clause
"""What a drive shows of itself: how often its position is read, how late it starts, at which speed it runs.

A stem that waits a constant time after every change of its command, and then runs at a constant speed, is
late and slow, and sticks nowhere: friction asks how large the error is, not how long ago the command changed,
and lets the stem go faster than any motor runs.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

# a position that is read anew every so many rows changes in these rows only; slips keep no such time
_LONGEST_HOLD, _REGULAR = 50, 0.95
# steps of the command, after so many rows of rest, are answered within so many rows
_STEP, _QUIET, _LONGEST = 0.01, 10, 600
# so many answers, and this share of them as late as the middle one within this share of it, or two rows
_FEWEST, _MOST, _ALIKE = 5, 0.8, 0.2
# a delay explains what brings a stem this near its command, of how far off it is without
_FOLLOWS, _AS_WELL = 1.0 / 3.0, 0.1
# a run goes on for so many rows; this share of the rows within runs are of one speed within this share of it
_RUN, _OF_RUNS, _ONE_SPEED = 4, 0.7, 0.15


def rows_between_readings(position: np.ndarray) -> int:
    """Rows after which a held position is read anew; 1 where it is read in every row.

    Parameters
    ----------
    position : ndarray of shape (n,)

    Returns
    -------
    rows : int
    """
    changes = np.flatnonzero(np.diff(position) != 0.0)
    gaps = np.diff(changes)
    gaps = gaps[gaps <= _LONGEST_HOLD]
    if len(gaps) < 20:
        return 1
    held = int(np.median(gaps))
    if held < 2:
        return 1
    in_time = np.bincount(changes % held).max() / len(changes)
    return held if in_time >= _REGULAR else 1


def rows_late(command: np.ndarray, position: np.ndarray, noise: float) -> int:
    """Rows between a step of the command and the first movement, where they are the same for every step.

    Parameters
    ----------
    command, position : ndarray of shape (n,)
        Wanted and recorded opening [1].
    noise : float
        Of the position [1].

    Returns
    -------
    rows : int
        0 where small steps are answered later than large ones, or never. Where few steps follow a rest it is
        the delay at which the stem follows its command, if by that it is a third as far off as without.
    """
    steps = np.flatnonzero(np.abs(np.diff(command)) > _STEP)
    late = []
    for k in steps:
        before = slice(max(k - _QUIET, 0), k + 1)
        least = max(4.0 * noise, 1e-4)
        if k < _QUIET or np.ptp(command[before]) > 0.1 * _STEP or not np.ptp(position[before]) <= 2.0 * least:
            continue
        moved = np.abs(position[k + 1 : k + 1 + _LONGEST] - position[k]) > least
        late.append(int(np.argmax(moved)) + 1 if moved.any() else _LONGEST)
    if len(late) < _FEWEST:
        return _rows_behind(command, position)
    middle = float(np.median(late))
    alike = np.abs(np.array(late) - middle) <= max(_ALIKE * middle, 2.0)
    return int(np.ceil(middle + max(_ALIKE * middle, 2.0))) if np.mean(alike) >= _MOST else 0


def _rows_behind(command: np.ndarray, position: np.ndarray) -> int:
    """Delay by which a stem follows a command that moves all the time; 0 where none makes a difference."""
    longest = min(_LONGEST, len(position) // 4)
    if longest < 1:
        return 0
    seen = position[longest:]
    delays = np.arange(0, longest + 1, max(longest // 100, 1))
    off = [np.nanmedian(np.abs(seen - command[longest - d : len(command) - d])) for d in delays]
    # a command that comes back is followed as well a period later: the first such delay is it
    best = int(np.argmax(np.array(off) <= min(off) + _AS_WELL * off[0]))
    return int(delays[best]) if off[best] <= _FOLLOWS * off[0] else 0


def way_in_a_row(position: np.ndarray, noise: float) -> float:
    """How far a stem gets in one row whenever it runs, where that is one speed; 0 where it is none.

    Parameters
    ----------
    position : ndarray of shape (n,)
        Recorded opening [1].
    noise : float
        Of it [1].

    Returns
    -------
    way : float
        [1].
    """
    moves = np.diff(position)
    running = np.abs(moves) > max(4.0 * noise, 1e-4)
    inside = []
    for begin, end in _runs(np.where(running, np.sign(moves), 0.0)):
        if end - begin >= _RUN:
            # it starts and stops within its first and its last row
            inside.append(np.abs(moves[begin + 1 : end - 1]))
    if len(inside) < _FEWEST:
        return 0.0
    ways = np.concatenate(inside)
    usual = float(np.median(ways))
    return usual if np.mean(np.abs(ways - usual) <= _ONE_SPEED * usual + 2.0 * noise) >= _OF_RUNS else 0.0


def _runs(signs: np.ndarray) -> list[tuple[int, int]]:
    """First row and end of each stretch of one sign other than nought."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0.0], signs, [0.0]])) != 0.0)
    return [(a, b) for a, b in pairwise(edges.tolist()) if signs[a] != 0.0]
