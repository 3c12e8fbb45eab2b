# SPDX-License-Identifier: BSD-3-Clause
"""A stem that moves to and fro while its command rests, found window by window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.signals.stick_slip import sensor_noise

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# a window, whose straight line is taken off, so that a slow approach is no movement to and fro
_WINDOW = 20
# the command rests that moves by less than this within a window and the one before it [1]
_QUIET = 0.02
# the stem hunts that deviates by more than this [1], by so many times the sensor's noise, and its command by
# less than this share of it
_LEAST, _NOISES, _OF_COMMAND = 0.005, 2.5, 0.3
# windows of a resting stem that tell the noise: so many of those in which the sensor is free to show it
_RESTING = 0.05
# so many windows, and this share of those in which the command rests
_EVIDENT, _OFTEN = 10, 0.05


@dataclass(frozen=True)
class Hunting:
    """Windows in which a stem hunts.

    Attributes
    ----------
    rows : ndarray of shape (k,), int
        First row of each window.
    sizes : ndarray of shape (k,)
        Standard deviation of the opening within each window [1].
    quiet : int
        Windows in which the command rests.
    evident : bool
        Whether they are too many for chance.
    """

    rows: np.ndarray
    sizes: np.ndarray
    quiet: int = 0
    length: int = _WINDOW

    @property
    def evident(self) -> bool:
        return len(self.rows) >= max(_EVIDENT, _OFTEN * self.quiet)


def find_hunting(command: ArrayLike, opening: ArrayLike) -> Hunting:
    r"""Windows in which the stem moves to and fro while its command rests.

    .. math:: s_x > \max(0.005, 2.5\, \sigma), \quad s_u < 0.3\, s_x

    with s the standard deviations of opening and command about their straight lines in a window of 20 rows.
    In a window the command, and in the one before it, moves by less than 2 % of travel. The noise
    :math:`\sigma` is the lesser of what the bends of the whole series say of it and of s in the quietest
    twentieth of the windows, without those that hold one value or are cut off at the end of the range; a
    sensor that turns noisy for a while is taken for a stem that hunts. A positioner that works against
    friction at rest or play makes such a cycle; so does one that is tuned too sharply, which is no effect of
    the catalogue.

    Parameters
    ----------
    command, opening : array-like of shape (n,)
        Wanted and recorded opening [1]; windows with a gap (NaN) are left out.

    Returns
    -------
    hunting : Hunting

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.mismatch.signals.hunting import find_hunting
    >>> command = np.full(400, 0.5)
    >>> find_hunting(command, 0.5 + 0.02 * np.sin(np.arange(400) / 2)).evident
    True
    >>> find_hunting(command, command).evident
    False
    """
    u, x = (_windows(np.asarray(series, dtype=float)) for series in (command, opening))
    if not len(x):
        return Hunting(np.zeros(0, dtype=int), np.zeros(0))
    moved = np.ptp(u, axis=1)
    quiet = (moved < _QUIET) & (np.r_[0.0, moved[:-1]] < _QUIET)
    of_stem, of_command = _about_their_line(x), _about_their_line(u)
    resting = quiet & np.isfinite(of_stem)
    telling = resting & _shows_noise(x)
    if not telling.any():
        return Hunting(np.zeros(0, dtype=int), np.zeros(0))
    noise = min(sensor_noise(x.ravel()), float(np.quantile(of_stem[telling], _RESTING)))
    # comparisons with NaN are false
    hunts = quiet & (of_stem > max(_LEAST, _NOISES * noise)) & (of_command < _OF_COMMAND * of_stem)
    return Hunting(np.flatnonzero(hunts) * _WINDOW, of_stem[hunts], int(resting.sum()))


def _shows_noise(windows: np.ndarray) -> np.ndarray:
    """Windows that neither hold one value nor are cut off at the lowest or highest reading of the series."""
    ends = (np.nanmin(windows), np.nanmax(windows)) if np.isfinite(windows).any() else ()
    at_an_end = np.isin(windows, ends).sum(axis=1) > 1
    return (np.ptp(windows, axis=1) > 0.0) & ~at_an_end


def _windows(series: np.ndarray) -> np.ndarray:
    many = len(series) // _WINDOW
    return series[: many * _WINDOW].reshape(many, _WINDOW)


def _about_their_line(windows: np.ndarray) -> np.ndarray:
    """Standard deviation of each window about its own straight line."""
    t = np.arange(_WINDOW) - 0.5 * (_WINDOW - 1)
    centred = windows - windows.mean(axis=1, keepdims=True)
    return (centred - np.outer(centred @ t / (t @ t), t)).std(axis=1)
