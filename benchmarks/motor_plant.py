# SPDX-License-Identifier: BSD-3-Clause
"""Records of a motor valve, simulated by itself: nothing here is shared with the package's simulation.

    python benchmarks/motor_plant.py [MANY]
    python benchmarks/motor_plant.py [MANY] --history

The motor is a state machine on steps of 50 ms: it waits a dead time, runs at one speed, stops within a dead
band. Behind its gear there may be play, and the plug follows its far side. Water flows from a head that
wanders through the plug's capacity. Half of the records know only command, pressures and flow; of each sound
motor there is one with play of the same draw. Printed is what is found.

With ``--history`` the first half of a record is the history of the second. Of each motor there are three: one
sound, one with play in both halves, which is no change, and one that has play in the second half alone.
"""

import argparse
import os
import time

import numpy as np

# seconds of one step of the simulation, and between rows
_STEP, _ROW = 0.05, 1.0


def motor_record(seed, *, play=0.0, with_opening=False, rows=2000, declared=False):
    """One record: frame of signals by role in SI, sheet, and what was drawn.

    Parameters
    ----------
    seed : int
    play : float, default=0.0
        Whole gap between gear and plug [1 = travel].
    with_opening : bool, default=False
        Whether the position of the gear is recorded.
    rows : int, default=2000
    declared : bool, default=False
        Whether the sheet says the stroke time and the dead time.

    Returns
    -------
    frame, sheet, truth : dict
    """
    rng = np.random.default_rng(seed)
    stroke, dead = rng.uniform(15.0, 90.0), rng.choice([0.0, 0.5, 2.0, 5.0])
    band, ratio = rng.uniform(0.001, 0.004), rng.uniform(0.9, 1.1)
    command = _program(rng, rows)
    gear = _motor(np.repeat(command, round(_ROW / _STEP)), stroke, dead, band, ratio)
    plug = _far_side(gear, play, rng.uniform(-1.0, 1.0))
    every = slice(round(_ROW / _STEP) - 1, None, round(_ROW / _STEP))
    gear, plug = gear[every], plug[every]
    p1 = 3e5 + 2e4 * _wander(rng, rows)
    capacity = np.clip(plug, 0.0, 1.0) ** rng.uniform(1.0, 2.0) * rng.uniform(5.0, 40.0)
    flow = capacity * np.sqrt((p1 - 101_325.0) / 1e5) / 3600.0
    lag = rng.uniform(0.3, 1.5)
    flow = _lagged(flow, lag)
    flow += np.max(flow) * (0.003 * rng.standard_normal(rows) + 0.001 * _wander(rng, rows))
    frame = {"time": _ROW * np.arange(rows), "command": command, "p1": p1 + 100.0 * rng.standard_normal(rows)}
    frame |= {"p2": np.full(rows, 101_325.0), "flow": flow}
    if with_opening:
        frame["opening"] = gear + 0.0005 * rng.standard_normal(rows)
    sheet = {"valve": {"characteristic": "unknown"}, "fluid": {"name": "water"}}
    if declared:
        sheet["actuator"] = {"kind": "electric", "stroke_time": stroke, "dead_time": float(dead)}
    return frame, sheet, {"stroke": stroke, "dead": float(dead), "play": play}


def _program(rng, rows):
    """Steps between a few openings, some ramps, and turns before the motor has arrived."""
    command, at = np.empty(rows), rng.uniform(0.2, 0.7)
    levels = np.sort(rng.uniform(0.1, 0.9, 6))
    k = 0
    while k < rows:
        to, ramp = rng.choice(levels), int(rng.choice([1, 1, 1, 40]))
        hold = int(rng.choice([15, 60, 120, 200]))
        path = np.concatenate([np.linspace(at, to, ramp + 1)[1:], np.full(hold, to)])[: rows - k]
        command[k : k + len(path)] = path
        at, k = to, k + len(path)
    return command


def _motor(wanted, stroke, dead, band, ratio):
    """Position of a motor that waits, runs at its speed and stops where it is near enough."""
    late = round(dead / _STEP)
    wanted = np.concatenate([np.full(late, wanted[0]), wanted])[: len(wanted)]
    at, running, out = wanted[0], False, np.empty(len(wanted))
    for k, target in enumerate(wanted):
        left = target - at
        if abs(left) > band:
            running = True
        if running:
            step = _STEP / stroke * (1.0 if left > 0.0 else ratio)
            if abs(left) <= step:
                at, running = target, False
            else:
                at += np.sign(left) * step
        out[k] = at
    return out


def _far_side(gear, gap, side):
    """What a gear pushes through a gap: it moves only where the gear touches it."""
    out, at = np.empty(len(gear)), gear[0] + 0.5 * gap * side
    for k, near in enumerate(gear):
        if near - at > 0.5 * gap:
            at = near - 0.5 * gap
        elif at - near > 0.5 * gap:
            at = near + 0.5 * gap
        out[k] = at
    return out


def _lagged(values, lag):
    out, at, keep = np.empty(len(values)), values[0], np.exp(-_ROW / lag)
    for k, value in enumerate(values):
        at = keep * at + (1.0 - keep) * value
        out[k] = at
    return out


def _wander(rng, rows):
    """Slow noise of about one."""
    knots = rng.standard_normal(rows // 100 + 2)
    return np.interp(np.arange(rows), 100.0 * np.arange(len(knots)), knots)


def main(arguments=None):
    """Print one line a record, and what was found of play and of slowness."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("many", type=int, nargs="?", default=10)
    parser.add_argument("--history", action="store_true")
    asked = parser.parse_args(arguments)
    print(f"load {os.getloadavg()[0]:.1f}")
    print("| seed | play | opening | declared | stroke, dead [s] | verdict | found | p | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for seed in range(asked.many):
        play = float(np.random.default_rng(seed + 9000).uniform(0.015, 0.06))
        plays = ((0.0, 0.0), (play, play), (0.0, play)) if asked.history else ((None, 0.0), (None, play))
        for before, now in plays:
            print(_line(seed, before, now), flush=True)


def _line(seed, before, now):
    """Row of the table of a motor with play `now`; its history has play `before`, None without a history."""
    from sklvalve import MissingPhysicsFinder

    opening, declared = bool(seed % 2), seed % 4 >= 2
    draw = {"with_opening": opening, "declared": declared}
    recording, truth = _recording(seed, play=now, rows=2000 if before is None else 4000, **draw)
    began, history = time.perf_counter(), None
    if before is not None:
        first, _ = _recording(seed, play=before, rows=4000, **draw)
        history = MissingPhysicsFinder(n_jobs=1).history_of(first.slice(0, 2000))
        recording = recording.slice(2000, 4000)
    found = MissingPhysicsFinder(history=history, n_jobs=1).fit(recording).diagnosis_.to_dict()
    classes = "; ".join(
        f"{'/'.join(m['name'] for m in e['members'])} ({e['kind']}, {e['sentence']})"
        for e in found["effects"]
    )
    play = f"{100.0 * now:.1f} %" if before is None else f"{100.0 * before:.1f} to {100.0 * now:.1f} %"
    p_value = found["mismatch"]["p_value"]
    return (
        f"| {seed} | {play} | {opening} | {declared} | {truth['stroke']:.0f}, {truth['dead']:g} | "
        f"{found['verdict']} | {classes or '-'} | {'-' if p_value is None else f'{p_value:.2g}'} | "
        f"{time.perf_counter() - began:.0f} |"
    )


def _recording(seed, **draw):
    from sklvalve import Recording, Valve

    frame, sheet, truth = motor_record(seed, **draw)
    return Recording.from_frame(frame, Valve.from_dict(sheet)), truth


if __name__ == "__main__":
    main()
