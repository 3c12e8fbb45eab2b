# SPDX-License-Identifier: BSD-3-Clause
"""What a day says of each effect, held against the valve's history."""

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.history import ValveHistory
from sklvalve.recording import Recording, Valve
from sklvalve.watch.score import scored
from tests.history.plant import changed

ROWS = 1_200


@pytest.fixture(scope="module")
def leaking():
    """A valve whose seat leaks from the fourth of five days on."""
    settings = {"loop": "wide", "n_samples": 5 * ROWS, "n_later": 0, "random_state": 5}
    made = make_valve_recording("seat_leakage", 0.03, onset=3.0 * ROWS, **settings)
    whole = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    return [whole.slice(k * ROWS, (k + 1) * ROWS) for k in range(5)]


@pytest.fixture(scope="module")
def history(leaking):
    return ValveHistory().fit(leaking[0])


def test_an_effect_is_as_large_as_it_is_from_its_day_on(leaking, history):
    sizes = [scored(day, history).shares["seat_leakage"].size for day in leaking]
    assert np.abs(sizes[:3]).max() < 0.1 * min(sizes[3:])


def test_each_size_has_a_deviation_of_the_order_of_its_scatter(leaking, history):
    scores = [scored(day, history) for day in leaking[1:3]]
    for key, share in scores[0].shares.items():
        apart = abs(share.size - scores[1].shares[key].size)
        assert share.deviation > 0.0
        assert apart < 20.0 * share.deviation + 0.01, key


def test_what_is_left_is_noise_until_something_changes(leaking, history):
    left = [scored(day, history).left["flow"] for day in leaking]
    assert max(left[:3]) < 0.7 * min(left[3:])


@pytest.mark.parametrize(("factor", "unit"), [(1.0 / 3.6, "l/s"), (1000.0 / 60.0, "l/min")])
def test_a_changed_unit_is_no_fault(leaking, history, factor, unit):
    # values in another unit, read in the one of before
    values = leaking[1]["flow"] * factor
    score = scored(changed(leaking[1], flow=values), history)
    assert not score.shares
    assert f"as values in {unit} read in m3/h do" in score.mend


def test_data_that_must_be_mended_say_nothing_else(leaking, history):
    held = np.full(ROWS, leaking[1]["flow"][0])
    score = scored(changed(leaking[1], flow=held), history)
    assert score.rows == ROWS
    assert score.mend or "seat_leakage" not in score.shares
