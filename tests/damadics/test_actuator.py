# SPDX-License-Identifier: BSD-3-Clause
"""Constants of the actuators: which are refused, and what the larger ones of the factory are made of."""

import numpy as np
import pytest

from sklvalve.damadics import (
    Actuator,
    ActuatorSimulator,
    LevelLoop,
    Profile,
    make_damadics,
    preset,
    valve_sheet,
)

HALF = {"P1": 3.5e6, "P2": 2.6e6, "T1": 43.0, "CV": 0.5}


@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ({"kv": np.nan}, "kv must be a finite number above 0, got nan"),
        ({"kv": "120"}, "kv must be a finite number above 0, got '120'"),
        ({"mass": True}, "mass must be a finite number above 0, got True"),
        ({"stroke": 0.0}, r"stroke must be a finite number above 0, got 0\.0"),
        ({"dead_volume": 0}, "dead_volume must be a finite number above 0, got 0"),
        ({"effective_area": -0.03}, "effective_area must be a finite number above 0"),
        ({"spring": np.inf}, "spring must be a finite number above 0, got inf"),
        ({"play": -0.01}, "play must be a finite number, 0 or more, got -0.01"),
        ({"setpoint_lag": -1}, r"setpoint_lag must be a finite number above 0, got -1"),
        ({"setpoint_lag": 0.001}, r"setpoint_lag must be a finite number, 0\.0025 or more, got 0\.001"),
        ({"stick_slip": 2}, "stick_slip must be True or False, got 2"),
        ({"breakaway": 0.5}, r"breakaway must be a finite number, 1 or more, got 0\.5"),
    ],
)
def test_constants_that_cannot_be_are_one_sentence(constants, message):
    with pytest.raises(ValueError, match=message) as told:
        Actuator(**constants)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    "constants", [{"viscous": 2300.0}, {"viscous": 20500.0}, {"mass": 1.3}, {"viscous": 0.0}]
)
def test_a_stem_that_the_steps_cannot_follow_is_refused(constants):
    """Such stems came to rest at an end of their travel, without a word."""
    with pytest.raises(ValueError, match=r"must be stable in steps of 0\.0025 s|viscous must be"):
        Actuator(**constants)


@pytest.mark.parametrize(
    "constants",
    [
        {"viscous": 2200.0},
        {"viscous": 420.0},
        {"mass": 1.36},
        {"setpoint_lag": 0.0025},
        # a heavier stem bears more friction; dry friction has an implicit step
        {"viscous": 20500.0, "mass": 28.0},
        {"viscous": 20500.0, "stick_slip": True},
    ],
)
def test_what_is_not_refused_is_stable(constants):
    run = ActuatorSimulator(Actuator(**constants), noise=False).simulate(60.0, lambda t: HALF, step=0.1)
    assert run["X"][-1] == pytest.approx(0.5, abs=0.01)
    assert np.ptp(run["X"][-100:]) < 1e-3


def test_the_larger_actuators_are_in_proportion():
    third = Actuator()
    for number in (1, 2):
        actuator = preset(number)
        larger = actuator.effective_area / third.effective_area
        for name in ("dead_volume", "nozzle", "most_air", "leak", "spring"):
            assert getattr(actuator, name) == pytest.approx(larger * getattr(third, name)), name
        assert actuator.bypass_kv / actuator.kv == pytest.approx(third.bypass_kv / third.kv)
    # an open bypass counts as much as on actuator 3, of the same kv
    flows = []
    for number in (1, 3):
        runs = [
            make_damadics(fault, actuator=number, duration=120.0, noise=False, extended=True)["true_F"].iloc[
                -1
            ]
            for fault in (None, Profile("f18", 0.75))
        ]
        flows.append((runs[1] - runs[0]) / preset(number).kv)
    assert flows[0] / flows[1] == pytest.approx(0.5, abs=0.05)


def test_an_actuator_may_be_given_by_its_number():
    assert ActuatorSimulator(1).actuator == preset(1)
    assert ActuatorSimulator().actuator == ActuatorSimulator(3).actuator == Actuator()
    assert valve_sheet(1) == valve_sheet(preset(1))
    assert valve_sheet() == valve_sheet(3)
    for ask in (ActuatorSimulator, valve_sheet, preset, lambda one: make_damadics(actuator=one)):
        for wrong in (4, [1], "1"):
            with pytest.raises(ValueError, match="actuator must be 1, 2 or 3, got"):
                ask(wrong)


@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ({"lag": 0}, r"lag must be a finite number, 0\.0025 or more, got 0"),
        ({"lag": np.nan}, r"lag must be a finite number, 0\.0025 or more, got nan"),
        ({"lag": -1}, r"lag must be a finite number, 0\.0025 or more, got -1"),
        ({"gain": -100.0}, r"gain must be a finite number above 0, got -100\.0"),
        ({"area": 0.0}, "area must be a finite number above 0"),
        ({"hole": -1e-3}, "hole must be a finite number, 0 or more"),
        ({"setpoint": "half"}, r"setpoint must lie in \[0, 1\], got 'half'"),
        ({"level": np.nan}, r"level must lie in \[0, 2\], got nan"),
        ({"celsius": 300.0}, r"celsius must lie in \[-20, 220\]"),
    ],
)
def test_loops_that_cannot_be_are_one_sentence(constants, message):
    with pytest.raises(ValueError, match=message):
        LevelLoop(**constants)


def test_a_loop_of_another_actuator_is_refused():
    with pytest.raises(ValueError, match=r"pump of the loop gives 3\.5 MPa .* end at 1 MPa; take actuator 3"):
        make_damadics(loop=LevelLoop(), actuator=1)
    with pytest.raises(ValueError, match="take actuator 3"):
        ActuatorSimulator(preset(2)).simulate(10.0, LevelLoop())
    # one of this actuator's pressures is not
    own = LevelLoop(pump=8e5, back=4e5, area=200.0, hole=0.013)
    frame = make_damadics(loop=own, actuator=1, duration=600.0, noise=False)
    assert frame["PV"].iloc[-1] == pytest.approx(50.0, abs=2.0)
    assert 0.0 < frame["X"].iloc[-1] < 100.0
