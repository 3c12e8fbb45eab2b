# SPDX-License-Identifier: BSD-3-Clause
"""What a run of the stem goes by: the actuator, what acts in one row, and what changes from step to step.

All in travels: a pressure of one carries the spring over one travel.
"""

from typing import NamedTuple

import numba as nb

DEAD_VOLUME = 5.0
_BRISTLE, _LEAST_FRICTION = 60.0, 1e-4

# no check for division by zero in the innermost loop: no divisor there can be zero
compiled = nb.njit(error_model="numpy", fastmath={"contract", "arcp", "nsz"}, forceinline=True)


class Actuator(NamedTuple):
    """What stays as it is along a run; as in `sklvalve.simulation.stem.positioner_and_actuator`."""

    spring: float
    atmosphere: float
    per_filter_time: float
    gain: float
    reset: float
    feedback: float
    vent: float
    lag: float
    per_lag: float


class Drive(NamedTuple):
    """What acts in one row; forces in travels of the spring, `play` a half, `capacity` [1/s], two stops."""

    supply: float
    slide: float
    stick: float
    band: float
    preload: float
    softening: float
    hardening: float
    leak: float
    rod: float
    rod_from: float
    play: float
    bristle: float
    capacity: float
    low: float
    high: float


class State(NamedTuple):
    """Stem, air and positioner at one moment.

    Opening `x`, mass of air in the chamber, bend of the friction's bristles, speed of the stem, place of the
    positioner's lever, what it feels of that behind its lag, its filtered input, and its integral.
    """

    x: float
    mass: float
    bend: float
    speed: float
    lever: float
    felt: float
    wanted: float
    integral: float


class Pace(NamedTuple):
    """What hangs on a step's length alone, kept for the next one of that length.

    Of the input's way to its filter the share covered in the step; twice the weight that the filter's
    beginning has in the step's mean; viscous drag; of the lag's way the share covered; and what is felt at
    the step's end of a way made in it.
    """

    length: float
    eased: float
    old: float
    drag: float
    caught: float
    followed: float


@compiled
def sound(told, spring, rate):
    """Drive of a sound actuator from its supply, sliding friction, extra friction at rest and dead band."""
    supply, slide, stick, band = told
    slide = max(slide, _LEAST_FRICTION)
    return Drive(supply, slide, stick, band, spring, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, _BRISTLE, rate, 0.0, 1.0)


@compiled
def faulty(told, faults, spring, rate):
    """Drive of an actuator with `faults`, twelve numbers as `sklvalve.simulation.faults.FAULTS` has them."""
    supply, slide, stick, band = told
    preload, softening, hardening, leak, rod, rod_from, load, play, bristle, capacity, low, high = faults
    return Drive(
        supply,
        max(slide, _LEAST_FRICTION),
        stick,
        band,
        spring + preload + load,
        softening,
        hardening,
        leak,
        rod,
        rod_from,
        0.5 * play,
        bristle if bristle > 0.0 else _BRISTLE,
        rate * (1.0 + capacity),
        low,
        1.0 - high,
    )


@compiled
def actuator(spring, atmosphere, filter_time, gain, reset, feedback, vent, lag):
    """Numbers of a run, the times as their inverses too."""
    per_filter_time, per_lag = 1.0 / max(filter_time, 1e-6), 1.0 / max(lag, 1e-6)
    return Actuator(spring, atmosphere, per_filter_time, gain, reset, feedback, vent, lag, per_lag)


@compiled
def at_rest(opening, wanted, own):
    """State of a stem that has stood at an opening, and the pace of no step yet."""
    # a stem that stands at its end of travel may be pressed against it by any pressure
    mass = (opening + own.spring) * (DEAD_VOLUME + opening)
    state = State(opening, mass, 0.0, 0.0, opening, opening, wanted, 0.0)
    return state, Pace(-1.0, 0.0, 0.0, 0.0, 1.0, 1.0)
