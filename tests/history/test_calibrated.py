# SPDX-License-Identifier: BSD-3-Clause
"""What a valve is calibrated to: as near to its recordings as its parameters can bring it."""

import numpy as np

from sklvalve.history import ValveHistory, learning
from tests.history.plant import changed


def test_a_wander_takes_up_nothing_that_the_calibration_could_meet(before):
    span = np.ptp(before["flow"])
    later = np.arange(len(before)) > len(before) / 2
    stepped = changed(before, flow=before["flow"] + 0.1 * span * later)
    learnt = ValveHistory().fit(stepped)
    # capacity and zero can halve a step that lies in half of the rows, and leave half of it
    assert learnt.left("flow") < 0.05 * span


def test_noise_is_as_large_as_what_the_calibration_left(before):
    span = np.ptp(before["flow"])
    walk = np.random.default_rng(0).normal(size=len(before)).cumsum()
    walk = (walk - walk.mean()) / walk.std()
    learnt = ValveHistory().fit(changed(before, flow=before["flow"] + 0.2 * span * walk))
    noise = learnt.noise_parts("flow")
    assert np.sqrt(noise.slow + noise.fast) > 0.05 * span


def test_begins_where_it_is_told_to_and_searches_nothing(before, learnt, monkeypatch):
    def searched(*_, **__):
        raise AssertionError("searched")

    monkeypatch.setattr(learning, "first_values", searched)
    again = ValveHistory(start=learnt.values_).fit(before)
    for channel in learnt.channels:
        assert again.left(channel) < 1.02 * learnt.left(channel)
