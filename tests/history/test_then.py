# SPDX-License-Identifier: BSD-3-Clause
"""What a history lets expect: its calibration with intervals, and the simulation with it."""

import numpy as np
import pytest

from sklvalve.history import ValveHistory
from sklvalve.history.then import expected_of, scatter_then, simulation_then


@pytest.fixture(scope="module")
def expected(learnt):
    return {each.name: each for each in expected_of(learnt)}


def test_every_parameter_of_the_prior_is_there_with_its_mean_and_spread(learnt, expected):
    assert tuple(expected) == learnt.prior_.names
    for mean, spread, each in zip(
        learnt.prior_.mean, np.sqrt(np.diag(learnt.prior_.covariance)), expected.values(), strict=True
    ):
        assert (np.log(each.value) if each.log else each.value) == pytest.approx(mean, abs=1e-9)
        assert each.spread == pytest.approx(spread)
        assert each.low <= each.value <= each.high


def test_deviations_of_a_logarithm_are_those_of_its_ratio(expected):
    lag, capacity = expected["meter_lag"], expected["capacity"]
    assert lag.log
    assert not capacity.log
    assert lag.deviations(lag.value * np.exp(2.0 * lag.spread)) == pytest.approx(2.0)
    assert capacity.deviations(capacity.value - 3.0 * capacity.spread) == pytest.approx(-3.0)
    # the interval is that of the logarithm, so that it is wider above
    assert lag.high - lag.value > lag.value - lag.low


def test_where_the_sheet_knows_as_much_nothing_was_learnt(expected):
    assert expected["capacity"].informed
    # where the valve does not choke nothing moves with the knee: it stays as open as the sheet leaves it
    assert not expected["knee"].informed


def test_the_simulation_of_then_fits_what_came_after_a_sound_history(learnt, after):
    made = simulation_then(learnt).simulate(after)
    flow = after["flow"] - made["flow"]
    assert np.sqrt(np.nanmean(flow**2)) < 2.0 * learnt.left("flow")


def test_scatter_is_that_of_the_calibration_and_the_same_every_time(learnt, after):
    part = after.slice(0, 300)
    scatter = scatter_then(learnt, part)
    assert scatter["flow"].shape == (300,)
    assert np.all(scatter["flow"] >= 0.0)
    # of the order of the allowances, far from the sheet's tenth
    share = scatter["flow"].max() / np.nanmax(part["flow"])
    assert 0.001 < share < 0.05
    np.testing.assert_array_equal(scatter["flow"], scatter_then(learnt, part)["flow"])


def test_a_history_from_a_file_expects_the_same(learnt, expected):
    again = ValveHistory.from_state(learnt.valve_, learnt.to_state())
    for each in expected_of(again):
        assert each.value == pytest.approx(expected[each.name].value)
        assert each.spread == pytest.approx(expected[each.name].spread)
