# SPDX-License-Identifier: BSD-3-Clause
"""Dry friction in place of play: the stem sticks under a small force, lets go, and shows a hysteresis."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.damadics import Actuator, ActuatorSimulator, Profile
from sklvalve.damadics.march import speed_with_friction

STICKY = Actuator(stick_slip=True)


def friction_of(actuator):
    """Half the width of the play times the spring's stiffness [N]."""
    return 0.5 * actuator.play * actuator.stroke * actuator.spring


def there_and_back(t):
    """A command that goes slowly from 0.3 to 0.7 and back, all else at rest."""
    return {"CV": 0.3 + 0.4 * (1.0 - np.abs(t / 500.0 - 1.0)), "P1": 3.5e6, "P2": 2.6e6, "T1": 43.0}


def loop_of_pressure(actuator, faults=()):
    """Pressure on the way to closed above that on the way back, at half stroke [Pa]."""
    run = ActuatorSimulator(actuator, noise=False).simulate(1000.0, there_and_back, faults, step=0.1)
    x, ps = run["x"] / actuator.stroke, run["Ps"]
    ways = [slice(1000, 5000), slice(5100, 9000)]
    return -float(np.subtract(*(np.polyval(np.polyfit(x[w] - 0.5, ps[w], 5), 0.0) for w in ways[::-1])))


def test_a_stem_at_rest_sticks_and_one_that_moves_comes_to_rest():
    par = replace(STICKY, breakaway=2.0).packed()
    assert speed_with_friction(0.0, 19.9, 10.0, par) == 0.0
    assert speed_with_friction(0.0, -19.9, 10.0, par) == 0.0
    # once it has let go, only the friction of motion holds it back
    assert speed_with_friction(0.0, 20.1, 10.0, par) == pytest.approx(10.1 / (2.0 / 0.0025 + 1500.0))
    speeds = [0.01]
    for _ in range(40):
        speeds.append(speed_with_friction(speeds[-1], 5.0, 10.0, par))
    assert (np.diff(speeds) <= 0.0).all()
    assert speeds[-1] == 0.0
    # against a steady force it slides at (force - friction) / viscous
    for _ in range(40):
        speeds.append(speed_with_friction(speeds[-1], -40.0, 10.0, par))
    assert speeds[-1] == pytest.approx(-30.0 / 1500.0, rel=1e-6)


def test_a_stem_sticks_where_the_jet_moves_it_otherwise():
    """The outlet pressure swings the jet's force by some 70 N, below a friction of 116 N."""

    def swings(t):
        return {"CV": 0.5, "P1": 3.5e6, "P2": 2.6e6 + 2.6e4 * np.sin(2.0 * t), "T1": 43.0}

    simulators = [ActuatorSimulator(a, noise=False) for a in (replace(STICKY, play=0.1), Actuator(play=0.0))]
    runs = [simulator.simulate(120.0, swings, step=0.1) for simulator in simulators]
    stuck, free = (np.ptp(run["x"][900:]) for run in runs)
    assert np.ptp(runs[0]["Fvc"][900:]) > 100.0
    assert stuck == 0.0
    assert free > 1e-5


@pytest.mark.parametrize("play", [0.01, 0.05])
def test_friction_makes_a_hysteresis_of_twice_its_force(play):
    actuator = replace(STICKY, play=play)
    known = 2.0 * friction_of(actuator) / actuator.effective_area
    assert loop_of_pressure(actuator) == pytest.approx(known, rel=0.05)
    # play lies before the spring: it takes no force, and the stem stands where the pressure puts it
    assert abs(loop_of_pressure(replace(actuator, stick_slip=False))) < 0.02 * known
    assert abs(loop_of_pressure(replace(actuator, play=0.0))) < 0.02 * known


def test_fault_f4_adds_friction():
    known = 2.0 * friction_of(replace(STICKY, play=0.06)) / STICKY.effective_area
    assert loop_of_pressure(STICKY, [Profile("f4", 0.05)]) == pytest.approx(known, rel=0.05)


def test_a_stem_that_breaks_away_goes_on_in_jumps():
    rests, jumps, largest = {}, {}, {}
    for breakaway in (1.0, 2.0):
        actuator = replace(STICKY, play=0.1, breakaway=breakaway)
        run = ActuatorSimulator(actuator, noise=False).simulate(950.0, there_and_back, step=0.1)
        moves = np.abs(np.diff(run["x"][5000:])) / actuator.stroke
        rests[breakaway] = np.mean(moves == 0.0)
        jumps[breakaway] = np.sum((moves[1:] > 0.0) & (moves[:-1] == 0.0))
        largest[breakaway] = moves.max()
    # after the turn: one rest and then a slide, against rest after rest with jumps between
    assert rests[1.0] < 0.05
    assert jumps[1.0] == 1
    assert rests[2.0] > 0.9
    assert jumps[2.0] > 50
    assert largest[2.0] > 5.0 * largest[1.0]


def test_without_friction_of_that_kind_nothing_is_dry():
    # little friction and no play are nearly the same
    runs = [
        ActuatorSimulator(actuator, noise=False).simulate(60.0, there_and_back)
        for actuator in (replace(STICKY, play=1e-6), Actuator(play=1e-6))
    ]
    np.testing.assert_allclose(runs[0]["X"], runs[1]["X"], atol=5e-3)


def test_numbers_for_compiled_code_carry_the_names_of_the_fields():
    actuator = replace(STICKY, kv=100, leakage_adds=False)
    par = actuator.packed()
    assert {type(value) for value in par} == {float}
    assert (par.kv, par.stick_slip, par.leakage_adds, par.effective_area) == (100.0, 1.0, 0.0, 0.029)
