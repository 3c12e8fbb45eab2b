# SPDX-License-Identifier: BSD-3-Clause
"""Stretches of the laboratory network: commands, flows and one level or pressure, no position, no data sheet.

The valves are slow and one has play, so that the healthy base itself holds something: that is part of the
model, and the diagnosis of the untouched stretch is the control.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize, nnls

from benchmarks.concealed.inject.base import Base
from benchmarks.concealed.inject.passage import Fluid, Trim, flow
from benchmarks.concealed.inject.stem import stem

VALVES = {"VA_A1": ("FS_A1", "PS_A2"), "VA_C1": ("FS_C1", "LS_A1"), "VA_C3": ("FS_C3", "LS_A3")}
STRETCHES = ((150, 4150, 4850), (4850, 8850, 9650))
# cm3/s in m3/h, cm of water in bar
CM3_S, CM_H2O = 0.0036, 98.0665e-5
# weight of a bend of the trim, as a share of the norm of what is fitted
STIFF = 0.02
# delay, lag of the meter, two speeds, play behind the stem, head
STARTS = ((2.0, 2.0, 0.02, 0.02, 0.01, 0.0), (1.0, 3.0, 0.02, 0.02, 0.08, 0.05))


def stretches(data):
    """Six stretches, two of each valve, each with its own fit; its sheet comes from the other one."""
    import pandas as pd

    frame = pd.read_csv(Path(data) / "watersafe" / "recording.csv")
    out = []
    for tag, (measured, pressure) in VALVES.items():
        pair = [
            of_signals(
                f"watersafe {tag}, {first} to {end} s",
                *(frame[column].to_numpy()[first:last] for column in (tag, measured, pressure)),
                rows=end - first,
            )
            for first, end, last in STRETCHES
        ]
        out += [known_by(one, other) for one, other in zip(pair, pair[::-1], strict=True)]
    return out


def known_by(base, other):
    """A base whose sheet holds capacity, curve and outlet level as another stretch of the valve taught them.

    Without them no effect on capacity could be named, for nobody published a sheet of these valves.
    """
    at = np.unique(np.r_[0.0, other.trim.openings, 1.0])
    kv = np.maximum.accumulate(other.trim(at))
    kv[0] = 0.0 if at[1] > 0.0 else kv[0]
    curve = [[round(float(x), 4), round(float(c / kv[-1]), 5)] for x, c in zip(at, kv, strict=True)]
    sheet = base.sheet | {
        "valve": {"tag": "valve", "kv_rated": round(float(kv[-1]), 5), "characteristic": curve},
        "recording": base.sheet["recording"]
        | {"p2": {"constant": round(-100.0 * other.sound["head"], 2), "unit": "kPa", "gauge": True}},
    }
    return replace(base, sheet=sheet)


def of_signals(name, command, recorded, level, rows):
    """A base from a command [1], a flow [cm3/s] and a pressure [cm of water]."""
    recorded = recorded * CM3_S
    n = len(command)
    p2 = np.full(n, 1.01325)
    fluid = Fluid(p2 + level * CM_H2O, p2, np.full(n, 0.998), np.full(n, 0.023))
    sound, trim = fitted(command, recorded, fluid, rows)
    kilopascals = {"unit": "kPa", "gauge": True}
    sheet = {
        "valve": {"tag": "valve", "characteristic": "unknown"},
        "fluid": {"name": "water"},
        "simulation": {"physics": []},
        "recording": {
            "time": "time",
            "command": {"column": "CV", "unit": "%"},
            "flow": {"column": "F", "unit": "m3/h"},
            "p1": {"column": "P1"} | kilopascals,
            "p2": {"constant": 0.0} | kilopascals,
        },
    }
    columns = {"CV": 100.0 * command, "P1": 100.0 * level * CM_H2O}
    return Base(
        name, "watersafe", rows, 1.0, command, None, recorded, fluid, trim, sound,
        sheet=sheet, columns=columns,
    )  # fmt: skip


def fitted(command, recorded, fluid, rows):
    """Sound values and trim of least squares on the rows to diagnose."""
    low, high = command.min(), command.max()
    knots = np.linspace(low, high, 8)
    bends = np.diff(np.eye(len(knots)), 2, axis=0)

    def trial(values):
        delay, lag, opening, closing, play, head = np.abs(values)
        sound = {
            "delay": delay, "meter_lag": lag, "opening_speed": opening, "closing_speed": closing,
            "plug_play": play, "head": head,
        }  # fmt: skip
        now = {key: np.full(len(command), value) for key, value in sound.items()}
        at = stem(command, now)
        # the passage is linear in the capacities, so a knot at a time gives the columns of least squares
        unit = np.eye(len(knots))
        columns = np.column_stack([flow(at, Trim(knots, unit[k]), fluid, now) for k in range(len(knots))])
        # the stem is rarely at some knots: bends are held back, so that no knot runs away
        held = np.vstack([columns[:rows], STIFF * np.linalg.norm(columns[:rows]) * bends])
        weights, _ = nnls(held, np.r_[recorded[:rows], np.zeros(len(bends))])
        return np.linalg.norm(recorded[:rows] - columns[:rows] @ weights), sound, weights

    scale = np.sqrt(rows) * recorded[:rows].std()
    best = min(
        (
            minimize(lambda v: trial(v)[0] / scale, start, method="Nelder-Mead", options={"maxfev": 400})
            for start in STARTS
        ),
        key=lambda found: found.fun,
    )
    _, sound, weights = trial(best.x)
    return sound, Trim(knots, weights)
