# SPDX-License-Identifier: BSD-3-Clause
"""Loops drawn at random, healthy and sticking, to set and to measure the alarms of `diagnose_loop`.

Everything runs at 1 s and is recorded every 10 s: a PI controller, a valve with friction in the form of
Choudhury (a stem that keeps moving until the command turns), a process (flow with a lag of seconds, pressure
with one of minutes, level that integrates), coloured and white noise, wander, set-point programmes, outside
oscillations and bad tuning. The operator that the diagnosis fits is of another form.
"""

from dataclasses import dataclass

import numba as nb
import numpy as np

KINDS = ("flow", "pressure", "level")
HEALTHY = ("quiet", "setpoint", "oscillation", "bad_tuning", "upsets", "curved", "small_play", "saw")


@dataclass(frozen=True, eq=False)
class DrawnLoop:
    """One drawn loop: the three recorded signals [fraction of span], and what was drawn."""

    command: np.ndarray
    process_value: np.ndarray
    setpoint: np.ndarray
    kind: str
    scene: str
    stick: float
    slip: float
    share: float
    """Stick band over the 1-99 % span of the command."""


@nb.njit(cache=True)
def _friction(command, position, state, stick, slip):
    """One step of a stem: `state` = (direction, last command, command where it stopped, moving)."""
    direction, last, stopped, moving = state
    move = command - last
    turned = 0.0
    if move > 0.0:
        turned = 1.0
    elif move < 0.0:
        turned = -1.0
    if turned != 0.0 and turned != direction:
        if moving > 0.0:
            stopped = last
            moving = 0.0
        direction = turned
    elif turned == 0.0:
        if moving > 0.0:
            stopped = last
        moving = 0.0
    half = 0.5 * (stick - slip)
    if moving > 0.0:
        position = command - direction * half
    else:
        gap = command - position
        if abs(gap) > half + slip:
            direction = 1.0 if gap > 0.0 else -1.0
            position = command - direction * half
            moving = 1.0
    return position, (direction, command, stopped, moving)


@nb.njit(cache=True)
def _run(
    setpoint, upset, load, noise, gain, reset, stick, slip, bend, lag, integrates, dead, command_0, filt
):
    n = len(setpoint)
    command = np.empty(n)
    value = np.empty(n)
    position = command_0
    state = (1.0, command_0, command_0, 0.0)
    y = setpoint[0]
    seen = y
    last_error = 0.0
    out = command_0
    held = np.full(dead + 1, command_0)
    for k in range(n):
        seen += filt * (y + noise[k] - seen)
        error = setpoint[k] - seen
        out += gain * (error - last_error + error / reset)
        last_error = error
        out = min(1.0, max(0.0, out))
        position, state = _friction(out, position, state, stick, slip)
        for i in range(dead):
            held[i] = held[i + 1]
        held[dead] = position
        stem = held[0]
        drive = stem - command_0 + bend * (stem - command_0) ** 2
        if integrates:
            y += (drive - load[k]) / lag
        else:
            y += (setpoint[0] + drive - load[k] - y) / lag
        y += upset[k]
        command[k] = out
        value[k] = seen
    return command, value


def _ornstein(n, time, size, rng):
    from scipy.signal import lfilter

    keep = np.exp(-1.0 / time)
    drawn = size * np.sqrt(1.0 - keep**2) * rng.standard_normal(n)
    drawn[0] = size * rng.standard_normal()
    return lfilter([1.0], [1.0, -keep], drawn)


def draw_loop(random_state, kind="flow", scene="quiet", sticking=False, rows=750, size=None):
    """Draw one loop of a kind and a scene; `sticking` gives its valve friction of the size of its movement.

    Parameters
    ----------
    random_state : int
    kind : {"flow", "pressure", "level"}
    scene : str
        One of `HEALTHY`: what moves the loop.
    sticking : bool, default=False
    rows : int, default=750
        Rows, 10 s apart.
    size : float or None
        Amplitude of what moves the loop [fraction of span]; drawn by default.

    Returns
    -------
    drawn : DrawnLoop
    """
    rng = np.random.default_rng(random_state)
    n = 10 * rows + 600
    time = np.arange(n)
    size = float(np.exp(rng.uniform(np.log(0.002), np.log(0.03)))) if size is None else size
    if kind == "flow":
        lag, gain, reset = rng.uniform(1.5, 12), rng.uniform(0.15, 0.8), rng.uniform(6, 40)
    elif kind == "pressure":
        lag = rng.uniform(20, 200)
        gain, reset = rng.uniform(0.5, 3), lag * rng.uniform(0.5, 2)
    else:
        lag = np.exp(rng.uniform(np.log(200), np.log(2000)))
        closed = lag / rng.uniform(1.5, 10)
        gain, reset = lag / closed, 4 * closed * rng.uniform(0.6, 2)
    dead = int(rng.integers(0, 4))
    load = _ornstein(n, np.exp(rng.uniform(np.log(60), np.log(3000))), size, rng)
    setpoint = np.full(n, 0.5)
    if scene == "setpoint" or (sticking and rng.random() < 0.3):
        if rng.random() < 0.5:
            hold = int(rng.integers(60, 1500))
            setpoint = 0.5 + np.repeat(size * 2 * rng.standard_normal(n // hold + 1), hold)[:n]
        else:
            setpoint = 0.5 + _ornstein(n, rng.uniform(30, 1500), 3 * size, rng)
    if scene in ("oscillation", "saw"):
        period = np.exp(rng.uniform(np.log(60), np.log(2000)))
        phase = 2 * np.pi * (time / period + np.cumsum(0.003 * rng.standard_normal(n)) / np.sqrt(period))
        wave = np.sin(phase)
        if scene == "saw":
            wave = np.sign(wave) if rng.random() < 0.5 else 2 / np.pi * np.arcsin(wave)
        load = 0.3 * load + size * rng.uniform(0.5, 4) * wave
    if scene == "upsets":
        jumps = (rng.random(n) < 1.0 / rng.uniform(200, 2000)) * size * rng.standard_t(3, n)
        load = 0.3 * load + np.cumsum(jumps)
    if scene == "bad_tuning":
        if kind == "flow":
            reset = max(2.5, reset / rng.uniform(3, 8))
            dead += int(rng.integers(2, 6))
            gain = gain * rng.uniform(0.5, 1.0)
        elif kind == "pressure":
            reset, dead = reset / 4, int(0.1 * lag) + dead
        else:
            reset = reset / rng.uniform(6, 20)
    bend = rng.uniform(-4, 4) if scene == "curved" else rng.uniform(-1.5, 1.5)
    if scene == "curved":
        setpoint = setpoint + _ornstein(n, rng.uniform(60, 1500), 0.03, rng)
    white = size * np.exp(rng.uniform(np.log(0.01), np.log(1.0)))
    noise = white * rng.standard_normal(n)
    noise += _ornstein(n, rng.uniform(3, 60), size * rng.uniform(0, 0.5), rng)
    if kind != "flow":
        noise *= 0.2
    stick = slip = 0.0
    if sticking:
        stick = size * rng.uniform(1.0, 5.0)
        slip = stick * rng.uniform(0.0, 1.0)
    elif scene == "small_play":
        stick = size * rng.uniform(0.05, 0.4)
        slip = stick * rng.uniform(0.0, 0.5)
    upset = np.zeros(n)
    command, value = _run(
        setpoint,
        upset,
        load,
        noise,
        gain,
        reset,
        stick,
        slip,
        bend,
        max(lag, 1.01),
        kind == "level",
        dead,
        rng.uniform(0.3, 0.7),
        rng.uniform(0.15, 1.0),
    )
    kept = slice(600, None, 10)
    span = float(np.ptp(np.quantile(command[kept], [0.01, 0.99])))
    share = stick / span if span > 0 else np.inf
    digits = int(rng.integers(4, 7))
    return DrawnLoop(
        np.round(command[kept], digits),
        np.round(value[kept], digits),
        np.round(setpoint[kept], 6),
        kind,
        scene,
        stick,
        slip,
        share,
    )
