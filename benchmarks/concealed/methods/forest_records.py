# SPDX-License-Identifier: BSD-3-Clause
"""Recordings made by the package's own simulation, to train a classifier on.

Sheet, calibration, command, pressures, temperature, effect, size, onset and noise (white, quickly correlated,
wandering, quantised) are drawn. What is drawn shares its equations with the simulation that the features come
from: that is the point, for the table shows what is left of such a classifier on another plant.
"""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from sklvalve.mechanism import relative_capacity
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.recording import Recording, Valve
from sklvalve.simulation.parameters import ParameterVector

_ROWS = (1200, 2400)
# a drawn effect changes flow or opening by such shares of the span, rms where it acts
_SIZES = (0.006, 0.12)
_ATTEMPTS = 12


def candidates_for_training():
    """Effects by name whose signals a water valve driven by air can show, each with its forms."""
    found: dict = {}
    for effect in CATALOGUE:
        if not getattr(effect, "motor", False) and effect.name not in ("gas_expansion",):
            found.setdefault(effect.name, []).append(effect)
    return found


def draw_recording(rng, forms=()):
    """One recording with one of the forms of an effect in it, or with nothing.

    Parameters
    ----------
    rng : numpy Generator
    forms : sequence of Effect, default=()

    Returns
    -------
    recording : Recording or None
        None where the drawn plant cannot show the effect.
    """
    surroundings = _surroundings(rng)
    bench = prepared_problem(surroundings)
    values = _calibration(rng, bench)
    usable = [
        e
        for e in forms
        if not bench.plain.lacks(e) and all(r in surroundings for r in e.needs) and e.possible(bench.plain)
    ]
    if not forms:
        return _recorded(rng, surroundings, *_signals(bench.plain, values))
    healthy = _signals(bench.plain, values)
    for _ in range(_ATTEMPTS if usable else 0):
        effect = usable[rng.integers(len(usable))]
        chain = bench.chain((Term(effect, _onset(rng, bench.plain, effect)),))
        own = _drawn_size(rng, effect, chain)
        flow, opening = _signals(chain, values | own)
        if not (np.isfinite(flow).all() and np.isfinite(opening).all()):
            continue
        change = max(_size(flow - healthy[0]) / np.max(np.abs(healthy[0])), _size(opening - healthy[1]))
        if _SIZES[0] < change < _SIZES[1]:
            return _recorded(rng, surroundings, flow, opening)
    return None


def _signals(chain, values):
    return chain.flow(values, chain.drive_of_free_run(values)), chain.opening(values)


def _size(gap):
    gap = np.abs(gap)
    acting = gap > 0.25 * np.quantile(gap, 0.99)
    return float(np.sqrt(np.mean(gap[acting] ** 2))) if acting.any() else 0.0


def _onset(rng, chain, effect):
    if not effect.may_begin or rng.uniform() < 0.4:
        return None
    return float(chain.clock[int(rng.uniform(0.15, 0.75) * len(chain.clock))])


def _drawn_size(rng, effect, chain):
    values, many = {}, max(len(q.starts) for q in effect.quantities(chain))
    attempt = int(rng.integers(many))
    factor = float(np.exp(rng.normal(0.0, 0.6)))
    for i, q in enumerate(effect.quantities(chain)):
        start = q.starts[min(attempt, len(q.starts) - 1)]
        values[f"{effect.key}.{q.name}"] = float(np.clip(start * (factor if i == 0 else 1.0), q.low, q.high))
    return values


def _calibration(rng, bench):
    """Values of what a sheet leaves open, drawn from their priors."""
    parameters = {p.name: p for c in bench.channels for p in bench.calibration((c,))}
    vector = ParameterVector(parameters.values())
    spread = np.array([p.spread if p.spread is not None else 0.0 for p in parameters.values()])
    # of a response priors are wide; a sound valve answers within a second or two
    spread = np.minimum(spread, 0.7)
    return vector.values(
        np.clip(vector.pack({}) + spread * rng.standard_normal(len(vector)), vector.low, vector.high)
    )


def _sheet(rng):
    return {
        "valve": {
            "kv_rated": float(rng.choice([10.0, 16.0, 25.0, 40.0, 63.0, 100.0])),
            "characteristic": str(rng.choice(["equal_percentage"] * 3 + ["linear"])),
            "rangeability": float(rng.choice([30.0, 40.0, 50.0])),
            "shutoff": 0.02,
            "fl": float(rng.choice([0.8, 0.85, 0.9, 0.95])),
            "fd": 0.46,
            "nominal_size": 50.0,
        },
        "fluid": {"name": "water"},
        "actuator": {
            "fail": str(rng.choice(["closed", "closed", "open"])),
            "supply_pressure": float(rng.choice([280.0, 340.0, 400.0])),
            "spring_range": [20.0, 100.0],
            "positioner": True,
        },
        "simulation": {"physics": ["choked_flow"]},
    }


def _surroundings(rng):
    """Recording of command, pressures and temperature; opening and flow are stand-ins."""
    sheet, n = _sheet(rng), int(rng.integers(*_ROWS))
    valve = Valve.from_dict(sheet)
    command = _command(rng, n)
    kv = sheet["valve"]["kv_rated"] * relative_capacity(
        command,
        valve.characteristic,
        rangeability=valve.rangeability,
        shutoff=0.02,
        warn=False,
    )
    pump = 1e5 * (rng.uniform(5.0, 11.0) + 0.25 * wander(rng, n, 400.0)) + _jumps(rng, n, 6e4)
    tank = 1e5 * (rng.uniform(1.3, 2.5) + 0.1 * wander(rng, n, 400.0))
    # pump and line give way to what flows
    open_share = (kv / sheet["valve"]["kv_rated"]) ** 2
    give = rng.uniform(0.3, 1.5) * open_share
    drop = np.maximum(pump - tank, 1e5)
    p1 = pump - drop * 0.5 * give / (1.0 + give)
    p2 = tank + drop * 0.4 * give / (1.0 + give)
    p2 = np.minimum(p2, p1 - 2e4)
    frame = {
        "time": np.arange(float(n)),
        "command": command,
        "opening": command,
        "p1": p1,
        "p2": p2,
        "temperature": 293.15 + rng.uniform(0.0, 40.0) + rng.uniform(0.5, 8.0) * wander(rng, n, 900.0),
        "flow": kv / 3600.0 * np.sqrt((p1 - p2) / 1e5),
    }
    return replace(Recording.from_frame(frame, None), valve=replace(valve, roles={}, time="time"))


def _command(rng, n):
    """Over most of the travel, about a working point as a regulator has it, or the one after the other."""
    kind = rng.integers(3)
    wide = _levels(rng, n, 0.05, 0.98, (20.0, 160.0), (1.0, 60.0))
    point, reach = rng.uniform(0.3, 0.8), rng.uniform(0.03, 0.2)
    closed = _levels(rng, n, point - reach, point + reach, (60.0, 400.0), (2.0, 30.0))
    closed = closed + 0.01 * wander(rng, n, 20.0) + 0.02 * wander(rng, n, 300.0)
    if kind == 2:
        return np.clip(np.where(np.arange(n) < n // 2, wide, closed), 0.0, 1.0)
    return np.clip(wide if kind == 0 else closed, 0.0, 1.0)


def _levels(rng, n, low, high, dwell, ramp):
    times, values = [0.0], [rng.uniform(low, high)]
    while times[-1] < n:
        times.append(times[-1] + rng.uniform(*dwell))
        values.append(values[-1])
        times.append(times[-1] + rng.uniform(*ramp))
        values.append(rng.uniform(low, high))
    return np.interp(np.arange(n), times, values)


def _jumps(rng, n, size):
    at = np.sort(rng.uniform(0.0, n, rng.integers(0, 5)))
    return size * np.sum([rng.normal() * (np.arange(n) > t) for t in at] or [np.zeros(n)], axis=0)


def wander(rng, n, seconds):
    """Ornstein-Uhlenbeck series of unit variance, one sample a second."""
    keep = np.exp(-1.0 / seconds)
    kicks = np.sqrt(1.0 - keep**2) * rng.standard_normal(n)
    kicks[0] = rng.standard_normal()
    return lfilter([1.0], [1.0, -keep], kicks)


def _recorded(rng, surroundings, flow, opening):
    """Recording of signals as sensors show them."""
    n, loud = len(flow), float(np.exp(rng.uniform(np.log(0.6), np.log(2.5))))
    span = float(np.max(np.abs(flow)))

    def noise(size):
        slow = wander(rng, n, rng.uniform(150.0, 600.0))
        quick = wander(rng, n, rng.uniform(3.0, 15.0))
        shares = rng.uniform(0.0, 0.6, 2)
        return loud * size * (rng.standard_normal(n) + shares[0] * quick + shares[1] * slow)

    def rounded(values, step):
        return np.round(values / step) * step

    signals = dict(surroundings.signals)
    signals["flow"] = rounded(flow + span * noise(0.003), 1e-4 * span)
    signals["opening"] = rounded(opening + noise(0.0013), 5e-4)
    for role in ("p1", "p2"):
        signals[role] = rounded(signals[role] + 3e2 * rng.standard_normal(n), 1e2)
    return replace(surroundings, signals=signals)
