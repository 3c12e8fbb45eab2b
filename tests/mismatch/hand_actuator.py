# SPDX-License-Identifier: BSD-3-Clause
"""A quick actuator on weak air, whose end of travel a force balance by hand gives."""

import numpy as np

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording import Recording, Valve
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.trim import LearntTrim

EFFECTS = {effect.key: effect for effect in CATALOGUE}
# spring of 20 to 100 kPa: travels of it are 80 kPa; the air carries 0.6 of a travel
AIR, PRELOAD, REACH = 101.325 / 80.0, 20.0 / 80.0, 0.6
SUPPLY = AIR + PRELOAD + REACH
WEAK_AIR = {"supply_pressure": 20.0 + 80.0 * REACH, "spring_range": [20.0, 100.0]}
# a quick positioner without integral, on a stem that hardly rubs
VALUES = {
    "actuator_filter": 0.05,
    "actuator_gain": 30.0,
    "actuator_reset": 1e-9,
    "actuator_rate": 1.0,
    "actuator_coulomb": 1e-4,
    "actuator_delay": 0.0,
}


def chain_of(command, *keys, actuator=WEAK_AIR, opening=None, onsets=None, dp=2e5):
    n = len(command)
    frame = {
        "time": np.arange(n, dtype=float),
        "command": np.asarray(command, dtype=float),
        "opening": np.r_[command[:1], np.full(n - 1, 0.5)] if opening is None else opening,
        "p1": np.full(n, 3e5) + dp,
        "p2": np.full(n, 3e5),
    }
    valve = Valve.from_dict({"actuator": actuator, "recording": {}})
    recording = Recording.from_frame(frame, None)
    trim = LearntTrim(np.array([0.0, 1.0]), 1.0, knots=(0.0, 1.0))
    return Chain(recording, valve, trim, effects=[EFFECTS[key] for key in keys], onsets=onsets)


def run(chain, **own):
    """Free run with parameters of the chain's first effect."""
    (effect,) = chain.effects
    return chain.stem_of_free_run(VALUES | {f"{effect.key}.{name}": value for name, value in own.items()})
