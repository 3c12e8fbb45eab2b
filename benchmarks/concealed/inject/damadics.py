# SPDX-License-Identifier: BSD-3-Clause
"""Stretches of one real hour of a boiler's feed water valve: command, position, both pressures, flow.

The level controller never rests, so that the model is fitted to motion; what it leaves over is kept as it is.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import minimize, nnls

from benchmarks.concealed.inject.base import Base
from benchmarks.concealed.inject.passage import Fluid, Trim, flow
from benchmarks.concealed.inject.stem import stem

FILE = "actuator3_real_one_hour.csv"
STRETCHES = ((0, 1000, 1200), (1200, 2200, 2400), (2400, 3400, 3600))
DENSITY = 0.958
COLUMNS = ("LC74_20CV_pct", "LC74_20X_pct", "P74_00_kPa", "P74_01_kPa", "T74_00_degC", "F74_00_tph")


def stretches(data):
    """Three stretches of twenty minutes, each with its own fit."""
    import pandas as pd

    frame = pd.read_csv(Path(data) / "damadics" / FILE)
    return [
        of_signals(
            f"damadics hour, {first} to {end} s",
            *(frame[column].to_numpy()[first:last] for column in COLUMNS),
            rows=end - first,
        )
        for first, end, last in STRETCHES
    ]


def of_signals(name, closing, position, p1, p2, temperature, mass, rows):
    """A base from command and position [% of closing], pressures [kPa], degC and t/h."""
    command, opening = 1.0 - 0.01 * closing, 1.0 - 0.01 * position
    recorded = mass / DENSITY
    n = len(command)
    # Antoine's equation of water, in bar
    vapour = 10.0 ** (5.11564 - 1687.537 / (temperature + 230.17))
    fluid = Fluid(0.01 * p1, 0.01 * p2, np.full(n, DENSITY), vapour)
    stem_side, zero, gain = fitted_stem(command, opening, rows)
    meter_side, trim = fitted_trim(opening, recorded, fluid, rows)
    percent = lambda column: {"column": column, "unit": "%"}  # noqa: E731
    sheet = {
        "valve": {
            "tag": "valve", "kv_rated": 120.0, "characteristic": "equal_percentage",
            "rangeability": 148.4, "fl": 0.9, "nominal_size": 50.0, "travel": 38.1,
        },
        "fluid": {"name": "water"},
        "actuator": {
            "fail": "open", "supply_pressure": 240.0, "spring_range": [20.0, 100.0], "positioner": True,
        },
        "simulation": {"physics": []},
        "recording": {
            "time": "time", "command": percent("CV"), "opening": percent("X"),
            "p1": {"column": "P1", "unit": "kPa"}, "p2": {"column": "P2", "unit": "kPa"},
            "temperature": {"column": "T1", "unit": "degC"}, "flow": {"column": "F", "unit": "m3/h"},
        },
    }  # fmt: skip
    columns = {"CV": 100.0 * command, "P1": p1, "P2": p2, "T1": temperature}
    return Base(
        name, "damadics", rows, 1.0, command, opening, recorded, fluid, trim, stem_side | meter_side,
        zero, gain, sheet, columns, {"X": 0.1, "F": 0.1 / DENSITY},
    )  # fmt: skip


def fitted_stem(command, opening, rows):
    """Delay, lag, speeds and play, with zero and gain of least squares."""

    def trial(values):
        delay, lag, up, down, play = np.abs(values)
        sound = {
            "delay": delay, "lag": lag, "opening_speed": up, "closing_speed": down, "linkage_play": play,
        }  # fmt: skip
        made = stem(command, {key: np.full(len(command), value) for key, value in sound.items()})
        columns = np.column_stack([np.ones(rows), made[:rows]])
        weights, *_ = np.linalg.lstsq(columns, opening[:rows], rcond=None)
        return np.std(opening[:rows] - columns @ weights), sound, weights

    starts = ((0.5, 1.0, 0.05, 0.05, 0.01), (0.1, 0.5, 0.03, 0.1, 0.03), (0.1, 0.5, 0.1, 0.03, 0.03))
    found = [
        minimize(lambda v: trial(v)[0] / opening.std(), s, method="Nelder-Mead", options={"maxfev": 500})
        for s in starts
    ]
    _, sound, (zero, gain) = trial(min(found, key=lambda one: one.fun).x)
    return sound, float(zero), float(gain)


def fitted_trim(opening, recorded, fluid, rows):
    """Lag of the meter, and the capacities that the flow shows at the recorded positions."""
    low, high = np.quantile(opening, [0.01, 0.99])
    knots = np.linspace(low, high, 5)
    unit = np.eye(len(knots))

    def trial(values):
        now = {"meter_lag": np.full(len(opening), abs(values[0]))}
        columns = np.column_stack(
            [flow(opening, Trim(knots, unit[k]), fluid, now) for k in range(len(knots))]
        )
        weights, rest = nnls(columns[:rows], recorded[:rows])
        return rest, weights

    best = min((0.0, 0.3, 0.6, 1.0, 1.5, 2.5), key=lambda lag: trial([lag])[0])
    return {"meter_lag": best}, Trim(knots, trial([best])[1])
