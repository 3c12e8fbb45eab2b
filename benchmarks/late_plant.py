# SPDX-License-Identifier: BSD-3-Clause
"""A small plant for events in the last rows of a recording; it shares no code with the simulations.

A motor valve lets water out of a tank into open air: dead time and slow motor, a trim that no sheet knows,
a meter with lag, noise, wander and steps, a level that wanders. The command goes by steps and ramps. In the
last 1 to 3 % of the rows the stem seizes, the valve slams shut, the passage is blocked, the meter fails at
zero or at its last value, or nothing happens.
"""

import numpy as np

#: What may happen at the end; the name that the diagnosis should give.
ENDS = {
    "healthy": None,
    "seized": "stuck_valve",
    "slammed": "stuck_valve",
    "blocked": "clogging",
    "meter_zero": "flow_meter_failure",
    "meter_held": "flow_meter_failure",
}
# an event is one to be found where it moves the flow by so much of its span, rms over the rows behind it
_SHOWS = 0.04


def record(kind, rows, seed):
    """A recording as columns, its sheet as a dict, and what happens in it.

    Parameters
    ----------
    kind : str
        Of `ENDS`.
    rows : int
        One a second.
    seed : int

    Returns
    -------
    columns : dict of ndarray
        ``t_s``, ``CV`` [1], ``F`` [cm3/s], ``H`` [cmH2O].
    sheet : dict
        As valve.toml holds it.
    truth : dict
        ``kind``, ``name``, and ``time`` [s from the first sample] of the first row in which it shows.
    """
    for attempt in range(200):
        rng = np.random.default_rng([seed, attempt])
        columns, shows, row = _drawn(kind, rows, rng)
        if kind == "healthy" or (shows[row:].any() and np.sqrt(np.mean(shows[row:] ** 2)) > _SHOWS):
            time = float(row + np.argmax(np.abs(shows[row:]) > 0.25 * _SHOWS)) if kind != "healthy" else None
            return columns, _sheet(), {"kind": kind, "name": ENDS[kind], "time": time}
    raise RuntimeError(f"no {kind} event shows with seed {seed}")


def _drawn(kind, rows, rng):
    command = _command(rows, rng)
    end = int(rows * (1.0 - rng.uniform(0.01, 0.03)))
    delay, full = int(rng.integers(0, 7)), rng.uniform(8.0, 60.0)
    sound = _stem(command, delay, full, rows)
    stem = sound.copy()
    if kind == "seized":
        stem[end:] = sound[end]
    if kind == "slammed":
        stem[end:] = np.maximum(sound[end] - np.arange(rows - end) / rng.uniform(1.0, 15.0), 0.0)
    head = 20.0 * np.exp(0.12 * _wander(rows, 0.15 * rows, rng))
    bend, rated = rng.uniform(0.6, 1.8), 10.0 ** rng.uniform(0.5, 3.0)

    def through(opening):
        return rated * opening**bend * np.sqrt(head / 20.0)

    flow = through(stem)
    if kind == "blocked":
        flow[end:] *= 1.0 - rng.uniform(0.3, 1.0) * np.minimum(
            np.arange(rows - end) / rng.uniform(1.0, 10.0), 1.0
        )
    lag = rng.uniform(0.5, 3.0)
    shown, sensible = _lagged(flow, lag), _lagged(through(sound), lag)
    span = sensible.max()
    if kind == "meter_zero":
        shown[end:] = 0.0
    if kind == "meter_held":
        shown[end:] = shown[end]
    noise = span * 10.0 ** rng.uniform(-2.7, -2.0)
    wander = span * rng.uniform(0.0, 0.008) * _wander(rows, rng.uniform(50.0, 400.0), rng)
    if kind.startswith("meter"):
        wander[end:] = 0.0
    read = shown + wander + noise * rng.standard_normal(rows)
    step = span * rng.choice([0.0, 0.002])
    read = np.round(read / step) * step if step else read
    level = head + 0.1 * rng.standard_normal(rows)
    columns = {"t_s": np.arange(rows, dtype=float), "CV": command, "F": np.maximum(read, 0.0), "H": level}
    return columns, (shown - sensible) / span, end


def _command(rows, rng):
    """Steps and ramps between a few levels that come back, as a schedule has them."""
    levels, command, now = rng.uniform(0.15, 0.9, rng.integers(3, 8)), [], rng.uniform(0.2, 0.8)
    hold = rng.uniform(0.006, 0.03) * rows
    while len(command) < rows:
        to, ramp = rng.choice(levels), int(rng.choice([1, 1, 20]))
        command += list(np.linspace(now, to, ramp + 1)[1:]) + [to] * int(rng.uniform(0.5, 1.5) * hold)
        now = to
    return np.array(command[:rows])


def _stem(command, delay, full, rows):
    """Stem of a motor valve: it answers `delay` rows late and takes `full` seconds for the full stroke."""
    stem, at = np.empty(rows), command[0]
    for k in range(rows):
        at += np.clip(command[max(k - delay, 0)] - at, -1.0 / full, 1.0 / full)
        stem[k] = at
    return stem


def _lagged(values, lag):
    keep, at, found = np.exp(-1.0 / lag), values[0], np.empty(len(values))
    for k, value in enumerate(values):
        at = keep * at + (1.0 - keep) * value
        found[k] = at
    return found


def _wander(rows, time, rng):
    keep = np.exp(-1.0 / time)
    steps, at, found = (
        rng.standard_normal(rows) * np.sqrt(1.0 - keep**2),
        rng.standard_normal(),
        np.empty(rows),
    )
    for k in range(rows):
        at = keep * at + steps[k]
        found[k] = at
    return found


def _sheet():
    return {
        "valve": {"tag": "late", "characteristic": "unknown"},
        "fluid": {"name": "water"},
        "simulation": {"physics": []},
        "recording": {
            "time": "t_s",
            "command": {"column": "CV", "unit": "1"},
            "flow": {"column": "F", "unit": "cm3/s"},
            "p1": {"column": "H", "unit": "cmH2O", "gauge": True},
            "p2": {"constant": 0.0, "unit": "cmH2O", "gauge": True},
        },
    }
