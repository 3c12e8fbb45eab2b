# SPDX-License-Identifier: BSD-3-Clause
"""Probabilities of explanations whose simulations are all a little wrong."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sklvalve.mismatch.constants import IN_CLASS, SHARE_WRONG
from sklvalve.mismatch.inference.posterior import distance, posterior, smallest_class, temperature

_SCORES = st.lists(st.floats(-1e5, 0.0), min_size=1, max_size=12)


def test_a_weak_effect_is_weighed_by_its_likelihood_and_a_strong_one_by_its_share_of_the_gain():
    assert temperature(0.0) == temperature(-5.0) == 1.0
    odds = np.divide(*posterior([0.0, -3.0], gain=0.1))
    assert np.log(odds) == pytest.approx(3.0, rel=0.02)
    # of a gain so large that noise hardly counts, losing the same share has the same odds
    weak, strong = (np.divide(*posterior([0.0, -0.01 * gain], gain=gain)) for gain in (1e5, 1e7))
    assert (
        weak
        == pytest.approx(strong, rel=1e-2)
        == pytest.approx(np.exp(0.01 / (2.0 * SHARE_WRONG**2)), rel=1e-2)
    )


@given(_SCORES, st.floats(0.0, 1e7))
def test_probabilities_sum_to_one_and_keep_the_order(scores, gain):
    found = posterior(scores, gain)
    assert found.sum() == pytest.approx(1.0)
    order = np.argsort(scores)
    assert np.all(np.diff(found[order]) >= 0.0)


@given(_SCORES, st.floats(0.0, 1e6), st.floats(1.0, 1e6))
def test_a_larger_gain_never_makes_the_best_one_surer(scores, gain, more):
    assert posterior(scores, gain + more).max() <= posterior(scores, gain).max() + 1e-12


def test_distance_is_twice_the_lost_likelihood_by_the_temperature():
    assert distance(-10.0, -10.0, 50.0) == distance(-12.0, -10.0, 50.0) == 0.0
    assert distance(-10.0, -17.0, 0.0) == pytest.approx(14.0)
    assert distance(-10.0, -17.0, 500.0) == pytest.approx(14.0 / temperature(500.0))


def test_a_class_is_the_fewest_that_hold_enough():
    assert list(smallest_class({"a": 0.2, "b": 0.76, "c": 0.04})) == ["b", "a"]
    assert list(smallest_class({"a": 0.2, "b": 0.74, "c": 0.06})) == ["b", "a", "c"]
    assert list(smallest_class({"a": 1.0, "b": 0.0})) == ["a"]


@given(st.lists(st.floats(0.001, 1.0), min_size=1, max_size=10))
def test_a_class_holds_enough_and_no_member_is_spare(weights):
    among = np.array(weights) / np.sum(weights)
    held = smallest_class({str(k): float(p) for k, p in enumerate(among)})
    assert sum(held.values()) >= IN_CLASS - 1e-9
    assert sum(held.values()) - min(held.values()) < IN_CLASS
