# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the DAMADICS actuator in SI units: the benchmark's own excitation, and levels drawn at random.

In the benchmark's excitation nothing but the command moves far: the drop stays within 0.7 to 1.1 MPa and the
temperature at 43 degC, so no model of it can be tested outside where it was trained, and the temperature says
nothing. The varied excitation goes from level to level within a box of opening, drop and temperature. Its
drops stay below those at which the simulated valve chokes.
"""

from dataclasses import dataclass, field

import numpy as np

from sklvalve.damadics import ActuatorSimulator, Profile
from sklvalve.damadics.excitation import Recorded, standard, step_test
from sklvalve.damadics.simulator import TEMPERATURE_SPAN

#: After which the stem has come from rest to where the command wants it [s].
SETTLED = 60
#: Flows outside are left out [share of the sensor's span]: it ends at 40 t/h and says nothing beyond, and of
#: less than 2 t/h its noise leaves too little to tell an outlet pressure by.
NEARLY_EMPTY, NEARLY_FULL = 0.05, 0.99
ICE = 273.15
HOUR = 3600.0


@dataclass(frozen=True)
class Box:
    """Range of opening [1] and of pressure drop [Pa]."""

    opening: tuple
    drop: tuple

    def holds(self, signals):
        """Which rows lie within, by their signals."""
        within = np.ones(len(signals["opening"]), dtype=bool)
        for values, (low, high) in (
            (signals["opening"], self.opening),
            (signals["p1"] - signals["p2"], self.drop),
        ):
            within &= (values >= low) & (values <= high)
        return within


TRAINED = Box(opening=(0.22, 0.5), drop=(0.7e6, 1.2e6))
WHOLE = Box(opening=(0.10, 0.75), drop=(0.1e6, 1.6e6))
INLET, CELSIUS = (3.3e6, 3.7e6), (20.0, 100.0)


@dataclass(frozen=True)
class Scenario:
    """What a model is trained and tested on.

    Attributes
    ----------
    faults : tuple of Profile
        Present from the first second, in training and test.
    trained : Box or None
        Of the varied excitation in training, which is tested in all of `WHOLE`; None is the benchmark's own
        excitation, in training and test.
    """

    faults: tuple = ()
    trained: Box | None = TRAINED


#: Scenarios by name; the sizes of the faults are the benchmark's small and big.
SCENARIOS = {
    "normal": Scenario(),
    "whole": Scenario(trained=WHOLE),
    "standard": Scenario(trained=None),
    "f2": Scenario((Profile("f2", 0.75),)),
    "f18": Scenario((Profile("f18", 0.25),)),
}


@dataclass(frozen=True, eq=False)
class Signals:
    """Rows of a run, one a second.

    Attributes
    ----------
    measured, clean : dict of ndarray of shape (n,)
        With the sensors' noise and without: ``opening`` [1], ``command`` as an opening [1], ``p1`` and ``p2``
        [Pa], ``temperature`` [K], ``flow`` [t/s].
    metered : ndarray of bool of shape (n,)
        Rows in which the flow sensor is neither at its end nor near zero.
    """

    measured: dict
    clean: dict
    metered: np.ndarray = field(repr=False)

    def __len__(self):
        return len(self.metered)


def simulated(excitation, seconds, faults, rng):
    """Signals of so many seconds after the stem has settled."""
    simulator = ActuatorSimulator()
    actuator = simulator.actuator
    run = simulator.simulate(SETTLED + seconds, excitation, faults, random_state=rng.integers(2**32))
    rows = slice(SETTLED, None)
    t, command = run["t"][rows], 1.0 - run["CV"][rows]
    drivers = {name: np.broadcast_to(values, t.shape) for name, values in excitation(t).items()}
    measured = {
        "opening": 1.0 - run["X"][rows],
        "command": command,
        "p1": actuator.pressure_range * run["P1"][rows],
        "p2": actuator.pressure_range * run["P2"][rows],
        "temperature": ICE + TEMPERATURE_SPAN * run["T1"][rows],
        "flow": actuator.flow_range / HOUR * run["F"][rows],
    }
    clean = {
        "opening": 1.0 - run["x"][rows] / actuator.stroke,
        "command": command,
        "p1": drivers["P1"],
        "p2": drivers["P2"],
        "temperature": ICE + drivers["T1"],
        "flow": run["F_tph"][rows] / HOUR,
    }
    metered = (run["F"][rows] >= NEARLY_EMPTY) & (run["F"][rows] < NEARLY_FULL)
    return Signals(measured, clean, metered)


def static_run(scenario, box, seconds, rng):
    """Signals of a scenario within a box, which the benchmark's own excitation does not ask for."""
    excitation = standard if scenario.trained is None else varied(SETTLED + seconds, box, rng)
    return simulated(excitation, seconds, scenario.faults, rng)


def varied(seconds, box, rng):
    """Excitation that goes in straight lines from level to level, every signal by itself."""
    t = np.arange(seconds + 1.0)
    p1 = _ramps(t, INLET, rng)
    return Recorded(
        t,
        {
            "CV": 1.0 - _ramps(t, box.opening, rng),
            "P1": p1,
            "P2": p1 - _ramps(t, box.drop, rng),
            "T1": _ramps(t, CELSIUS, rng),
        },
    )


def stepped(seconds, openings, rng):
    """Excitation whose command stays at a level for 6 to 20 s; pressures as in the benchmark's example I."""
    t = np.arange(seconds + 1.0)
    command = np.empty(len(t))
    at = 0
    while at < len(t):
        held = int(rng.integers(6, 21))
        command[at : at + held] = 1.0 - rng.uniform(*openings)
        at += held

    def excitation(times):
        # held, and not in straight lines as what is recorded
        now = np.minimum((np.asarray(times) + 1e-9).astype(int), len(command) - 1)
        return step_test(times) | {"CV": command[now]}

    return excitation


def _ramps(t, between, rng):
    knots = np.concatenate([[0.0], np.cumsum(rng.uniform(15.0, 45.0, 2 + int(t[-1] // 15)))])
    return np.interp(t, knots, rng.uniform(*between, len(knots)))
