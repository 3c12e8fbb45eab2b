# SPDX-License-Identifier: BSD-3-Clause
"""What a sheet declares of an actuator is in its simulation, within the tolerance."""

import numpy as np
import pytest

from sklvalve.recording import Recording, Valve
from sklvalve.simulation import Tolerance, ValveSimulation
from sklvalve.simulation.calibration import opening_parameters
from sklvalve.simulation.electric import is_electric, knows_air

N = 600


def _recording(valve, *, with_opening=False):
    command = np.repeat([0.2, 0.8, 0.3, 0.7, 0.4], N // 5)
    frame = {"time": np.arange(float(N)), "command": command, "flow": 1e-3 * command}
    if with_opening:
        frame["opening"] = command
    return Recording.from_frame(frame, valve)


def _parameters(valve, **how):
    return {p.name: p for p in opening_parameters(_recording(valve, **how), valve, Tolerance())}


@pytest.mark.parametrize(
    ("kind", "with_opening", "electric"),
    [
        ("electric", False, True),
        ("hydraulic", True, True),
        ("pneumatic", True, False),
        ("unknown", True, True),
        ("unknown", False, False),
        (None, True, True),
    ],
)
def test_the_kind_declared_goes_before_what_the_recording_shows(kind, with_opening, electric):
    valve = Valve(kind=kind)
    recording = _recording(valve, with_opening=with_opening)
    assert is_electric(valve, recording) is electric
    assert knows_air(valve, recording) is (kind == "pneumatic")


@pytest.mark.parametrize(("kind", "name"), [("electric", "actuator_speed"), (None, "actuator_stroke")])
def test_a_declared_stroke_time_may_be_longer_by_a_quarter_and_much_shorter(kind, name):
    found = _parameters(Valve(kind=kind, stroke_time=20.0))[name]
    assert found.start == pytest.approx(1.0 / 20.0)
    assert found.low == pytest.approx(1.0 / 25.0)
    assert found.high > 0.2


def test_a_declared_dead_time_is_where_the_delay_lies():
    found = _parameters(Valve(dead_time=8.0))["actuator_delay"]
    assert found.low == pytest.approx(6.0)
    assert found.low < found.start < found.high
    assert found.high == pytest.approx(10.0 + 2.0)


def test_nothing_declared_leaves_the_calibration_as_it_was():
    assert "actuator_stroke" not in _parameters(Valve())
    assert "actuator_dead_band" not in _parameters(Valve(dead_band=0.0))
    assert _parameters(Valve())["actuator_delay"].low == 0.0


@pytest.mark.parametrize("kind", ["electric", None])
def test_a_declared_stroke_is_simulated(kind):
    valve = Valve(kind=kind, stroke_time=100.0)
    recording = _recording(valve)
    simulation = ValveSimulation(valve).fit(recording)
    values = simulation.values_ | {"actuator_speed": 0.01, "actuator_stroke": 0.01, "actuator_delay": 0.0}
    opening = simulation.chain_of(recording).stem_of_free_run(values)
    k = N // 5
    # half of the travel after the step takes thirty seconds at one per cent a second
    assert opening[k + 30] == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize("kind", ["electric", "pneumatic", None])
def test_a_declared_dead_band_leaves_small_changes_alone(kind):
    valve = Valve(kind=kind, dead_band=0.04)
    command = np.full(N, 0.5)
    command[200:400] = 0.51
    frame = {"time": np.arange(float(N)), "command": command, "opening": np.full(N, 0.5)}
    recording = Recording.from_frame(frame, valve)
    simulation = ValveSimulation(valve).fit(recording)
    chain = simulation.chain_of(recording)
    moved = np.ptp(chain.stem_of_free_run(simulation.values_ | {"actuator_dead_band": 0.04})[50:])
    assert moved < 0.004
