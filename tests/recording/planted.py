# SPDX-License-Identifier: BSD-3-Clause
"""A healthy recording to plant something in, and what the screening says of it."""

import json

import numpy as np

from sklvalve.recording import Recording, Valve, screen_recording

N = 3000


def smooth(values, rows):
    """First-order lag of so many rows."""
    out = np.empty_like(values)
    state = values[0]
    for row, value in enumerate(values):
        state += (value - state) / rows
        out[row] = state
    return out


def healthy(seed=0):
    """Percent, kPa, degC and m3/h of a valve that is moved about, with noise and two to three decimals."""
    rng = np.random.default_rng(seed)
    targets = np.repeat(rng.uniform(20.0, 80.0, N // 60), 60)
    command = np.round(smooth(targets, 3.0), 2)
    stem = smooth(command, 4.0)
    p1 = 800.0 + smooth(rng.normal(0.0, 60.0, N), 50.0)
    p2 = 300.0 + smooth(rng.normal(0.0, 60.0, N), 50.0)
    flow = smooth(0.4 * stem * np.sqrt((p1 - p2) / 100.0), 2.0)
    return {
        "time": np.arange(float(N)),
        "CV": command,
        "X": np.round(stem + rng.normal(0.0, 0.15, N), 2),
        "P1": np.round(p1 + rng.normal(0.0, 1.0, N), 1),
        "P2": np.round(p2 + rng.normal(0.0, 1.0, N), 1),
        "T": np.round(40.0 + smooth(rng.normal(0.0, 3.0, N), 100.0) + rng.normal(0.0, 0.1, N), 2),
        "F": np.round(flow + rng.normal(0.0, 0.2, N), 3),
    }


ROLES = {
    "command": {"column": "CV", "unit": "%"},
    "opening": {"column": "X", "unit": "%"},
    "p1": {"column": "P1", "unit": "kPa"},
    "p2": {"column": "P2", "unit": "kPa"},
    "temperature": {"column": "T", "unit": "degC"},
    "flow": {"column": "F", "unit": "m3/h"},
}


def planted(columns, sheet=None, **roles):
    valve = Valve.from_dict({"valve": sheet or {"kv_rated": 40.0}, "recording": {**ROLES, **roles}})
    return Recording.from_frame(columns, valve)


def screened(columns, sheet=None, **roles):
    found = screen_recording(planted(columns, sheet, **roles))
    assert json.loads(json.dumps(found)) == found
    return found


def names(found):
    return {(each["finding"], each["role"]) for each in found}
