# SPDX-License-Identifier: BSD-3-Clause
"""Loops drawn at random, healthy and sticking, to set and to measure the alarms of `diagnose_loop`.

Everything runs in steps much finer than the rows: a PI controller, a valve with friction, a process (flow
with a short lag, pressure with a long one, level that integrates), coloured and white noise, wander,
set-point programmes, outside oscillations, a supply or a gain that drifts, and bad tuning. A first run at one
time scale measures the period of the loop; the second is stretched so that a period has 5 to 500 rows, of 0.2
to 60 s, both drawn log-uniformly. The friction has two forms, neither that of the operator which the
diagnosis fits: Choudhury's (a stem keeps moving until the command turns), and a stem with a speed of its own
that is held by a static friction and braked by a smaller dynamic one.
"""

from dataclasses import dataclass, replace

import numba as nb
import numpy as np

KINDS = ("flow", "pressure", "level")
HEALTHY = (
    "quiet",
    "setpoint",
    "oscillation",
    "bad_tuning",
    "upsets",
    "curved",
    "small_play",
    "saw",
    "drift",
)
FORMS = ("choudhury", "sliding")
_PILOT = 12000  # steps of the first run


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
    sample_time: float = 10.0
    """[s]"""
    rows_a_period: float = np.nan
    """Aimed at; the loop may swing otherwise."""
    form: str = "choudhury"


@dataclass(frozen=True, eq=False)
class Plant:
    """What no user knows of a drawn loop: its signals in every step, and the plant that made them.

    Parameters
    ----------
    command, value, factor : ndarray of shape (n,)
        In every step; `factor` is the gain that drifts.
    process : dict
        `bend`, `lag` [steps], `integrates`, `dead` [steps], `middle` of the command, `first` value, and
        `follow`, of the filter behind the sensor.
    friction : dict
        `slides`, `pace`, `stick`, `slip`.
    noise : dict
        Of what disturbs the value: `load`, `colour`: (time [steps], size); `white`: size; `wave`: (form,
        period [steps], size, spread of its phase a step [rad]) or None; `jumps`: spread a step of what jumps.
    steps : int, default=1
        To a row.
    """

    command: np.ndarray
    value: np.ndarray
    factor: np.ndarray
    process: dict
    friction: dict
    noise: dict
    steps: int = 1


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
def _sliding(command, position, moving, stick, slip, pace):
    """One step of a stem that slides at a pace of its own until the dynamic friction holds it."""
    static, dynamic = 0.5 * (stick + slip), 0.5 * (stick - slip)
    gap = command - position
    if moving == 0.0 and abs(gap) > static:
        moving = 1.0 if gap > 0.0 else -1.0
    if moving != 0.0:
        left = gap * moving - dynamic
        if left <= 0.0:
            moving = 0.0
        else:
            position += moving * pace * left
            if pace * left < 0.002 * (stick + 1e-9):
                moving = 0.0
    return position, moving


@nb.njit(cache=True)
def _run(
    setpoint,
    factor,
    load,
    noise,
    gain,
    reset,
    stick,
    slip,
    bend,
    lag,
    integrates,
    dead,
    command_0,
    filt,
    slides,
    pace,
):
    n = len(setpoint)
    command = np.empty(n)
    value = np.empty(n)
    position, sliding = command_0, 0.0
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
        if stick <= 0.0:
            position = out
        elif slides:
            position, sliding = _sliding(out, position, sliding, stick, slip, pace)
        else:
            position, state = _friction(out, position, state, stick, slip)
        for i in range(dead):
            held[i] = held[i + 1]
        held[dead] = position
        stem = held[0]
        drive = factor[k] * (stem - command_0 + bend * (stem - command_0) ** 2 + 0.5) - 0.5
        if integrates:
            y += (drive - load[k]) / lag
        else:
            y += (setpoint[0] + drive - load[k] - y) / lag
        command[k] = out
        value[k] = seen
    return command, value


def _ornstein(n, time, size, rng):
    from scipy.signal import lfilter

    keep = np.exp(-1.0 / time)
    drawn = size * np.sqrt(1.0 - keep**2) * rng.standard_normal(n)
    drawn[0] = size * rng.standard_normal()
    return lfilter([1.0], [1.0, -keep], drawn)


def _period(command):
    """Period of the strongest swing [rows], of frequency times power."""
    n = len(command)
    time = np.arange(n) / n
    swings = command - np.polyval(np.polyfit(time, command, 2), time)
    power = np.abs(np.fft.rfft(swings * np.hanning(n))) ** 2
    power = np.convolve(power, np.ones(3) / 3.0, mode="same") * np.arange(len(power))
    power[:4] = 0.0
    # a command that stands still has no period
    return n / float(np.argmax(power) or 100)


def draw_loop(random_state, kind="flow", scene="quiet", sticking=False, form=None):
    """Draw one loop of a kind and a scene; `sticking` gives its valve friction of the size of its movement.

    Parameters
    ----------
    random_state : int
    kind : {"flow", "pressure", "level"}
    scene : str
        One of `HEALTHY`: what moves the loop.
    sticking : bool, default=False
    form : {"choudhury", "sliding"}, optional
        Of the friction; drawn by default.

    Returns
    -------
    drawn : DrawnLoop
    """
    return draw_plant(random_state, kind, scene, sticking, form)[0]


def draw_plant(random_state, kind="flow", scene="quiet", sticking=False, form=None):
    """The loop that `draw_loop` draws, and the plant behind it; parameters as there.

    Returns
    -------
    drawn : DrawnLoop
    plant : Plant
    """
    rng = np.random.default_rng([random_state, KINDS.index(kind), HEALTHY.index(scene), int(sticking)])
    rows_a_period = float(np.exp(rng.uniform(np.log(5.0), np.log(500.0))))
    sample_time = round(float(np.exp(rng.uniform(np.log(0.2), np.log(60.0)))), 2)
    periods = float(np.exp(rng.uniform(np.log(8.0), np.log(60.0))))
    rows = int(np.clip(rows_a_period * periods, 400, 4000))
    drawn_form = FORMS[int(rng.random() < 0.4)]
    form = drawn_form if form is None else form
    seed = int(rng.integers(2**31))
    pilot, _ = _simulated(np.random.default_rng(seed), kind, scene, sticking, form, _PILOT, 1.0)
    period = _period(pilot.command)
    # steps of the second run: many to a row, and enough to a period
    steps = max(1, round(max(2.0 * rows_a_period, 150.0) / rows_a_period))
    stretch = steps * rows_a_period / period
    warm = int(4 * period * stretch)
    whole, setpoint = _simulated(
        np.random.default_rng(seed), kind, scene, sticking, form, warm + steps * rows, stretch
    )
    plant = replace(
        whole, command=whole.command[warm:], value=whole.value[warm:], factor=whole.factor[warm:], steps=steps
    )
    command, value, setpoint = plant.command[::steps], plant.value[::steps], setpoint[warm::steps]
    stick, slip = plant.friction["stick"], plant.friction["slip"]
    span = float(np.ptp(np.quantile(command, [0.01, 0.99])))
    digits = int(rng.integers(4, 7))
    drawn = DrawnLoop(
        np.round(command, digits),
        np.round(value, digits),
        np.round(setpoint, 6),
        kind,
        scene,
        stick,
        slip,
        stick / span if span > 0 else np.inf,
        sample_time,
        rows_a_period,
        form,
    )
    return drawn, plant


def _simulated(rng, kind, scene, sticking, form, n, stretch):
    """The plant with command and value in every step, and the set-point; all times are stretched."""
    time = np.arange(n) / stretch

    def wander(tau, size):
        return _ornstein(n, tau * stretch, size, rng)

    size = float(np.exp(rng.uniform(np.log(0.002), np.log(0.03))))
    if kind == "flow":
        lag, gain, reset = rng.uniform(1.5, 12), rng.uniform(0.15, 0.8), rng.uniform(6, 40)
    elif kind == "pressure":
        lag = rng.uniform(20, 200)
        gain, reset = rng.uniform(0.5, 3), lag * rng.uniform(0.5, 2)
    else:
        lag = np.exp(rng.uniform(np.log(200), np.log(2000)))
        closed = lag / rng.uniform(1.5, 10)
        gain, reset = lag / closed, 4 * closed * rng.uniform(0.6, 2)
    dead = rng.uniform(0, 4)
    draws = {name: rng.uniform() for name in ("setpoint", "hold", "shape", "filter", "band", "jump", "pace")}
    slow = np.exp(rng.uniform(np.log(60), np.log(3000)))
    period = np.exp(rng.uniform(np.log(60), np.log(2000)))
    wave_size, upset_time = rng.uniform(0.5, 4), rng.uniform(200, 2000)
    if scene == "bad_tuning":
        if kind == "flow":
            reset = max(2.5, reset / rng.uniform(3, 8))
            dead += rng.uniform(2, 6)
            gain = gain * rng.uniform(0.5, 1.0)
        elif kind == "pressure":
            reset, dead = reset / 4, 0.1 * lag + dead
        else:
            reset = reset / rng.uniform(6, 20)
    bend = rng.uniform(-4, 4) if scene == "curved" else rng.uniform(-1.5, 1.5)
    white = size * np.exp(rng.uniform(np.log(0.01), np.log(1.0)))
    noise_time, noise_size, command_0 = rng.uniform(3, 60), size * rng.uniform(0, 0.5), rng.uniform(0.3, 0.7)
    load, load_size, wave, jumped = wander(slow, size), size, None, 0.0
    setpoint = np.full(n, 0.5)
    if scene == "setpoint" or (sticking and draws["setpoint"] < 0.3):
        if draws["shape"] < 0.5:
            hold = max(1, int((60 + 1440 * draws["hold"]) * stretch))
            setpoint = 0.5 + np.repeat(size * 2 * rng.standard_normal(n // hold + 1), hold)[:n]
        else:
            setpoint = 0.5 + wander(30 + 1470 * draws["hold"], 3 * size)
    if scene in ("oscillation", "saw"):
        walk = np.cumsum(0.003 * rng.standard_normal(n)) / np.sqrt(period * stretch)
        course, shape = np.sin(2 * np.pi * (time / period + walk)), "sine"
        if scene == "saw":
            shape = "square" if draws["shape"] < 0.5 else "triangle"
            course = np.sign(course) if shape == "square" else 2 / np.pi * np.arcsin(course)
        load, load_size = 0.3 * load + size * wave_size * course, 0.3 * size
        wave = shape, period * stretch, size * wave_size, 0.006 * np.pi / np.sqrt(period * stretch)
    if scene == "upsets":
        jumps = (rng.random(n) < 1.0 / (upset_time * stretch)) * size * rng.standard_t(3, n)
        load, load_size = 0.3 * load + np.cumsum(jumps), 0.3 * size
        jumped = size * np.sqrt(3.0 / (upset_time * stretch))  # the variance of t with three degrees is 3
    factor = np.ones(n)
    if scene == "drift":
        # a supply or a gain that changes slowly: a ramp, a bend, a wander, over the whole record
        shape = np.linspace(-1.0, 1.0, n)
        course = (shape, shape**2, np.sin(np.pi * shape * 1.5))[int(3 * draws["shape"])]
        factor = 1.0 + (0.02 + 0.1 * draws["hold"]) * course + wander(n / (8.0 * stretch), 0.01)
        small = 0.02 + 0.5 * draws["band"]
        load, load_size = small * load, small * size
    if scene == "curved":
        setpoint = setpoint + wander(60 + 1440 * draws["hold"], 0.03)
    noise = white * rng.standard_normal(n) + wander(noise_time, noise_size)
    if kind != "flow":
        noise *= 0.2
    stick = slip = 0.0
    if sticking:
        stick = size * (1.0 + 4.0 * draws["band"])
        slip = stick * draws["jump"]
    elif scene == "small_play":
        stick = size * (0.05 + 0.35 * draws["band"])
        slip = stick * 0.5 * draws["jump"]
    known = 1.0 if kind == "flow" else 0.2
    process = {
        "bend": bend, "lag": max(lag * stretch, 1.01), "integrates": kind == "level",
        "dead": int(dead * stretch), "middle": command_0, "first": float(setpoint[0]),
        "follow": 1.0 - (0.85 * (1.0 - draws["filter"])) ** (1.0 / stretch),
    }  # fmt: skip
    friction = {
        "slides": form == "sliding", "pace": 1.0 - np.exp(-(0.5 + 1.5 * draws["pace"]) / stretch),
        "stick": stick, "slip": slip,
    }  # fmt: skip
    law = {
        "load": (slow * stretch, load_size), "colour": (noise_time * stretch, known * noise_size),
        "white": known * white, "wave": wave, "jumps": jumped,
    }  # fmt: skip
    command, value = _run(
        setpoint,
        factor,
        load,
        noise,
        gain,
        reset * stretch,
        stick,
        slip,
        bend,
        process["lag"],
        process["integrates"],
        process["dead"],
        command_0,
        process["follow"],
        friction["slides"],
        friction["pace"],
    )
    return Plant(command, value, factor, process, friction, law), setpoint
