# SPDX-License-Identifier: BSD-3-Clause
"""What of a change calibration could take up: all that a data sheet leaves open, each within its bounds.

The bounds are those of the design: capacity, trim and F_L 10 % (and as much for how F_L falls with travel,
which no sheet tells), responses 3 s each, static error half a percent, zeros 1 % of travel, 0.5 % of the
flow's span and 0.25 % of the pressures'. What the drawn plant has used of a bound already is no longer free.
Where P2 was not recorded, what lies behind the valve is open too.
"""

from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from benchmarks.concealed.plant.columns import COLUMNS
from benchmarks.concealed.plant.hardware import relative_capacity
from benchmarks.concealed.plant.march import A_SECOND
from benchmarks.concealed.plant.noise import whiten_flow, whiten_opening

CAPACITY, TRIM, RECOVERY, RESPONSE, STATIC, ZERO_X = 0.1, 0.1, 0.1, 3.0, 0.01, 0.01
ZERO_FLOW, ZERO_P = 0.005, 2500.0
# unrecorded, a pressure behind the valve may be off by half the mean drop, and so may its rise with the flow
BEHIND = 0.5
_HATS = np.linspace(0.0, 1.0, 8)
# what an actuator may be slower or slacker by; two sizes of what is no line in its size
_RESPONSES = (
    ({"lag": RESPONSE}, 0.0),
    ({"lag": 0.3 * RESPONSE}, -1.0),
    ({"dead_time": RESPONSE}, -0.1),
    ({"dead_time": 0.3 * RESPONSE}, -1.0),
    ({"stroke_time": 2.0 * RESPONSE}, 0.0),
    ({"link_play": STATIC}, -0.2),
    ({"link_play": 0.4 * STATIC}, -1.0),
    ({"dead_zone": 0.5 * STATIC}, -0.2),
    ({"dead_zone": 0.2 * STATIC}, -1.0),
)


@dataclass(frozen=True)
class Nuisance:
    """Series that calibration may add to a channel, plain and whitened, and what multiples it may take."""

    plain: np.ndarray
    basis: np.ndarray
    triangle: np.ndarray
    low: np.ndarray
    high: np.ndarray
    law: object

    def left(self, change):
        """What calibration leaves of a change: its distance, and the rest in the channel's own unit."""
        white = self.law(change[:, None])[:, 0]
        taken = self.multiples(white)
        rest = white - self.basis @ (self.triangle @ taken)
        return float(rest @ rest), change - self.plain @ taken

    def distance(self, white):
        """Squared sum that calibration leaves of a whitened series."""
        rest = white - self.basis @ (self.triangle @ self.multiples(white))
        return float(rest @ rest)

    def multiples(self, white):
        """What calibration takes of each of its series."""
        scale = np.maximum(np.linalg.norm(self.triangle, axis=0), 1e-9)
        bounds = self.low * scale, self.high * scale
        found = lsq_linear(self.triangle / scale, self.basis.T @ white, bounds, method="bvls")
        return found.x / scale


def nuisance_of(scene, channel):
    """Nuisance of a channel of a scene, about the sound plant."""
    columns, low, high = _flow_series(scene) if channel == "flow" else _opening_series(scene)
    law = _flow_law(scene) if channel == "flow" else _opening_law(scene)
    rows = scene.recorded
    plain = np.column_stack([column[rows] for column in columns])
    white = law(plain)
    basis, triangle = np.linalg.qr(white)
    wide = np.maximum(np.array(high) - np.array(low), 1e-9)
    return Nuisance(plain, basis, triangle, np.array(low), np.array(low) + wide, law)


def _shifted(scene, **columns):
    table = scene.sound.copy()
    for name, step in columns.items():
        table[:, COLUMNS.index(name)] += step
    return table


def _opening_series(scene):
    base = scene.seen("opening", scene.sound)
    steps = [(_shifted(scene, **column), low, 1.0) for column, low in _RESPONSES]
    series = [scene.seen("opening", table) - base for table, _, _ in steps]
    low, high = [s[1] for s in steps], [s[2] for s in steps]
    return [*series, np.full_like(base, ZERO_X), ZERO_X * base], [*low, -1.0, -1.0], [*high, 1.0, 1.0]


def _flow_series(scene):
    plant, base = scene.plant, scene.seen("flow", scene.sound)
    sheet, sound = plant.sheet, plant.sound
    own = plant.trim[-1] / plant.written["kv_rated"] - 1.0
    fl = float(np.mean(plant.fl)) / plant.written["fl"] - 1.0
    steps = [
        (_shifted(scene, capacity=CAPACITY), -1.0 - own / CAPACITY, 1.0 - own / CAPACITY),
        (
            _shifted(scene, meter_bias=ZERO_FLOW * plant.span),
            *_left(sound["meter_bias"] / (ZERO_FLOW * plant.span)),
        ),
        (_shifted(scene, meter_lag=RESPONSE), -0.3, 1.0 - sound["meter_lag"] / RESPONSE),
        (_shifted(scene, meter_lag=0.4 * RESPONSE), -1.0, 1.0),
        (_shifted(scene, plug_play=STATIC), -0.2, 1.0),
        (_shifted(scene, plug_play=0.4 * STATIC), -1.0, 1.0),
        (_shifted(scene, plug_offset=ZERO_X), *_left(sound["plug_offset"] / ZERO_X)),
        (_shifted(scene, fl_factor=RECOVERY), *_left(fl / RECOVERY)),
        (_shifted(scene, p1_bias=ZERO_P), -1.0, 1.0),
    ]
    series = [scene.seen("flow", table) - base for table, _, _ in steps]
    low, high = [s[1] for s in steps], [s[2] for s in steps]
    grid = np.linspace(0.0, 1.0, plant.trim.size)
    phi = relative_capacity(sheet, grid)
    tolerance = TRIM * np.maximum(phi, 1e-2) ** -0.2
    used = (plant.trim / plant.trim[-1] - phi) / np.maximum(phi, 1e-6) / tolerance
    for place in _HATS[1:-1]:
        hat = np.clip(1.0 - np.abs(grid - place) * 7.0, 0.0, 1.0)
        trim = plant.trim * (1.0 + hat * tolerance)
        series.append(scene.flow(scene.sound, trim)[::A_SECOND] - base)
        taken = float(np.interp(place, grid, used))
        low.append(-1.0 - taken)
        high.append(1.0 - taken)
    # F_L about the middle of the travel, from one value all the way to as much of a fall as its own tolerance
    fall = (plant.fl[0] - plant.fl[-1]) / float(np.mean(plant.fl))
    falling = plant.fl * (1.0 + RECOVERY * (0.5 - np.linspace(0.0, 1.0, plant.fl.size)))
    series.append(scene.flow(scene.sound, fl=falling)[::A_SECOND] - base)
    low.append(-fall / RECOVERY)
    high.append(1.0 - fall / RECOVERY)
    if "p2" in scene.lacking:
        for column in _behind(scene, base):
            series.append(column)
            low.append(-1.0)
            high.append(1.0)
    if "opening" in scene.lacking:
        for column, least in _RESPONSES:
            series.append(scene.seen("flow", _shifted(scene, **column)) - base)
            low.append(least)
            high.append(1.0)
    return series, low, high


def _behind(scene, base):
    """Flow under another pressure of the tank behind the valve, and under another loss of the line to it."""
    drop = float(np.mean(scene.p1 - scene.p2))
    rise = np.repeat((base / scene.plant.span) ** 2, A_SECOND)[: scene.p2.size]
    columns = []
    for shift in (np.ones_like(rise), rise):
        other = copy(scene)
        # a tenth of the bound, so that nothing chokes and no drop turns round
        other.p2 = scene.p2 + 0.1 * BEHIND * drop * shift
        columns.append((other.seen("flow", scene.sound) - base) / 0.1)
    return columns


def _left(used):
    return min(-1.0 - used, 0.0), max(1.0 - used, 0.0)


def _opening_law(scene):
    opening = _read_opening(scene)
    return lambda columns: whiten_opening(columns, scene.plant.law, opening)


def _read_opening(scene):
    return scene.reading[::A_SECOND][scene.recorded]


def _flow_law(scene):
    plant, rows = scene.plant, scene.recorded
    flow = scene.seen("flow", scene.sound)[rows]
    step = scene.seen("flow", _shifted(scene, plug_offset=0.005))[rows]
    by_opening = np.abs(step - flow) / 0.005
    drop = np.maximum(scene.p1 - scene.p2, 1e3)[::A_SECOND][rows]
    by_drop = 0.5 * np.abs(flow) / drop
    if "p2" in scene.lacking:
        # what the unknown pressure does is noise to every explanation
        pressure = float(np.std(scene.p2[::A_SECOND][rows]))
        law = replace(plant.law, p_wandering=plant.law.p_wandering + pressure)
    else:
        law = plant.law
    lag, opening = plant.sound["meter_lag"], _read_opening(scene)
    return lambda columns: whiten_flow(columns, law, plant.span, flow, opening, by_opening, by_drop, lag)
