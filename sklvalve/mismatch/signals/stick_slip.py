# SPDX-License-Identifier: BSD-3-Clause
"""Slips of a sticking stem, found as events: what a free run that has lost their times cannot show."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sklvalve.mismatch.signals.drive_marks import rows_between_readings, rows_late, way_in_a_row

# a slip moves the stem by this much of its travel in one step, or by this many times the sensor's noise
_LEAST, _NOISES = 0.01, 8.0
# rows before a slip whose commands it must leave behind, and rows after it that it may anticipate
_BEHIND, _AHEAD = 30, 2
# a slip passes every one of those commands by this share of itself, while the command moves by less than that
_PAST, _COMMANDED = 0.25, 0.6
# a stem rests that moves, in two of the three rows before a slip, by no more than this share of it: one that
# hunts, or that follows its command, is on its way before
_RESTING, _BEFORE = 0.1, 3
# a slip is so many times as fast as a motor that runs at one speed
_FASTER = 1.2
# the rest that a recording begins from is unknown
_BEGINNING = 5
# what other effects and a positioner's own overshoot show by chance stays below this count
_EVIDENT = 6


@dataclass(frozen=True)
class Slips:
    """Slips found in one recording.

    Attributes
    ----------
    rows : ndarray of shape (k,), int
        Last row before each slip.
    sizes : ndarray of shape (k,)
        Movement of the stem, opening positive [1].
    past : ndarray of shape (k,)
        How far it landed beyond every command near it [1].
    evident : bool
        Whether they are too many for anything but a sticking stem, and go both ways.
    """

    rows: np.ndarray
    sizes: np.ndarray
    past: np.ndarray

    @property
    def evident(self) -> bool:
        return len(self.rows) >= _EVIDENT and bool(self.sizes.min() < 0.0 < self.sizes.max())


def find_slips(command: ArrayLike, opening: ArrayLike) -> Slips:
    r"""Slips: the stem rests, jumps within a step, and lands where no command has called it.

    A positioner that acts on the error has no reason to carry a stem past its command; friction at rest
    lets the pressure under the diaphragm build up until it breaks away, and the stored force carries it by

    .. math:: J \approx \frac{F_s - F_c}{k + \gamma A p / h_0}

    whatever the error was. A step counts where it exceeds 1 % of travel and eight times the sensor's noise,
    begins from rest, leaves every command from 30 rows before to 2 rows after behind by a quarter of itself,
    is not undone in the next row (a spike of the sensor is), and the command moved by less than 0.6 of it
    meanwhile. Where every step of the command is answered after one and the same time, as behind a dead time,
    the 30 rows begin that much earlier; where the stem runs at one speed, as a motor does, a step must exceed
    that by a fifth; and a position that is read every few rows is looked at in those rows only. One that the
    sensor shows wrong by more than that quarter would feign slips.

    Parameters
    ----------
    command, opening : array-like of shape (n,)
        Wanted and recorded opening [1]; gaps (NaN) hide the slips beside them.

    Returns
    -------
    slips : Slips

    Raises
    ------
    ValueError
        If the two differ in length.

    Notes
    -----
    Friction: Olsson, Astrom, Canudas de Wit, Gafvert, Lischinsky, European Journal of Control 4 (1998) 176.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.mismatch.signals.stick_slip import find_slips
    >>> command = 0.5 + 0.02 * np.sin(np.arange(400) / 8)
    >>> opening = np.where(np.sin(np.arange(400) / 8 - 1.2) > 0, 0.55, 0.45)
    >>> find_slips(command, opening).evident
    True
    >>> find_slips(command, command).evident
    False
    """
    u, x = np.asarray(command, dtype=float), np.asarray(opening, dtype=float)
    if u.shape != x.shape or u.ndim != 1:
        raise ValueError(
            f"command and opening must be two series of one length; got shapes {u.shape} and {x.shape}."
        )
    held = rows_between_readings(x)
    if held > 1:
        # between two readings a position that was held seems to rest, and jumps at the next one
        first = int(np.bincount(np.flatnonzero(np.diff(x) != 0.0) % held).argmax() + 1) % held
        slips = find_slips(u[first::held], x[first::held])
        return replace(slips, rows=slips.rows * held + first)
    if len(x) < _BEGINNING + 3:
        return Slips(np.zeros(0, dtype=int), np.zeros(0), np.zeros(0))
    noise = sensor_noise(x)
    # what a motor makes in a row at the one speed it runs at is no slip
    least = max(_LEAST, _NOISES * noise, _FASTER * way_in_a_row(x, noise))
    behind = _BEHIND + rows_late(u, x, noise)
    jump = np.diff(x)
    jumps = []
    with np.errstate(invalid="ignore"):
        candidates = np.flatnonzero(np.abs(jump) > least)
    for k in candidates[(candidates >= _BEGINNING) & (candidates < len(x) - 2)]:
        size, sign = abs(jump[k]), np.sign(jump[k])
        around = u[max(k - behind, 0) : k + 2 + _AHEAD]
        near = u[max(k - 3, 0) : k + 2 + _AHEAD]
        past = x[k + 1] - around.max() if sign > 0 else around.min() - x[k + 1]
        stays = sign * (x[k + 2] - x[k]) > 0.5 * size
        resting = np.sum(np.abs(jump[k - _BEFORE : k]) < max(_RESTING * size, 4.0 * noise)) >= 2
        # comparisons with NaN are false: a gap nearby leaves the step out
        if resting and stays and past > max(_PAST * size, 4.0 * noise) and np.ptp(near) < _COMMANDED * size:
            jumps.append((k, jump[k], past))
    rows, sizes, beyond = np.array(jumps, dtype=float).reshape(-1, 3).T
    return Slips(rows.astype(int), sizes, beyond)


def sensor_noise(x: np.ndarray) -> float:
    """White noise of a sensor, by how its series bends from row to row."""
    bends = np.diff(x, 2)
    bends = bends[np.isfinite(bends)]
    if not len(bends):
        return 0.0
    # white noise of one makes second differences of the root of six
    return 1.4826 * float(np.median(np.abs(bends - np.median(bends)))) / 6.0**0.5
