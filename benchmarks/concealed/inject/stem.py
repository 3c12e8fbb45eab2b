# SPDX-License-Identifier: BSD-3-Clause
"""From command to stem to plug, row by row: the mechanics that is put into real recordings.

Every argument but the first is an array of a value a row, so that an effect that begins at a moment is a
parameter that changes there. Openings and commands are fractions, 0 = shut; times are rows.
"""

import numba as nb
import numpy as np


def delayed(signal, rows):
    """A signal as it was `rows` rows before, between rows on the straight line."""
    at = np.arange(len(signal)) - rows
    return np.interp(at, np.arange(len(signal)), signal)


@nb.njit(cache=True)
def lagged(signal, time_constant, start):
    """First order response, exact for a signal held over each row."""
    out = np.empty(len(signal))
    state = start
    for k in range(len(signal)):
        if time_constant[k] <= 0.0:
            state = signal[k]
        else:
            state += (1.0 - np.exp(-1.0 / time_constant[k])) * (signal[k] - state)
        out[k] = state
    return out


@nb.njit(cache=True)
def play(signal, width, start):
    """Play: the driven side stays within half a width of the driving side."""
    out = np.empty(len(signal))
    state = start
    for k in range(len(signal)):
        half = 0.5 * width[k]
        state = min(max(state, signal[k] - half), signal[k] + half)
        out[k] = state
    return out


@nb.njit(cache=True)
def stick_slip(signal, stick, jump, start):
    """Two-parameter law of a sticking stem after Kano and others (2004).

    The stem rests wherever the signal turns or stops. It leaves the rest once the signal has gone `jump` on
    in the old direction, or `stick` in the other, and then trails the signal by half of (stick - jump).
    """
    out = np.empty(len(signal))
    state = start
    rest = signal[0]
    way = 0.0
    resting = True
    for k in range(len(signal)):
        if stick[k] <= 0.0:
            state = signal[k]
            rest = signal[k]
            out[k] = state
            continue
        step = signal[k] - signal[k - 1] if k > 0 else 0.0
        if not resting and step * way <= 0.0:
            resting = True
            rest = signal[k - 1]
        if resting:
            gone = signal[k] - rest
            needed = jump[k] if gone * way > 0.0 else stick[k]
            if way == 0.0:
                needed = 0.5 * (stick[k] + jump[k])
            if abs(gone) > needed:
                way = 1.0 if gone > 0.0 else -1.0
                resting = False
        if not resting:
            state = signal[k] - 0.5 * way * (stick[k] - jump[k])
        out[k] = state
    return out


@nb.njit(cache=True)
def slewed(signal, opening_speed, closing_speed, start):
    """A stem that follows no faster than its speed, of its own in each direction [1/row]."""
    out = np.empty(len(signal))
    state = start
    for k in range(len(signal)):
        state += min(max(signal[k] - state, -closing_speed[k]), opening_speed[k])
        out[k] = state
    return out


def stem(command, now):
    """Stem behind delay, lag, dead band, friction and speed, in this order.

    Parameters
    ----------
    command : ndarray of shape (n_rows,)
    now : dict of ndarrays of shape (n_rows,)
        `delay` and `lag` [rows], `dead_band` (half width), `stick`, `jump`, `opening_speed`,
        `closing_speed` [1/row], `linkage_play` (width). A missing one does nothing.

    Returns
    -------
    opening : ndarray of shape (n_rows,)
        Where the stem is, as a sound sensor on it would read.
    """
    nothing = np.zeros(len(command))
    at = delayed(command, now.get("delay", nothing))
    at = lagged(at, now.get("lag", nothing), at[0])
    # a positioner that moves no air while the error is inside its band stops at the band's edge
    at = play(at, 2.0 * now.get("dead_band", nothing), at[0])
    at = stick_slip(at, now.get("stick", nothing), now.get("jump", nothing), at[0])
    fast = np.full(len(command), np.inf)
    at = slewed(at, now.get("opening_speed", fast), now.get("closing_speed", fast), at[0])
    return play(at, now.get("linkage_play", nothing), at[0])
