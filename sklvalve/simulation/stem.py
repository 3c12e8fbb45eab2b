# SPDX-License-Identifier: BSD-3-Clause
"""Stem of a pneumatic actuator behind its positioner: one scan along time, compiled, with its derivatives."""

import numba as nb
import numpy as np

from sklvalve.simulation.dual import dual, kept
from sklvalve.simulation.stem_state import actuator, at_rest, compiled, faulty, sound
from sklvalve.simulation.stem_step import after_a_sample

#: So many slopes one scan may carry along: those of one register of a wide processor, or of two.
NARROW, WIDE = 8, 16


# no check for division by zero: no divisor can be zero
_scan = nb.njit(cache=True, nogil=True, error_model="numpy")


@_scan
def positioner_and_actuator(
    command, step, x0, spring, atmosphere, supply, coulomb, extra_stick, dead_band, faults, filter_time, gain,
    reset, rate, feedback, vent, lag=0.0,
):  # fmt: skip
    r"""Stem of a spring-loaded diaphragm actuator behind a positioner, driven by the command.

    All in travels: a pressure of one carries the spring over one travel. The positioner opens a spool by the
    error, by its integral (`reset`), and, by `feedback`, by how far the pressure is from the one that carries
    the spring to the command: so it holds a stuck stem with a pressure in proportion to the error; without,
    pressure builds up until the stem comes loose. The spool fills the chamber or vents it, by nozzles that
    choke; the stem moves where pressure, spring and bristle friction with a Stribeck fall balance.

    .. math::

        \dot m = c\, s\, p_s \psi(p / p_s) \;\text{or}\; c\, s\, p\, \psi(p_a / p), \quad m = p (V_0 + x)

        p - p_0 - x = \sigma z + b \dot x, \quad \dot z = \dot x - |\dot x| \sigma z / F(\dot x)

    What the positioner feels of the stem passes a lag, :math:`\tau \dot x' = x - x'`: relays and converters
    take their time, so a quick stem goes beyond where it is sent, and one that rubs stays there.

    Parameters
    ----------
    command : ndarray of shape (n,)
        Wanted opening [1]. A gap (NaN) holds the value before it.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    x0 : float
        Opening at the beginning [1].
    spring, atmosphere : float
        Absolute pressure at which the spring begins to give way, and that of the air [travels of spring].
    supply, coulomb, extra_stick, dead_band : ndarray of shape (n,)
        Absolute supply pressure; sliding friction; how far friction at rest exceeds it [all in travels of
        spring]; half width of the positioner's dead band [1].
    faults : ndarray of shape (n, 10), or (0, 10) in a sound actuator
        Columns as `sklvalve.simulation.faults.FAULTS` has them.
    filter_time, gain, reset, rate, feedback, vent, lag : float
        Time constant of the input [s], spool opening for an error [1], spool for the error's integral [1/s],
        capacity of the spool that fills [1/s], the error that a pressure of one counts for [1], the capacity
        of the spool that vents, as a multiple of `rate` [1], and the time constant of the lag [s].

    Returns
    -------
    opening : ndarray of shape (n,)
        Position of the stem [1].

    Notes
    -----
    One equation a step for how far the stem goes, implicit in pressure and error, weighted between trapezoid
    (short steps) and backward Euler (long ones), so that a fast positioner settles and does not ring. Steps
    are as long as the pressure's rate allows; their length follows the state without jumps, so the opening
    is smooth in every parameter. Where a stem hunts it is not, for hunting is chaotic.
    """
    out = np.empty(len(command))
    own = actuator(spring, atmosphere, filter_time, gain, reset, feedback, vent, lag)
    x = min(max(x0, 0.0), 1.0)
    target = command[0] if command[0] == command[0] else x
    state, pace = at_rest(x, target, own)
    for k in range(len(command)):
        if command[k] == command[k]:
            target = command[k]
        told = supply[k], coulomb[k], extra_stick[k], dead_band[k]
        if len(faults) == 0:
            drive = sound(told, spring, rate)
        else:
            f = faults[k]
            drive = faulty(told, (f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9]), spring, rate)
        state, pace = after_a_sample(state, pace, target, step[k], drive, own)
        out[k] = state.x
    return out


@_scan
def stem_with_slopes(
    command, step, x0, spring, atmosphere, supply, coulomb, extra_stick, dead_band, faults, numbers,
    row_slopes, number_slopes, like,
):  # fmt: skip
    """What `positioner_and_actuator` gives, with its derivatives by several parameters at once.

    Parameters
    ----------
    command, step, x0, spring, atmosphere, supply, coulomb, extra_stick, dead_band
        As there.
    faults : ndarray of shape (n, 10) or (1, 10)
        As there; zeros in a sound actuator, and one row where nothing changes with time.
    numbers : ndarray of shape (7,)
        `filter_time`, `gain`, `reset`, `rate`, `feedback`, `vent` and `lag`.
    row_slopes : tuple of 15 ndarrays of shape (n, p) or (1, p)
        Derivatives of `command`, `supply`, `coulomb`, `extra_stick`, `dead_band` and of the ten faults.
    number_slopes : ndarray of shape (7, p)
    like : tuple of p numbers
        Of `NARROW` or `WIDE` length; so the compiler knows p.

    Returns
    -------
    opening : ndarray of shape (n,)
        Position of the stem [1].
    slopes : ndarray of shape (n, p)
        Its derivatives. Where two ways of the code part, they are those of the one that was taken.
    """
    n, still = len(command), np.zeros((1, len(like)))
    out, slopes = np.empty(n), np.empty((n, len(like)))
    filter_time, gain = _number(numbers, number_slopes, 0, like), _number(numbers, number_slopes, 1, like)
    reset, rate = _number(numbers, number_slopes, 2, like), _number(numbers, number_slopes, 3, like)
    feedback, vent = _number(numbers, number_slopes, 4, like), _number(numbers, number_slopes, 5, like)
    lag = _number(numbers, number_slopes, 6, like)
    own = actuator(spring, atmosphere, filter_time, gain, reset, feedback, vent, lag)
    x = dual(min(max(x0, 0.0), 1.0), still, 0, like)
    target = _number(command, row_slopes[0], 0, like) if command[0] == command[0] else x
    state, pace = at_rest(x, target, own)
    for k in range(n):
        if command[k] == command[k]:
            target = _number(command, row_slopes[0], k, like)
        told = (
            _number(supply, row_slopes[1], k, like),
            _number(coulomb, row_slopes[2], k, like),
            _number(extra_stick, row_slopes[3], k, like),
            _number(dead_band, row_slopes[4], k, like),
        )
        wrong = (
            _number(faults[:, 0], row_slopes[5], k, like),
            _number(faults[:, 1], row_slopes[6], k, like),
            _number(faults[:, 2], row_slopes[7], k, like),
            _number(faults[:, 3], row_slopes[8], k, like),
            _number(faults[:, 4], row_slopes[9], k, like),
            _number(faults[:, 5], row_slopes[10], k, like),
            _number(faults[:, 6], row_slopes[11], k, like),
            _number(faults[:, 7], row_slopes[12], k, like),
            _number(faults[:, 8], row_slopes[13], k, like),
            _number(faults[:, 9], row_slopes[14], k, like),
        )
        drive = faulty(told, wrong, spring, rate)
        state, pace = after_a_sample(state, pace, target, step[k], drive, own)
        out[k] = kept(state.x, slopes, k)
    return out, slopes


@compiled
def _number(values, slopes, k, like):
    """Dual number from a row of values and one of slopes, or from the only row where all are alike."""
    return dual(values[min(k, len(values) - 1)], slopes, min(k, len(slopes) - 1), like)
