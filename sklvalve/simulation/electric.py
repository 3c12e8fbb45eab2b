# SPDX-License-Identifier: BSD-3-Clause
"""Electric actuators: a motor that runs at one speed, and a comparator that starts it."""

from math import exp

import numba as nb
import numpy as np

from sklvalve.simulation.declared import declared_speed
from sklvalve.simulation.parameters import Parameter
from sklvalve.simulation.stages import delayed

# so far inside its dead band a motor is switched off; nearer no motor stops
_STOPS_AT = 0.03
# a motor slows down within this share of the response time that positioners and actuators may have
_APPROACH = 0.03
# what stands in where a healthy motor's speed is not known [1/s]
_SPEED = 1.0


#: Kinds of actuators that run at a speed of their own: oil metered by a pump drives as a motor does.
DRIVEN = ("electric", "hydraulic")


def knows_air(valve, recording):
    """Whether the sheet says, or a recorded pressure shows, that air drives the stem."""
    if valve.kind in ("pneumatic", *DRIVEN):
        return valve.kind == "pneumatic"
    air = (valve.supply_pressure, valve.spring_range, valve.effective_area, valve.fail)
    told = {"actuator_pressure", "supply_pressure"} & set(recording)
    return bool(told) or any(known is not None for known in air)


def is_electric(valve, recording):
    """Whether a motor drives the stem: the sheet says so, or a position is recorded and nothing of air known.

    Parameters
    ----------
    valve : Valve
    recording : Recording

    Returns
    -------
    electric : bool
        As `kind` of the sheet says; where that is missing or unknown, True where no air supply, spring,
        diaphragm or fail position is known, and no pressure of the actuator is recorded. Without a position
        nothing tells one kind from the other then, and all effects stay open.
    """
    if valve.kind in DRIVEN:
        return True
    return "opening" in recording and not knows_air(valve, recording)


def motor_parameters(tolerance, valve):
    """Parameters of a healthy motor that stay open.

    What a data sheet grants the response of positioner and actuator is here the motor's time for a stroke,
    unless the sheet declares one. The comparator that starts it answers at once, and the motor slows down for
    a moment only.
    """
    lag = _APPROACH * tolerance.response
    speed = Parameter("actuator_speed", "1/s", 0.5 / tolerance.response, 10.0, _SPEED, spread=1.5, log=True)
    return (
        Parameter("actuator_filter", "s", 0.01, lag, 0.5 * lag, spread=1.0, log=True),
        speed if valve.stroke_time is None else declared_speed("actuator_speed", tolerance, valve),
    )


@nb.njit(cache=True, nogil=True)
def motor(command, step, x0, up, down, dead_band, reversal, lag):
    """Position of a motor that a comparator switches on and off.

    At rest it starts when the error exceeds the dead band, or `reversal` times the dead band where it ran the
    other way before. It then runs at its speed, slows down within `lag` times that speed of its target, and
    stops where it meets it.

    Parameters
    ----------
    command, step : ndarray of shape (n,)
        Wanted position [1], a gap (NaN) holds the value before it; time since the sample before [s].
    x0 : float
        Position at the beginning [1].
    up, down, dead_band, reversal : ndarray of shape (n,)
        Speeds of opening and closing [1/s]; half width of the dead band [1]; factor on it where the motor
        turns [1].
    lag : float
        Time constant of the approach [s].

    Returns
    -------
    position : ndarray of shape (n,)
    """
    out = np.empty(len(command))
    x = x0
    target = x0
    last = 0.0
    on = False
    for k in range(len(command)):
        before = target
        if command[k] == command[k]:
            target = command[k]
        left = abs(target - x)
        side = 1.0 if target > x else -1.0
        remaining = step[k]
        if not on:
            limit = dead_band[k] * reversal[k] if side * last < 0.0 else dead_band[k]
            on = left > limit
            ahead = side * (before - x)
            if on and ahead < limit:
                # the command moves evenly between two samples, and the motor starts as it passes the limit:
                # so a delay by less than a sample is seen
                remaining *= (left - limit) / (left - ahead)
        if on:
            last = side
            speed = up[k] if side > 0.0 else down[k]
            knee = speed * lag
            if left > knee:
                running = min((left - knee) / speed, remaining)
                left -= speed * running
                remaining -= running
            if remaining > 0.0:
                left *= exp(-remaining / lag)
            x = min(max(target - side * left, 0.0), 1.0)
            on = left > _STOPS_AT * dead_band[k]
        out[k] = x
    return out


def electric_stem(chain, values, changed):
    """Opening to which an electric actuator drives its stem, free run from the command [1].

    Parameters
    ----------
    chain : Chain
        Its effects change the command at stage ``"signal"``, and at stage ``"actuator"`` the motor: a dict of
        ``up``, ``down``, ``dead_band`` and ``reversal`` as `motor` takes them.
    values : dict
    changed : callable
        ``changed(stage, value, values)`` is what the chain's effects make of a stage.

    Returns
    -------
    stem : ndarray of shape (n,)
    """
    n = len(chain.command)
    command = delayed(chain.command, chain.time, values["actuator_delay"])
    command = changed("signal", command, values)
    speed = values.get("actuator_speed", _SPEED)
    drive = {
        "up": np.full(n, speed),
        "down": np.full(n, speed),
        "dead_band": np.full(n, 0.5 * values.get("actuator_dead_band", 0.0)),
        "reversal": np.ones(n),
    }
    drive = changed("actuator", drive, values)
    start = chain.measured[0] if chain.measured is not None else command[0]
    start = float(start) if np.isfinite(start) else 0.5
    stem = motor(
        command,
        chain.step,
        start,
        drive["up"],
        drive["down"],
        drive["dead_band"],
        drive["reversal"],
        values["actuator_filter"],
    )
    return stem
