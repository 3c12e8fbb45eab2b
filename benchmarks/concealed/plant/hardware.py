# SPDX-License-Identifier: BSD-3-Clause
"""What one plant is made of, drawn: the data sheet, the valve as it was made, actuator, line, meters."""

import numpy as np

from benchmarks.concealed.plant.columns import SOUND
from benchmarks.concealed.plant.loop import HARDWARE, P_ATM

TRIM_POINTS = 1001
# (rated kv [m3/h], nominal size [mm], travel [mm], effective area [cm2])
SIZES = (
    (16.0, 40.0, 20.0, 250.0),
    (25.0, 50.0, 25.0, 320.0),
    (40.0, 50.0, 38.1, 320.0),
    (100.0, 80.0, 38.1, 550.0),
)


def draw_sheet(rng):
    """What the maker says of the valve."""
    kv, size, travel, area = SIZES[int(rng.integers(len(SIZES)))]
    return {
        "kv_rated": kv,
        "characteristic": str(rng.choice(["equal_percentage"] * 3 + ["linear"])),
        "rangeability": float(rng.choice([25.0, 33.0, 50.0])),
        "shutoff": 0.02,
        "fl": float(rng.choice([0.75, 0.8, 0.85, 0.88])),
        "fd": 0.42,
        "nominal_size": size,
        "travel": travel,
        "area": area,
        "supply": float(rng.choice([140.0, 200.0, 340.0])),
    }


def relative_capacity(sheet, x):
    """kv over rated kv, over opening, as the sheet has it."""
    x = np.asarray(x, dtype=float)
    inside, low = np.maximum(x, sheet["shutoff"]), 1.0 / sheet["rangeability"]
    phi = low + (1.0 - low) * inside if sheet["characteristic"] == "linear" else low ** (1.0 - inside)
    return phi * np.clip(x / sheet["shutoff"], 0.0, 1.0)


def draw_trim(rng, sheet):
    """kv [m3/h] and F_L of the valve as made, on an even grid of the opening.

    A smooth departure within half the sheet's tolerance, and on it what a computed flow through real ports
    shows: ripples of a few thousandths, several to the travel.
    """
    x = np.linspace(0.0, 1.0, TRIM_POINTS)
    phi = relative_capacity(sheet, x)
    tolerance = 0.1 * np.maximum(phi, 1e-2) ** -0.2
    smooth = sum(
        rng.uniform(-1.0, 1.0) / k * np.sin(np.pi * k * x + rng.uniform(0.0, 2.0 * np.pi)) for k in (1, 2, 3)
    )
    smooth -= smooth[-1]
    smooth *= rng.uniform(0.15, 0.5) / np.abs(smooth).max()
    ripple = sum(np.sin(2.0 * np.pi * (k * x + rng.uniform())) for k in rng.uniform(4.0, 11.0, 3))
    for share in (1.0, 0.7, 0.5, 0.3, 0.15, 0.0):
        made = phi * (1.0 + share * smooth * tolerance + share * 0.001 * ripple)
        if np.all(np.diff(made) > 0.0):
            break
    capacity = sheet["kv_rated"] * (1.0 + rng.uniform(-0.07, 0.07))
    tight = 1e-5 * capacity
    fall = rng.uniform(0.0, 0.06)
    fl = sheet["fl"] * (1.0 + rng.uniform(-0.04, 0.04)) * (1.0 + fall * (0.5 - x))
    return capacity * np.maximum(made, 0.0) + tight, fl


def draw_hardware(rng, sheet):
    """Scalars of the plant in the order of `HARDWARE`, and the sound row of its schedule."""
    kv, travel, area = sheet["kv_rated"], 1e-3 * sheet["travel"], 1e-4 * sheet["area"]
    stroke = rng.uniform(0.8, 1.8)  # of the whole travel [s], and about twice that to settle
    supply = 1e3 * sheet["supply"] + P_ATM
    # air for the chamber's whole volume at the upper end of the spring's range, within that time
    volume = rng.uniform(2.0, 4.0) * area * travel
    fill = 2.2e5 * area * travel * 1.6 / (287.05 * 295.0 * 1.185 * supply * stroke)
    values = {
        "travel": travel,
        "area": area,
        "stiffness": 80e3 * area / travel,
        "preload": 20e3 * area,
        "mass": rng.uniform(2.0, 6.0),
        "damping": rng.uniform(0.02, 0.05) * 80e3 * area / travel,
        "stribeck": rng.uniform(0.8e-3, 2e-3),
        "bristle_damping": rng.uniform(0.3, 0.8),
        "fill": fill * rng.uniform(0.9, 1.2),
        "vent": fill * supply / 441e3 * rng.uniform(2.6, 3.6),
        "tube": fill * rng.uniform(3.0, 5.0),
        "v_tube": 0.15 * volume,
        "v_chamber": volume,
        "gain": rng.uniform(3.5, 6.0),
        "rate_gain": rng.uniform(0.3, 0.7),
        "overlap": rng.uniform(0.002, 0.01),
        "integral_time": float(rng.choice([0.0, 0.0, 25.0])),
        "source_loss": rng.uniform(60e3, 130e3) / (2.0 * kv) ** 2,
        "outlet_loss": rng.uniform(40e3, 110e3) / (2.0 * kv) ** 2,
        "inertance": rng.uniform(8e3, 25e3) * 4.0 / kv / 3.6,
        "kv": kv,
        "size4": sheet["nominal_size"] ** 4,
        "knee": rng.uniform(14.0, 30.0),
        "fd": sheet["fd"],
        "position_lag": rng.uniform(0.1, 0.4),
        "pressure_lag": rng.uniform(0.1, 0.4),
        "erosion_reach": rng.uniform(0.05, 0.08),
    }
    force = 80e3 * area  # of the spring over the whole travel [N]
    sound = SOUND | {
        "supply": supply,
        "dead_time": rng.uniform(0.05, 0.4),
        "dead_zone": rng.uniform(0.0003, 0.001),
        "coulomb": force * rng.uniform(0.003, 0.007),
        "reach": rng.uniform(2e-4, 8e-4),
        "plug_area": rng.uniform(-0.2e-4, 0.3e-4),
        "link_play": rng.uniform(0.0002, 0.001),
        "plug_play": rng.uniform(0.0005, 0.002),
        "plug_offset": rng.uniform(-0.003, 0.003),
        "cavitation_begin": rng.uniform(0.35, 0.5),
        "cavitation_loss": rng.uniform(0.0, 0.006),
        "meter_lag": rng.uniform(0.4, 2.0),
        "meter_bias": rng.uniform(-0.0025, 0.0025) * 2.0 * kv,
    }
    sound["stick"] = sound["coulomb"] * rng.uniform(1.05, 1.3)
    return np.array([float(values[name]) for name in HARDWARE]), sound
