# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis agrees with itself: verdict and rules, effects and table, values and limits."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder
from sklvalve.datasets import make_valve_recording
from sklvalve.recording import Recording, Valve
from tests.mismatch.conftest import agree


def _recording(effect, size, without=(), **more):
    made = make_valve_recording(effect, size, loop="wide", n_samples=1200, n_later=0, random_state=3, **more)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    signals = {role: values for role, values in recording.signals.items() if role not in without}
    roles = {role: column for role, column in recording.valve.roles.items() if role not in without}
    return replace(recording, signals=signals, valve=replace(recording.valve, roles=roles))


def _late():
    """A passage that is blocked in the last rows."""
    recording = _recording(None, None)
    flow = recording["flow"].copy()
    flow[-40:] = 0.3 * np.nanmedian(flow)
    return replace(recording, signals=recording.signals | {"flow": flow})


CASES = {
    "clogging": lambda: _recording("clogging", 0.5),
    "healthy": lambda: _recording(None, None),
    "stiction": lambda: _recording("stiction", 600.0),
    "no opening": lambda: _recording("clogging", 0.5, without=("opening",)),
    "pulses": lambda: _recording("hydrate_pulses", 0.3),
    "late": _late,
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_a_diagnosis_agrees_with_itself(case):
    agree(MissingPhysicsFinder(n_jobs=1).fit(CASES[case]()).diagnosis_.content)


@pytest.mark.slow
def test_what_lies_behind_a_property_does_not_replace_a_better_name():
    """Without a recorded opening a dead band was held, and three names that predict worse stood behind it."""
    found = MissingPhysicsFinder(n_jobs=1).fit(CASES["no opening"]()).diagnosis_
    assert "clogging" in found.effects[0]
