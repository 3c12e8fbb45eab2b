# SPDX-License-Identifier: BSD-3-Clause
"""What happens to a plant while it is recorded: commands, set-points, pressures, temperature."""

import numpy as np
from scipy.signal import lfilter

EXCITATIONS = ("wide", "closed", "cascade")


def wander(rng, n, seconds):
    """First-order noise of unit variance, one value a second."""
    pole = np.exp(-1.0 / seconds)
    return lfilter(
        [np.sqrt(1.0 - pole**2)], [1.0, -pole], rng.standard_normal(n), zi=[pole * rng.standard_normal()]
    )[0]


def levels(rng, n, low, high, dwell, ramp=(0.0, 1.0)):
    """Levels held and left by ramps; `dwell` and `ramp` are ranges of seconds."""
    t, knots, values = 0.0, [0.0], [rng.uniform(low, high)]
    while t < n:
        for wait, value in ((rng.uniform(*dwell), values[-1]), (rng.uniform(*ramp), rng.uniform(low, high))):
            t += wait
            knots.append(t)
            values.append(value)
    return np.interp(np.arange(n), knots, values)


def _strokes(rng, n):
    """Slow strokes up and down the whole travel."""
    half = rng.uniform(120.0, 360.0)
    place = (np.arange(n) / half + rng.uniform(0.0, 2.0)) % 2.0
    return rng.uniform(0.0, 0.05) + rng.uniform(0.9, 0.97) * (1.0 - np.abs(place - 1.0))


def _waves(rng, n):
    """Two sines about a level that shifts: moves of a few percent, with many turns."""
    t = np.arange(n)
    base = levels(rng, n, 0.15, 0.85, (200.0, 400.0), (10.0, 40.0))
    for period in rng.uniform(25.0, 140.0, 2):
        base = base + rng.uniform(0.01, 0.06) * np.sin(2.0 * np.pi * t / period)
    return base


def _seat(rng, n):
    """Approaches to the seat, and stays on it."""
    command = np.clip(levels(rng, n, -0.03, 0.18, (25.0, 60.0), (5.0, 40.0)), 0.0, 1.0)
    begin = int(rng.uniform(0.0, 0.6) * n)
    command[begin : begin + 60] = 0.0
    return command


def _steps(rng, n):
    return levels(rng, n, 0.03, 0.98, (40.0, 180.0))


def wide_command(rng, n):
    """A command that sees most of the travel: steps, strokes, waves and the seat, in a drawn order."""
    pieces, total = [], 0
    while total < n:
        for kind in rng.permutation(4):
            length = int(rng.uniform(180.0, 300.0) if kind == 3 else rng.uniform(350.0, 700.0))
            pieces.append((_steps, _strokes, _waves, _seat)[kind](rng, length))
            total += length
    return np.clip(np.concatenate(pieces)[:n], 0.0, 1.0)


def flow_setpoint(rng, n, kv):
    """Set-points of flow [m3/h]: steps, some of them ramped."""
    low = rng.uniform(0.2, 0.45) * kv
    return levels(rng, n, low, rng.uniform(0.9, 1.25) * kv, (150.0, 500.0), (0.0, 40.0))


def level_task(rng, n, kv):
    """Set-points of the level [1], and what is drawn from the vessel [m3/h]."""
    return levels(rng, n, 0.4, 0.6, (600.0, 1200.0)), levels(
        rng, n, 0.3 * kv, 1.0 * kv, (250.0, 700.0), (5.0, 60.0)
    )


def pressures(rng, n, excitation, hot):
    """Pressure of source and tank [Pa] before the line's losses, one value a second."""
    source = 850e3 + 10e3 * wander(rng, n, 120.0) + 3e3 * wander(rng, n, 15.0)
    source += levels(rng, n, -35e3, 35e3, (400.0, 1300.0), (5.0, 60.0))
    low, high = {"wide": (180e3, 520e3), "closed": (220e3, 380e3), "cascade": (200e3, 420e3)}[excitation]
    tank = levels(rng, n, low, high, (300.0, 900.0), (5.0, 80.0)) + 4e3 * wander(rng, n, 50.0)
    if hot:
        source, tank = source + 300e3, tank + 100e3
    return source, np.maximum(tank, 1.5e5)


def climate(rng, fluid):
    """Middle of the fluid's temperature [degC], and how far its slow cycle goes [K]."""
    middle = {
        "water": rng.uniform(15.0, 65.0),
        "hot_water": rng.uniform(135.0, 145.0),
        "oil": rng.uniform(25.0, 55.0),
    }
    return middle[fluid], rng.uniform(5.0, 9.0) if fluid == "oil" else rng.uniform(1.5, 5.0)


def temperature(rng, n, middle, swing):
    """Of the fluid [degC], one value a second: a slow cycle and what the weather adds."""
    cycle = swing * np.sin(2.0 * np.pi * (np.arange(n) / rng.uniform(2500.0, 7000.0) + rng.uniform()))
    return middle + cycle + 0.5 * wander(rng, n, 150.0)
