# SPDX-License-Identifier: BSD-3-Clause
"""Stages of the chain that remember: each scans along time, compiled."""

from math import exp, sqrt

import numba as nb
import numpy as np


@nb.njit(cache=True, inline="always")
def _nozzle(ratio):
    # ISO 6358: the share of the choked mass flow that a pressure ratio leaves, critical ratio 0.3
    if ratio >= 1.0:
        return 0.0
    if ratio <= 0.3:
        return 1.0
    return sqrt(1.0 - ((ratio - 0.3) / 0.7) ** 2)


# no check for division by zero in the innermost loop: no divisor there can be zero
@nb.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def positioner_and_actuator(
    command, step, x0, spring, supply, coulomb, extra_stick, dead_band, filter_time, gain, reset, rate
):
    """Stem of a spring-loaded diaphragm actuator behind a positioner, driven by the command.

    All in travels: a pressure of one carries the spring over one travel. The positioner opens a spool in
    proportion to the error (and, by `reset`, to its integral); the spool fills the chamber from the supply or
    vents it, by nozzles that choke; the stem moves where pressure, spring and bristle friction with a
    Stribeck fall balance. Mass is left out: a stem answers in milliseconds.

    Parameters
    ----------
    command : ndarray of shape (n,)
        Wanted opening [1]. A gap (NaN) holds the value before it.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    x0 : float
        Opening at the beginning [1].
    spring : float
        Absolute pressure at which the spring begins to give way [travels of spring].
    supply, coulomb, extra_stick, dead_band : ndarray of shape (n,)
        Absolute supply pressure; sliding friction; how far friction at rest exceeds it [all in travels of
        spring]; half width of the positioner's dead band [1].
    filter_time, gain, reset, rate : float
        Time constant of the positioner's input [s], spool opening for an error [1], share of the spool for
        the error's integral [1/s], and capacity of the spool [1/s].

    Returns
    -------
    opening : ndarray of shape (n,)
        Position of the stem [1].
    """
    dead_volume = 5.0
    viscous = 0.005
    stribeck = 0.03
    bristle = 60.0
    n = len(command)
    out = np.empty(n)
    x = min(max(x0, 0.0), 1.0)
    wanted = command[0]
    if wanted != wanted:
        wanted = x
    target = wanted
    # a stem that stands at its end of travel may be pressed against it by any pressure
    pressure = x + spring
    mass = pressure * (dead_volume + x)
    vent = spring - 0.25
    integral = 0.0
    bend = 0.0
    speed = 0.0
    for k in range(n):
        if command[k] == command[k]:
            target = command[k]
        # whatever happened before the last 40 s has settled: a gap costs no more, and keeps its fine steps
        lasting = min(step[k], 40.0)
        many = max(1, int(lasting / 0.1 + 0.5))
        h = lasting / many
        pull = h / max(filter_time, h)
        ps = supply[k]
        slide = max(coulomb[k], 1e-4)
        stick = extra_stick[k]
        for _ in range(many):
            wanted += pull * (target - wanted)
            error = wanted - x
            if error > dead_band[k]:
                error -= dead_band[k]
            elif error < -dead_band[k]:
                error += dead_band[k]
            else:
                error = 0.0
            integral = min(max(integral + h * reset * error, -0.2), 0.2)
            spool = min(max(gain * error + integral, -1.0), 1.0)
            # implicit in the pressure, so that a fast spool settles instead of ringing
            if spool > 0.0:
                mass += h * rate * spool * ps * _nozzle(pressure / ps)
            elif spool < 0.0:
                mass += h * rate * spool * pressure * _nozzle(vent / pressure)
            pressure = mass / (dead_volume + x)
            air = pressure / (dead_volume + x)
            force = pressure - spring - x
            left = force - bristle * bend
            side = 1.0 if left > 0.0 else -1.0
            limit = slide + stick * exp(-((speed / stribeck) ** 2))
            settled = side * limit / bristle
            drag = h * (1.0 + air) + viscous
            decay = h * bristle / limit
            if side * (settled - bend) >= 0.0:
                w = 0.0
            else:
                w = max((side * force - limit) / drag, 0.0)
            fade = exp(-decay * w)
            for _newton in range(4):
                value = side * (force - bristle * (settled + (bend - settled) * fade)) - drag * w
                slope = -drag + side * bristle * (bend - settled) * fade * decay
                if slope > -1e-9:
                    break
                w = max(w - value / slope, 0.0)
                fade = exp(-decay * w)
                if abs(value) < 1e-5:
                    break
            speed = side * w
            bend = settled + (bend - settled) * fade
            x += h * speed
            if x > 1.0:
                x = 1.0
                speed = 0.0
            elif x < 0.0:
                x = 0.0
                speed = 0.0
        out[k] = x
    return out


@nb.njit(cache=True)
def play(inside, width):
    """Play between two parts: the outer one follows when the gap is used up.

    Parameters
    ----------
    inside : ndarray of shape (n,)
        Movement of the driving part [1].
    width : float
        Whole gap [1].

    Returns
    -------
    outside : ndarray of shape (n,)
        Movement of the driven part, in the middle of its gap at the beginning [1].
    """
    half = 0.5 * width
    out = np.empty_like(inside)
    y = np.nan
    for k in range(len(inside)):
        v = inside[k]
        if v == v:
            if y != y:
                y = v
            y = min(max(y, v - half), v + half)
            out[k] = y
        else:
            out[k] = np.nan
    return out


@nb.njit(cache=True)
def first_order_lag(values, step, time_constant, ahead):
    """First-order lag of a sampled signal.

    Parameters
    ----------
    values : ndarray of shape (n,)
        What the sensor sees; gaps (NaN) stay gaps and leave the lag where it was.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    time_constant : float
        Time constant [s].
    ahead : float
        How much of a step between two samples has taken place by the time of the second: 1 it jumped right
        after the first, 0 right before the second.

    Returns
    -------
    lagged : ndarray of shape (n,)
    """
    out = np.empty_like(values)
    y = np.nan
    before = np.nan
    for k in range(len(values)):
        v = values[k]
        if v != v:
            out[k] = np.nan
            continue
        if y != y:
            y = v
        else:
            keep = exp(-step[k] / time_constant) if time_constant > 0.0 else 0.0
            seen = ahead * v + (1.0 - ahead) * before
            y = keep * y + (1.0 - keep) * seen
        before = v
        out[k] = y
    return out


@nb.njit(cache=True)
def limited_rate(values, step, up, down):
    """Signal that follows another one no faster than `up` and `down` [1/s]; gaps hold."""
    out = np.empty_like(values)
    y = np.nan
    for k in range(len(values)):
        v = values[k]
        if y != y:
            y = v
        elif v == v:
            y = min(max(v, y - down * step[k]), y + up * step[k])
        out[k] = y
    return out


def delayed(values, time, dead_time):
    """Signal as it was `dead_time` [s] ago, linear between samples; the first value holds before the first.

    Parameters
    ----------
    values, time : ndarray of shape (n,)
        Signal, and its times [s].
    dead_time : float
        Delay [s].
    """
    known = np.isfinite(values)
    if dead_time <= 0.0 or not known.any():
        return values
    return np.interp(time - dead_time, time[known], values[known])
