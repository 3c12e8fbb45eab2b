# SPDX-License-Identifier: BSD-3-Clause
"""Effects that no catalogue of valve faults holds."""

import numpy as np
from scipy.signal import lfilter

from benchmarks.concealed.plant.effects.base import Effect, rated


def _bow(columns, size, active, plant):
    """The stem bows while body and bonnet differ in temperature, and pulls the plug with it."""
    celsius, pole = plant.weather[:, 2], np.exp(-1.0 / plant.share(300.0, 900.0))
    body = lfilter([1.0 - pole], [1.0, -pole], celsius, zi=[pole * celsius[0]])[0]
    bow = celsius - body
    columns["plug_offset"] += size * bow / max(np.sqrt(np.mean(bow**2)), 1e-9) * active


def _pulses(plant, quiet, busy, shape):
    """Events at drawn moments: `quiet` and `busy` are ranges of seconds, `shape` is over an event, 0 to 1."""
    rng, n = plant.dice(), plant.n_all
    out, t = np.zeros(n), int(rng.uniform(*quiet))
    while t < n:
        length = max(int(rng.uniform(*busy)), 2)
        stop = min(t + length, n)
        out[t:stop] = rng.uniform(0.6, 1.4) * shape(np.arange(stop - t) / length)
        t = stop + int(rng.uniform(*quiet))
    return out


def _deposits(columns, size, active, plant):
    """Ice or hydrate grows in the trim, and is washed off at once, again and again."""
    grown = _pulses(plant, (60.0, 300.0), (60.0, 300.0), lambda u: u**0.7)
    columns["capacity"] *= np.maximum(1.0 - size * grown * active, 0.1)


def _slugs(columns, size, active, plant):
    """Slugs of air come through, a few seconds each."""
    slugs = _pulses(plant, (15.0, 120.0), (4.0, 25.0), lambda u: np.sin(np.pi * u))
    columns["gas_share"] += np.minimum(size * slugs, 0.6) * active


def _rotation(columns, size, active, plant):
    """A plug turns in its cage as the flow takes it, and its ports pass more or less."""
    turns = np.cumsum(np.abs(plant.dice().standard_normal(plant.n_all))) / plant.share(120.0, 500.0)
    columns["capacity"] *= 1.0 + size * np.sin(turns) * active


def _windup(columns, size, active, plant):
    """The positioner's firmware winds its own integrator up, and lets it go."""
    columns["wander_in"] += size * _pulses(plant, (40.0, 200.0), (40.0, 160.0), lambda u: u) * active


def _hum(columns, size, active, plant):
    """The noise of the throttled jet reaches an ultrasonic meter, which then loses pulses."""
    columns["hum"] += size * active


def _check_valve(columns, size, active, plant):
    """A check valve behind lets flow back past the meter, when the pressure behind it is high."""
    columns["back_kv"] += size * rated(plant) * active
    columns["back_from"][:] = np.quantile(plant.weather[:, 1], 0.5)


def _beat(columns, size, active, plant):
    """Strokes of a pump, seen once a second, beat slowly."""
    t = np.arange(plant.n_all)
    period = plant.share(40.0, 300.0)
    slow = 1.0 + 0.5 * np.sin(2.0 * np.pi * t / plant.share(900.0, 2000.0))
    columns["beat"] += size * slow * np.sin(2.0 * np.pi * t / period) * active


EFFECTS = (
    Effect("thermal_bow", None, "valve", _bow, 0.15),
    Effect("deposit_pulses", None, "valve", _deposits, 0.6),
    Effect("air_slugs", None, "line", _slugs, 0.5),
    Effect("trim_rotation", None, "valve", _rotation, 0.3),
    Effect("firmware_windup", None, "actuator", _windup, 0.2),
    Effect("meter_hum", None, "measurement", _hum, 1.5),
    Effect("check_valve", None, "line", _check_valve, 0.3, "kv_rated"),
    Effect("pump_beat", None, "line", _beat, 0.3),
)
