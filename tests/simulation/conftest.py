# SPDX-License-Identifier: BSD-3-Clause
"""A healthy recording and the simulation calibrated on it."""

import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import ValveSimulation

ROWS = 1200


@pytest.fixture(scope="session")
def made():
    """A healthy valve, 1,200 s to calibrate on and 300 s more."""
    return make_valve_recording(loop="wide", n_samples=ROWS, n_later=300, random_state=0)


@pytest.fixture(scope="session")
def recording(made):
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


@pytest.fixture(scope="session")
def later(made):
    return Recording.from_frame(made.later, Valve.from_dict(made.valve))


@pytest.fixture(scope="session")
def simulation(recording):
    return ValveSimulation().fit(recording)
