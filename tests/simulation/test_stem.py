# SPDX-License-Identifier: BSD-3-Clause
"""The stem's scan against its differential equation, and what a fit asks of it: smooth, and no ringing."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sklvalve.simulation.faults import FAULTS, columns_of_faults
from sklvalve.simulation.stem import positioner_and_actuator

AIR, SPRING, SUPPLY = 101.325 / 80.0, (101.325 + 20.0) / 80.0, (101.325 + 340.0) / 80.0
SOUND = np.empty((0, len(FAULTS)))
ORDINARY = {"filter_time": 0.15, "gain": 9.0, "reset": 0.5, "rate": 1.2, "coulomb": 0.03, "supply": SUPPLY}
# what fits of quick positioners come to; explicit steps of 0.1 s would ring
QUICK = {"filter_time": 0.4, "gain": 34.0, "reset": 5.0, "rate": 3.6, "coulomb": 0.04, "supply": 2.22}


def _run(command, valve, *, every=1.0, faults=SOUND):
    n = len(command)
    return positioner_and_actuator(
        command,
        np.full(n, every),
        command[0],
        SPRING,
        AIR,
        np.full(n, valve["supply"]),
        np.full(n, valve["coulomb"]),
        np.zeros(n),
        np.zeros(n),
        faults,
        valve["filter_time"],
        valve["gain"],
        valve["reset"],
        valve["rate"],
        valve.get("feedback", 0.0),
        valve.get("vent", 1.0),
        valve.get("lag", 0.0),
    )


def _program():
    """Steps up and down, a ramp, small steps around a hold."""
    steps = np.repeat([0.4, 0.46, 0.43, 0.7, 0.3], 8)
    small = 0.55 + 0.01 * np.repeat([0.0, 1.0, -1.0, 2.0, 1.5], 5)
    return np.r_[steps, np.linspace(0.3, 0.55, 30), small]


def _solved(command, valve):
    """The same equations by a stiff solver of high order, sample by sample."""

    def nozzle(ratio):
        return np.sqrt(1.0 - (min(max(ratio, 0.3), 1.0) / 0.7 - 3.0 / 7.0) ** 2)

    def slopes(t, state, target, supply):
        wanted, integral, mass, x, bend, felt = state
        error = wanted - (felt if late else x)
        pressure = mass / (5.0 + x)
        shown = valve.get("feedback", 0.0) * (SPRING + wanted - pressure)
        spool = min(max(valve["gain"] * (error + shown) + integral, -1.0), 1.0)
        # back into a lower supply by a line from 0.98 of its pressure on
        back = supply / pressure
        back = nozzle(back) if back < 0.98 else max(nozzle(0.98) * (1.0 - back) / 0.02, 0.0)
        filling = supply * nozzle(pressure / supply) - pressure * back
        inlet = filling if spool > 0.0 else valve.get("vent", 1.0) * pressure * nozzle(AIR / pressure)
        speed = (pressure - SPRING - x - 60.0 * bend) / 0.005
        slip = abs(speed) * 60.0 * bend / valve["coulomb"]
        lag = (target - wanted) / valve["filter_time"]
        feels = (x - felt) / late if late else 0.0
        return [lag, valve["reset"] * error, valve["rate"] * spool * inlet, speed, speed - slip, feels]

    late, first = valve.get("lag", 0.0), command[0]
    state, out = [first, 0.0, (first + SPRING) * (5.0 + first), first, 0.0, first], []
    for given in zip(command, np.broadcast_to(valve["supply"], command.shape), strict=True):
        # at 1e-6 the solver's own error reached 2e-3 of travel in one of its versions
        done = solve_ivp(slopes, (0.0, 1.0), state, method="LSODA", args=given, rtol=1e-8, atol=1e-10)
        state = done.y[:, -1]
        out.append(state[3])
    return np.array(out)


RUBS = {"coulomb": 0.19, "gain": 15.0, "reset": 1e-3, "feedback": 0.25, "vent": 1.3, "lag": 0.25}


@pytest.mark.parametrize(
    "changed",
    [{"vent": 1.0}, {"vent": 0.8}, {"vent": 1.7}, {"lag": 0.05}, {"lag": 0.2, "feedback": 0.2}, RUBS],
    ids=str,
)
def test_stem_follows_its_differential_equation(changed):
    command, valve = _program(), ORDINARY | changed
    off = _run(command, valve) - _solved(command, valve)
    assert np.abs(off).max() < 2e-3
    assert np.sqrt(np.mean(off**2)) < 4e-4


@pytest.mark.parametrize("left", [0.35, 0.55, 0.7])
def test_a_supply_that_falls_takes_air_back(left):
    # a spool that is shut keeps the air in: it is opened by a little more that is asked for
    command, valve = np.where(np.arange(60) < 20, 0.7, 0.72), ORDINARY | {"reset": 1e-3}
    supply = np.where(np.arange(60) < 20, valve["supply"], SPRING + left)
    stem = _run(command, valve | {"supply": supply})
    assert stem[19] == pytest.approx(0.7, abs=5e-3)
    # what is left of the supply carries the stem no higher than friction holds it
    assert stem[-1] == pytest.approx(min(left + valve["coulomb"], 0.7), abs=5e-3)
    # the spool opens wider as the stem falls, which counts one step later: a tenth of a second
    off = stem - _solved(command, valve | {"supply": supply})
    assert np.abs(off).max() < 0.015


def test_finer_samples_of_the_same_command_move_the_stem_alike():
    command = _program()
    fine = _run(np.repeat(command, 10), ORDINARY, every=0.1)[9::10]
    off = _run(command, ORDINARY) - fine
    assert np.abs(off).max() < 2e-3
    assert np.sqrt(np.mean(off**2)) < 4e-4


@pytest.mark.parametrize("valve", [ORDINARY, QUICK], ids=["ordinary", "quick"])
@pytest.mark.parametrize("name", ["filter_time", "gain", "reset", "rate", "coulomb", "supply", "lag"])
def test_stem_is_smooth_in_its_parameters(valve, name):
    valve = valve | {"lag": 0.06}
    command = 0.2 + 0.5 * _program()
    here = _run(command, valve)
    up = _run(command, valve | {name: valve[name] * 1.001})
    down = _run(command, valve | {name: valve[name] * 0.999})
    bent = up - 2.0 * here + down
    assert np.sqrt(np.mean(bent**2)) < 2e-5
    assert np.abs(up - here).max() < 0.02


def test_quick_positioner_settles_without_ringing():
    command = np.r_[np.full(10, 0.5), np.full(60, 0.3)]
    stem = _run(command, QUICK)
    assert np.abs(np.diff(stem[30:])).max() < 1e-4
    assert stem[-1] == pytest.approx(0.3, abs=1e-3)


def test_what_the_positioner_feels_late_carries_a_rubbing_stem_further():
    # without a lag friction stops the stem short of every command; with one it goes on until that is felt
    command = np.repeat([0.3, 0.6, 0.3, 0.6], 40)
    ends = [39 + 40 * k for k in (1, 2, 3)]
    valve = ORDINARY | {"coulomb": 0.15, "reset": 1e-3, "feedback": 0.2}
    short = (command - _run(command, valve))[ends] * [1.0, -1.0, 1.0]
    late = (command - _run(command, valve | {"lag": 0.2}))[ends] * [1.0, -1.0, 1.0]
    assert (short > 0.02).all()
    assert (late < short - 0.005).all()
    assert (late[[0, 2]] < -0.01).all()


def test_sound_columns_are_none_and_zero_columns_change_nothing():
    command = _program()
    drive = dict.fromkeys(FAULTS, 0.0)
    assert columns_of_faults(drive, len(command)).shape == (0, len(FAULTS))
    zero = columns_of_faults(drive | {"load": np.zeros(len(command))}, len(command))
    assert zero.shape == (len(command), len(FAULTS))
    np.testing.assert_array_equal(_run(command, ORDINARY, faults=zero), _run(command, ORDINARY))


def test_fault_acts_from_its_row_on():
    command = np.full(120, 0.8)
    strong = np.where(np.arange(120) >= 60, 1.0, 0.0)
    drive = dict.fromkeys(FAULTS, 0.0) | {"load": strong}
    stem = _run(command, ORDINARY | {"supply": SPRING + 1.2}, faults=columns_of_faults(drive, 120))
    sound = _run(command, ORDINARY | {"supply": SPRING + 1.2})
    np.testing.assert_array_equal(stem[:60], sound[:60])
    # thrown back at first; all the air then carries it up 1.2 travels, less the load's one and friction
    assert stem[-1] == pytest.approx(0.2 - ORDINARY["coulomb"], abs=2e-3)


@pytest.mark.parametrize("feedback", [0.1, 0.25])
def test_pressure_feedback_leaves_a_stem_with_friction_behind_by_its_share(feedback):
    # at rest e + k (p_0 + u - p) = 0 and p = p_0 + x -+ F, so that e = +-k F / (1 + k)
    slow = np.r_[np.linspace(0.3, 0.7, 2000), np.linspace(0.7, 0.3, 2000)]
    valve = ORDINARY | {"coulomb": 0.1, "reset": 1e-6, "feedback": feedback}
    behind = slow - _run(slow, valve)
    expected = feedback * 0.1 / (1.0 + feedback)
    np.testing.assert_allclose(np.median(behind[500:1900]), expected, rtol=0.1)
    np.testing.assert_allclose(np.median(behind[2500:3900]), -expected, rtol=0.1)
