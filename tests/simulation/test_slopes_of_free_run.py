# SPDX-License-Identifier: BSD-3-Clause
"""Derivatives of a free run, by the calibration and by the parameters of what acts before the stem."""

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import opening_parameters
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.free_run import slopes_of_free_run
from sklvalve.simulation.parameters import ParameterVector

# of the rows off corners: what follows one that was rounded the other way differs a little
MOST = 0.75
EFFECTS = [e for e in CATALOGUE if e.stage in ("signal", "actuator") and not getattr(e, "motor", False)]


@pytest.fixture(scope="module")
def recording():
    made = make_valve_recording(loop="wide", n_samples=1200, n_later=0, random_state=0)
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


def _asked(recording, effects, seed):
    """A chain, the way from a vector to its values, and a point well inside the bounds."""
    rng, chain = np.random.default_rng(seed), Chain(recording, recording.valve, None, effects=effects)
    own = [q.parameter_of(e.key) for e in effects for q in e.quantities(chain)]
    vector = ParameterVector([*opening_parameters(recording, recording.valve, Tolerance()), *own])
    z = vector.pack({})
    near = 0.2 * vector.scale * rng.uniform(-1.0, 1.0, len(z))
    far = np.minimum(vector.high - z, z - vector.low + vector.scale) * rng.uniform(0.05, 0.3, len(z))
    inside = 0.01 * (vector.high - vector.low)
    step = np.where(np.arange(len(z)) < len(z) - len(own), near, far)
    return chain, vector, np.clip(z + step, vector.low + inside, vector.high - inside)


def _slopes(chain, vector, z):
    reach = 1e-6 * vector.scale
    several = [vector.values(m) for m in z + np.diag(reach)]
    return slopes_of_free_run(chain, vector.values(z), several, reach, chain._through)


@pytest.mark.parametrize("effect", [None, *EFFECTS], ids=lambda effect: getattr(effect, "key", "none"))
@pytest.mark.parametrize("seed", [0, 1])
def test_slopes_are_those_of_central_differences(recording, effect, seed):
    chain, vector, z = _asked(recording, (effect,) if effect else (), seed)
    slopes, here = _slopes(chain, vector, z), chain.run(vector.values(z))
    seen = 0
    for j, name in enumerate(vector.names):
        h = np.zeros(len(z))
        h[j] = 1e-6 * vector.scale[j]
        before, behind = chain.run(vector.values(z - h)), chain.run(vector.values(z + h))
        central, bent = (behind - before) / (2.0 * h[j]), (behind - 2.0 * here + before) / h[j]
        size = np.abs(central).max()
        straight = (central != 0.0) & (np.abs(bent) < 1e-4 * size)
        if not straight.any():
            continue
        off = np.abs(slopes[j, straight] - central[straight])
        assert np.quantile(off, MOST) <= 1e-6 * size + 1e-8, name
        seen += 1
    assert seen >= 5 or effect.key == "stuck_valve"


def test_gaps_in_the_command_hold_its_slopes(recording):
    command = recording["command"].copy()
    command[300:340] = np.nan
    signals = recording.signals | {"command": command}
    gapped = type(recording)(**{**vars(recording), "signals": signals})
    slopes = _slopes(*_asked(gapped, (), 0))
    assert np.isfinite(slopes).all()
    assert np.abs(slopes).max() < 100.0


def test_neighbours_are_foretold(recording):
    chain, vector, z = _asked(recording, (), 0)
    reach = 1e-3 * vector.scale
    several = [vector.values(m) for m in z + np.diag(reach)]
    near = chain.near(vector.values(z), several, reach)
    assert near is not chain
    for values in several:
        foretold, run = near.run(values), Chain(recording, recording.valve, None).run(values)
        assert np.sqrt(np.mean((foretold - run) ** 2)) < 2e-5
        # what was foretold is no run of the chain itself
        assert np.array_equal(chain.run(values), run)


def test_a_stem_that_hunts_is_run_for_its_neighbours(recording):
    chain, vector, z = _asked(recording, (), 0)
    wild = {"actuator_gain": 60.0, "actuator_reset": 10.0, "actuator_rate": 10.0, "actuator_loop": 0.4}
    z = vector.pack(vector.values(z) | wild)
    reach = -1e-3 * vector.scale
    several = [vector.values(m) for m in z + np.diag(reach)]
    assert np.abs(slopes_of_free_run(chain, vector.values(z), several, reach, chain._through)).max() > 1e3
    assert chain.near(vector.values(z), several, reach) is chain


def test_a_motor_has_no_slopes(recording):
    valve = Valve.from_dict(recording.valve.to_dict() | {"actuator": {"kind": "electric"}})
    chain = Chain(recording, valve, None)
    assert slopes_of_free_run(chain, {"actuator_speed": 0.1}, [], [], chain._through) is None
