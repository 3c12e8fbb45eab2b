# SPDX-License-Identifier: BSD-3-Clause
"""Stem of a pneumatic actuator behind its positioner: one scan along time, compiled."""

import numba as nb
import numpy as np

from sklvalve.simulation.stem_state import actuator, at_rest, faulty, sound
from sklvalve.simulation.stem_step import after_a_sample


# no check for division by zero: no divisor can be zero
@nb.njit(cache=True, nogil=True, error_model="numpy")
def positioner_and_actuator(
    command, step, x0, spring, atmosphere, supply, coulomb, extra_stick, dead_band, faults, filter_time, gain,
    reset, rate, feedback, vent, lag=0.0,
):  # fmt: skip
    r"""Stem of a spring-loaded diaphragm actuator behind a positioner, driven by the command.

    All in travels: a pressure of one carries the spring over one travel. The positioner opens a spool by the
    error, by its integral (`reset`), and, by `feedback`, by how far the pressure is from the one that carries
    the spring to the command: so it holds a stuck stem with a pressure in proportion to the error; without,
    pressure builds up until the stem comes loose. The spool fills the chamber or vents it, by nozzles that
    choke, and a supply that has fallen below the chamber takes air back; the stem moves where pressure,
    spring and bristle friction with a Stribeck fall balance.

    .. math::

        \dot m = c\, s\, p_s \psi(p / p_s) \;\text{or}\; c\, s\, p\, \psi(p_a / p), \quad m = p (V_0 + x)

        \dot m = -c\, s\, p\, \psi(p_s / p) \;\text{where the spool fills and}\; p > p_s

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
    faults : ndarray of shape (n, 12), or (0, 12) in a sound actuator
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
            own_faults = f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9], f[10], f[11]
            drive = faulty(told, own_faults, spring, rate)
        state, pace = after_a_sample(state, pace, target, step[k], drive, own)
        out[k] = state.x
    return out
