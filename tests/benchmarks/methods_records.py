# SPDX-License-Identifier: BSD-3-Clause
"""Short recordings of the simulated plant for tests of the methods."""

from dataclasses import replace
from functools import cache

from sklvalve import Recording, Valve
from sklvalve.datasets import make_valve_recording


@cache
def made(effect=None, strength=None, seed=5, rows=1500, onset=0.0):
    """Recording of the plant over its whole travel."""
    found = make_valve_recording(
        effect, strength, onset=onset, loop="wide", n_samples=rows, n_later=0, random_state=seed
    )
    return Recording.from_frame(found.frame, Valve.from_dict(found.valve))


def without(recording, *roles):
    """The recording as it would be without some signals."""
    return replace(recording, signals={r: v for r, v in recording.signals.items() if r not in roles})


def names(found):
    """Names told, one set an effect."""
    return [{m["name"] for m in e["members"]} for e in found["effects"]]
