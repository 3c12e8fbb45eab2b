"""Joined recordings: each is simulated as it is alone."""

import numpy as np
import pytest

from sklvalve.mismatch.data.gathering import settled
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.calibrating import expected_values
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.recording import Recording, join_recordings
from sklvalve.recording.valve import Valve
from sklvalve.simulation.tolerance import Tolerance

ROWS, SETTLED = 300, 45
VALVE = Valve.from_dict(
    {
        "valve": {"kv_rated": 40.0, "characteristic": "linear", "fl": 0.9, "nominal_size": 50.0},
        "fluid": {"name": "water"},
        "actuator": {"fail": "closed", "supply_pressure": 340.0, "spring_range": [20.0, 100.0]},
        "recording": {"time": "time"},
    }
)
# what neither grows nor, as play, remembers for good
BLOCKS = ("valve", "line", "measurement")
OF_FLOW = [
    e for e in CATALOGUE if e.block in BLOCKS and not e.grows and "drift" not in e.key and e.key != "backlash"
]


def day(number):
    rng = np.random.default_rng(number)
    # at rest where a joined recording begins to count, 40 s after its first row
    command = np.repeat(rng.uniform(0.1, 0.9, ROWS // 50), 50)
    return Recording.from_frame(
        {
            "time": 7200.0 * number + np.arange(float(ROWS)),
            "command": command,
            "opening": command,
            "p1": np.full(ROWS, 8e5),
            "p2": np.full(ROWS, 3e5),
            "flow": 0.02 * command,
        },
        VALVE,
    )


@pytest.fixture(scope="module")
def days():
    return [day(number) for number in range(3)]


@pytest.mark.parametrize("effect", [None, *OF_FLOW], ids=lambda e: "nothing" if e is None else e.key)
def test_a_joined_recording_is_simulated_as_it_is_alone(effect, days):
    whole = Problem.of(settled(join_recordings(days)), Tolerance(), ("choked_flow",))
    effects = () if effect is None else (effect,)
    own = (
        {}
        if effect is None
        else {f"{effect.key}.{q.name}": q.starts[0] for q in effect.quantities(whole.plain)}
    )
    values = expected_values(whole) | {"meter_lag": 2.0, "meter_ahead": 0.5} | own
    joined = whole.plain.beside(effects).flow(values)
    for k, one in enumerate(days):
        chain = Problem.of(one, Tolerance(), ("choked_flow",), trim=whole.trim).plain.beside(effects)
        alone = chain.flow(values)
        behind = slice(ROWS * k + SETTLED, ROWS * (k + 1))
        np.testing.assert_allclose(joined[behind], alone[SETTLED:], rtol=2e-3, atol=1e-6)
