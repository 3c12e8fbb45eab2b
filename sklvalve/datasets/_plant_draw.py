# SPDX-License-Identifier: BSD-3-Clause
"""What one plant is made of and what happens to it, drawn: hardware, commands, disturbances, noise."""

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.signal import lfilter

from sklvalve.datasets._plant_loop import ACTUATOR, COLUMNS, CONTROLLER, LINE, P_ATM

WARM_UP = 120  # seconds run before the first recorded row, so that no record starts with a filter's transient
LOOPS = ("wide", "closed", "mixed")
TRIM_POINTS = 2001


def wander(rng, n, time_constant):
    """Ornstein-Uhlenbeck series of unit variance, one sample a second."""
    pole = np.exp(-1.0 / time_constant)
    kick = rng.standard_normal(n) * np.sqrt(1.0 - pole * pole)
    return lfilter([1.0], [1.0, -pole], kick, zi=[pole * rng.standard_normal()])[0]


def steps(rng, n, low, high, dwell, ramp):
    """Piecewise constant levels joined by ramps, `dwell` and `ramp` being ranges of seconds."""
    knots, values, t = [0.0], [rng.uniform(low, high)], 0.0
    while t < n:
        t += rng.uniform(*dwell)
        knots.append(t)
        values.append(values[-1])
        t += rng.uniform(*ramp)
        knots.append(t)
        values.append(rng.uniform(low, high))
    return np.interp(np.arange(n), knots, values)


def water(celsius):
    """Water below 100 degC: density [kg/m3], Kell 1975, and vapour pressure [Pa], Goff and Gratch 1946."""
    t = np.asarray(celsius, dtype=float)
    above = (
        999.83952
        + 16.945176 * t
        - 7.9870401e-3 * t**2
        - 46.170461e-6 * t**3
        + 105.56302e-9 * t**4
        - 280.54253e-12 * t**5
    )
    density = above / (1.0 + 16.879850e-3 * t)
    boiling = 373.16 / (t + 273.15)
    log_hpa = (
        -7.90298 * (boiling - 1.0)
        + 5.02808 * np.log10(boiling)
        - 1.3816e-7 * (10.0 ** (11.344 * (1.0 - 1.0 / boiling)) - 1.0)
        + 8.1328e-3 * (10.0 ** (-3.49149 * (boiling - 1.0)) - 1.0)
        + np.log10(1013.246)
    )
    return density, 100.0 * 10.0**log_hpa


def jet_floor(vapour_pressure):
    """Lowest pressure [Pa] the jet reaches before it boils: a power law near the handbooks' curve."""
    return vapour_pressure * (0.965 - 0.26 * (vapour_pressure / 22.064e6) ** 0.45)


def draw_sheet(rng):
    """The engineer's data sheet."""
    return {
        "kv_rated": float(rng.choice([25.0, 40.0, 40.0, 63.0])),
        "characteristic": str(rng.choice(["equal_percentage"] * 4 + ["linear"])),
        "rangeability": float(rng.choice([30.0, 40.0, 50.0])),
        "shutoff": 0.02,
        "fl": float(rng.choice([0.85, 0.9, 0.9])),
        "fd": 0.46,
        "nominal_size": 50.0,
        "travel": 38.1,
    }


def sheet_trim(characteristic, rangeability, shutoff, x):
    """Relative capacity over opening as a sheet states it."""
    inside = np.maximum(x, shutoff)
    if characteristic == "linear":
        phi = 1.0 / rangeability + (1.0 - 1.0 / rangeability) * inside
    else:
        phi = np.exp(np.log(rangeability) * (inside - 1.0))
    return phi * np.minimum(x / shutoff, 1.0)


def draw_trims(rng, sheet):
    """The true trim and what a wrong one tends to, kv [m3/h], and F_L, on an even grid of opening."""
    x = np.linspace(0.0, 1.0, TRIM_POINTS)
    low = sheet["shutoff"]
    sheet_phi = sheet_trim(sheet["characteristic"], sheet["rangeability"], low, x)
    knots = np.linspace(0.0, 1.0, 8)
    wiggle = PchipInterpolator(knots, rng.uniform(-1.0, 1.0, knots.size))(x)
    wiggle -= wiggle[-1]
    tolerance = 0.1 * (1.0 / np.maximum(sheet_phi, 1e-2)) ** 0.2
    share = rng.uniform(0.25, 0.6) / max(np.abs(wiggle).max(), 1e-9)
    phi = sheet_phi
    for _ in range(8):
        phi = sheet_phi * (1.0 + share * wiggle * tolerance)
        if np.all(np.diff(phi) > 0.0):
            break
        share *= 0.7
    capacity = sheet["kv_rated"] * (1.0 + rng.uniform(-0.08, 0.08))
    foreign = "linear" if sheet["characteristic"] == "equal_percentage" else "equal_percentage"
    other = sheet_trim(foreign, sheet["rangeability"], low, x)
    leak = 2e-5 * capacity  # the clearance of a tight seat
    fl = sheet["fl"] * (1.0 + rng.uniform(-0.03, 0.03)) * (1.0 + rng.uniform(0.02, 0.05) * (1.0 - 2.0 * x))
    return capacity * phi + leak, capacity * other + leak, fl


def draw_hardware(rng, sheet):
    """Scalars of actuator, line and controller in the loop's order, and the schedule's healthy row."""
    kv = sheet["kv_rated"]
    travel = sheet["travel"] * 1e-3
    area = 0.029
    actuator = {
        "area": area,
        "travel": travel,
        "stiffness": 80e3 * area / travel,
        "preload": 20e3 * area,
        "mass": 3.0,
        "damping": rng.uniform(2500.0, 5000.0),
        "plug_area": rng.uniform(-0.2e-4, 0.3e-4),
        "stribeck": rng.uniform(1e-3, 2.5e-3),
        "c_fill": rng.uniform(1.8e-8, 2.6e-8),
        "c_vent": rng.uniform(3.5e-8, 5e-8),
        "c_tube": rng.uniform(5e-8, 7e-8),
        "v_tube": 1.0e-3,
        "v_chamber": rng.uniform(3.5e-3, 5.5e-3),
        "gain": rng.uniform(4.5, 6.5),
        "reset_time": float(rng.choice([0.0, 0.0, 12.0])),
        "converter_lag": rng.uniform(0.05, 0.12),
        "overlap": rng.uniform(0.005, 0.015),
    }
    line = {
        "pump_loss": rng.uniform(80e3, 130e3) / (2.0 * kv) ** 2,
        "outlet_loss": rng.uniform(60e3, 110e3) / (2.0 * kv) ** 2,
        "inertance": rng.uniform(15.0, 40.0) * 1000.0 / 5.0e-3 / 3600.0,
        "size4": sheet["nominal_size"] ** 4,
        "knee": rng.uniform(8.0, 14.0),
        "bypass_fl": 0.75,
        "pressure_lag": rng.uniform(0.1, 0.3),
        "position_lag": rng.uniform(0.1, 0.3),
    }
    controller = {
        "gain": rng.uniform(0.25, 0.45) / (2.0 * kv),
        "reset_time": rng.uniform(6.0, 12.0),
        "low": 0.02,
        "high": 1.0,
    }
    healthy = dict.fromkeys(COLUMNS, 0.0) | {
        "capacity": 1.0,
        "open_max": 1.0,
        "fl_factor": 1.0,
        "choking": 1.0,
        "plug_play": rng.uniform(0.0005, 0.002),
        "link_play": rng.uniform(0.0002, 0.001),
        "plug_offset": rng.uniform(-0.003, 0.003),
        "supply": 340e3 + P_ATM,
        "dead_zone": rng.uniform(0.0003, 0.001),
        "dead_time": rng.uniform(0.0, 0.4),
        "coulomb": rng.uniform(8.0, 16.0),
        "meter_gain": 1.0,
        "meter_bias": rng.uniform(-0.0025, 0.0025) * 2.0 * kv,
        "meter_lag": rng.uniform(0.4, 1.8),
    }
    healthy["stick"] = healthy["coulomb"] * rng.uniform(1.0, 1.3)
    pack = lambda names, values: tuple(float(values[name]) for name in names)  # noqa: E731
    return pack(ACTUATOR, actuator), pack(LINE, line), pack(CONTROLLER, controller), healthy


def draw_surroundings(rng, n, loop):
    """Source and tank pressure [Pa] before line losses, water temperature [degC], one value a second."""
    source = 820e3 + 12e3 * wander(rng, n, 150.0) + 4e3 * wander(rng, n, 20.0)
    source += steps(rng, n, -30e3, 30e3, (500.0, 1500.0), (5.0, 40.0))
    low, high = (200e3, 500e3) if loop == "wide" else (240e3, 330e3) if loop == "closed" else (210e3, 420e3)
    dwell = (350.0, 1000.0) if loop == "wide" else (900.0, 2500.0)
    tank = steps(rng, n, low, high, dwell, (5.0, 60.0)) + 4e3 * wander(rng, n, 60.0)
    middle = rng.uniform(60.0, 75.0) if rng.uniform() < 0.2 else rng.uniform(25.0, 50.0)
    period = rng.uniform(4000.0, 9000.0)
    cycle = rng.uniform(2.0, 4.0) * np.sin(2.0 * np.pi * (np.arange(n) / period + rng.uniform()))
    return source, np.maximum(tank, 1.6e5), middle + cycle + 0.6 * wander(rng, n, 120.0)


def _staircase(rng, length):
    return steps(rng, length, 0.04, 0.97, (40.0, 200.0), (0.0, 1.0))


def _triangle(rng, length):
    low, high = rng.uniform(0.0, 0.06), rng.uniform(0.9, 1.0)
    half = rng.uniform(150.0, 450.0)
    start = rng.uniform(0.0, 2.0 * half)
    return low + (high - low) * np.abs(((np.arange(length) + start) / half) % 2.0 - 1.0)


def _small_steps(rng, length):
    """Small moves with reversals about a few levels, as a loop near its set-point makes them."""
    base = steps(rng, length, 0.08, 0.9, (250.0, 500.0), (5.0, 60.0))
    count = length // 15 + 2
    level = np.clip(np.cumsum(rng.uniform(-0.035, 0.035, count)), -0.1, 0.1)
    return base + np.repeat(level, 15)[:length]


def _near_seat(rng, length):
    """Slow approach to the seat and a stay on it."""
    command = np.clip(steps(rng, length, -0.02, 0.16, (30.0, 70.0), (5.0, 60.0)), 0.0, 1.0)
    begin = int(rng.uniform(0.0, length - 80.0))
    command[begin : begin + int(rng.uniform(40.0, 80.0))] = 0.0
    return command


def draw_command(rng, n):
    """A command that visits most of the travel: staircases, ramps, small reversals, stays near the seat."""
    pieces, total, order = [], 0, []
    while total < n:
        if not order:
            order = list(rng.permutation(4))
        kind = order.pop()
        length = int(rng.uniform(200.0, 350.0) if kind == 3 else rng.uniform(450.0, 900.0))
        pieces.append((_staircase, _triangle, _small_steps, _near_seat)[kind](rng, length))
        total += length
    return np.clip(np.concatenate(pieces)[:n], 0.0, 1.0)


def draw_setpoint(rng, n, kv):
    """Flow set-points [m3/h]: steps and a few ramps within the middle of the valve's range."""
    low = rng.uniform(0.25, 0.5) * kv
    return steps(rng, n, low, rng.uniform(0.95, 1.2) * kv, (200.0, 600.0), (0.0, 30.0))


def draw_noise(rng, n, kv, level):
    """Sensor noise by column, in the column's unit, and the water's turbulence as a share of flow."""
    flow = 0.0022 * rng.standard_normal(n) + 0.001 * wander(rng, n, rng.uniform(6.0, 12.0))
    flow += 0.001 * wander(rng, n, rng.uniform(300.0, 1000.0))
    noise = {
        "F": 1.5 * kv * flow,
        "X": 0.12 * rng.standard_normal(n) + 0.04 * wander(rng, n, 10.0) + 0.03 * wander(rng, n, 500.0),
        "P1": 0.25 * rng.standard_normal(n) + 0.15 * wander(rng, n, 400.0),
        "P2": 0.25 * rng.standard_normal(n) + 0.15 * wander(rng, n, 400.0),
        "T1": 0.05 * rng.standard_normal(n),
    }
    zero = {
        "F": 0.0,
        "X": 0.0,
        "P1": rng.uniform(-1.2, 1.2),
        "P2": rng.uniform(-1.2, 1.2),
        "T1": rng.uniform(-0.3, 0.3),
    }
    turbulence = 0.002 * wander(rng, n, 2.0)
    return {name: level * value + zero[name] for name, value in noise.items()}, level * turbulence
