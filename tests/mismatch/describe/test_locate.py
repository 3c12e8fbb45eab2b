# SPDX-License-Identifier: BSD-3-Clause
"""Where and when, as a diagnosis tells it."""

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import Recording, Valve
from tests.mismatch.conftest import ROWS


def test_onset_has_an_interval_that_holds_it(found_leaking):
    location = found_leaking.diagnosis_.content["location"]
    low, high = location["onset_ci95"]
    assert low <= 500.0 <= high
    assert low <= location["onset"] <= high
    assert high - low < 100.0
    assert location["course"] == "from an onset on"
    assert location["intervals"] == [[location["onset"], ROWS - 1.0]]
    assert location["intervals_ci95"] == [[[low, high], None]]


def test_nothing_found_is_nowhere(found_healthy):
    assert set(found_healthy.diagnosis_.content["location"]) == {
        "blocks",
        "regions",
        "onset",
        "intervals",
        "change",
    }


@pytest.mark.slow
def test_clogging_acts_above_its_limit():
    made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=ROWS, n_later=0, random_state=3)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    location = MissingPhysicsFinder(effects=["clogging"]).fit(recording).diagnosis_.content["location"]
    (region,) = location["regions"]
    assert region["signal"] == "opening"
    # the further above its limit of 0.5, the more it takes away
    assert region["low"] == pytest.approx(0.6, abs=0.12)
    assert region["high"] == pytest.approx(np.max(recording["opening"]), abs=0.02)
    assert location["onset"] is None
    assert location["course"] == "throughout"
