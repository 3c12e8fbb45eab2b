# SPDX-License-Identifier: BSD-3-Clause
"""What an effect gains counts by how well the stretches of a recording agree on it."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm, t

from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.search import scatter as of_scatter
from sklvalve.mismatch.search.onset import losses_of
from sklvalve.mismatch.search.scatter import OverTime, gain_in_spreads

GAINS = st.floats(0.0, 1e4)
SCATTERS = st.builds(OverTime, st.floats(0.0, 50.0), st.floats(1.0, 96.0), st.floats(0.0, 1.0))
ROWS, SPAN = 3600, 60


def test_without_stretches_a_gain_counts_as_noise_has_it():
    assert OverTime().deviations(8.0) == pytest.approx(4.0)
    assert OverTime(scatter=3.0, stretches=30.0).deviations(-1.0) == 0.0


@given(GAINS, SCATTERS)
def test_stretches_only_take_from_a_gain(gain, over_time):
    assert 0.0 <= over_time.deviations(gain) <= np.sqrt(2.0 * gain)


@given(GAINS, st.floats(0.0, 100.0), SCATTERS)
def test_a_larger_gain_counts_for_more(gain, more, over_time):
    assert over_time.deviations(gain + more) >= over_time.deviations(gain)


@given(GAINS, st.floats(0.0, 50.0), st.floats(0.0, 50.0), st.floats(1.0, 96.0))
def test_stretches_that_disagree_by_more_leave_less(gain, scatter, more, stretches):
    agree, disagree = OverTime(scatter, stretches), OverTime(scatter + more, stretches)
    assert disagree.deviations(gain) <= agree.deviations(gain)


@pytest.mark.parametrize("deviations", [1.0, 3.0, 6.0])
def test_few_stretches_have_the_tail_of_few_degrees_of_freedom(deviations):
    few = OverTime(scatter=0.5, stretches=3.0).deviations(deviations**2 / 2.0)
    assert few == pytest.approx(norm.isf(t.sf(deviations, 22.0)), rel=2e-3)


def test_scatter_as_wide_as_noise_takes_nothing_where_stretches_are_many():
    assert OverTime(scatter=1.0, stretches=1e6).deviations(50.0) == pytest.approx(10.0, rel=1e-3)
    assert OverTime(scatter=4.0, stretches=1e6).deviations(50.0) == pytest.approx(5.0, rel=1e-3)


@pytest.mark.parametrize("scatter", [0.5, 4.0])
def test_what_is_gained_by_the_calibration_alone_has_no_stretches_to_agree(scatter):
    assert OverTime(scatter, 5.0, of_rows=0.0).deviations(50.0) == pytest.approx(10.0)


def test_what_the_calibration_regains_counts_and_does_not_scatter(monkeypatch):
    rows = 0.02 + 0.1 * np.random.default_rng(0).standard_normal(ROWS)
    problem = SimpleNamespace(
        channels=("flow",),
        plain=SimpleNamespace(clock=np.arange(ROWS, dtype=float)),
        recording=type("Recorded", (), {"__len__": lambda self: ROWS, "sample_time": 1.0})(),
    )
    # in rows alone one gains `rows` on the other; what its likelihood holds beyond is of the priors
    other = SimpleNamespace(losses=rows, log_likelihood=0.0)
    alone, regained = (
        SimpleNamespace(losses=np.zeros(ROWS), log_likelihood=rows.sum() + more) for more in (0.0, 50.0)
    )
    monkeypatch.setattr(of_scatter, "row_losses", lambda problem, model, channels: model.losses)
    each = np.array([part.sum() for part in np.array_split(rows, (ROWS - 1) // SPAN)])
    spread = np.sqrt(len(each)) * each.std(ddof=1)
    assert gain_in_spreads(problem, alone, other) == pytest.approx(rows.sum() / spread)
    assert gain_in_spreads(problem, regained, other) == pytest.approx((rows.sum() + 50.0) / spread)


def test_a_size_known_from_rows_and_from_the_calibration_has_the_variance_of_both():
    # rows four times as uncertain, beside what is expected, of which half the gain comes
    known = OverTime(scatter=4.0, stretches=1e6, of_rows=0.5)
    assert known.deviations(50.0) == pytest.approx(10.0 / np.sqrt(2.5), rel=1e-3)


@given(GAINS, st.floats(0.0, 50.0), st.floats(1.0, 96.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_the_less_of_a_gain_lies_in_rows_the_less_stretches_take_from_it(gain, scatter, stretches, one, two):
    less, more = sorted((one, two))
    by_less, by_more = (OverTime(scatter, stretches, each).deviations(gain) for each in (less, more))
    # to the accuracy of the normal deviation
    assert by_more <= 1.001 * by_less


class _White:
    """Noise of one standard deviation."""

    whiten = staticmethod(lambda left: left)


class _Recording:
    sample_time = 1.0

    def __len__(self):
        return ROWS


def _over_time(left, change, by_calibration=0.0):
    """Of one channel: what a model leaves, and what is left beside without its effect."""
    clock = np.arange(ROWS, dtype=float)
    problem = SimpleNamespace(
        noise={"flow": _White()},
        recording=_Recording(),
        plain=SimpleNamespace(clock=clock),
        residuals=lambda model: {"flow": left if model.terms else left + change},
    )
    by_rows = losses_of(_White(), left + change).sum() - losses_of(_White(), left).sum()
    model = SimpleNamespace(terms=(1,), log_likelihood=by_rows + by_calibration)
    return OverTime.of(problem, model, SimpleNamespace(terms=(), log_likelihood=0.0))


def _fitted(left, change):
    """Residuals after the least squares fit of a change."""
    return left - change * (left @ change) / (change @ change)


def test_white_noise_scatters_by_a_little_less_than_one():
    rng = np.random.default_rng(1)
    change = 0.1 * np.sin(np.arange(ROWS) / 7.0)
    scatters = []
    for _ in range(40):
        over_time = _over_time(_fitted(rng.standard_normal(ROWS), change), change)
        assert over_time.stretches == pytest.approx(ROWS / SPAN, rel=0.05)
        scatters.append(over_time.scatter)
    # the mean of 40 times some 60 squares; far residuals weigh less than they hold
    assert np.mean(scatters) == pytest.approx(0.85, abs=0.1)


def test_an_error_that_lasts_scatters_by_more():
    rng = np.random.default_rng(2)
    change = np.ones(ROWS)
    lasting = np.repeat(rng.standard_normal(ROWS // SPAN), SPAN)
    left = _fitted(rng.standard_normal(ROWS) + lasting, change)
    assert _over_time(left, change).scatter > 10.0


def test_one_event_is_one_stretch():
    change = np.zeros(ROWS)
    change[1000:1010] = 5.0
    over_time = _over_time(np.zeros(ROWS), change)
    assert (over_time.scatter, over_time.stretches) == (0.0, pytest.approx(1.0))


def test_what_changes_nothing_is_not_known_by_its_stretches():
    assert _over_time(np.ones(ROWS), np.zeros(ROWS)) == OverTime()


def test_a_large_effect_may_be_wrong_by_the_share_that_equations_are():
    rng = np.random.default_rng(3)
    change = 5.0 * np.ones(ROWS)
    # each stretch asks for another size of it
    wrong = change * np.repeat(SHARE_WRONG * rng.standard_normal(ROWS // SPAN), SPAN)
    over_time = _over_time(_fitted(wrong, change), change)
    assert over_time.scatter == pytest.approx(1.0, rel=0.4)
    assert over_time.of_rows == 1.0


def test_what_the_calibration_gains_is_no_gain_of_rows():
    rng = np.random.default_rng(4)
    left, change = rng.standard_normal(ROWS), 0.1 * np.ones(ROWS)
    by_rows = losses_of(_White(), left + change).sum() - losses_of(_White(), left).sum()
    over_time = _over_time(left, change, by_calibration=abs(by_rows))
    assert over_time.of_rows == pytest.approx(0.5 if by_rows > 0.0 else 1.0)
