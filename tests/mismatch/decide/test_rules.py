# SPDX-License-Identifier: BSD-3-Clause
"""The list of rules: each with value, limit, outcome and a sentence, in one order."""

import json

import pytest

from sklvalve.mismatch import constants
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.records import plain_records

EVERY = [
    rules.probability(0.7, True),
    rules.black_box(0.9, 1.25, True),
    rules.forecast(-3.0, 0.5, 1.0),
    rules.noise(0.8, True),
    rules.residual(0.01, 0.05),
    rules.history_noise(0.4),
    rules.held_out(4.0),
    rules.relevance(1e-6, 0.01),
    rules.rarity(1e-6, 0.01),
    rules.data(None),
]


def test_there_are_ten_and_they_come_in_their_order():
    assert len(rules.ORDER) == 10
    told = rules.in_order(EVERY)
    assert [rule.name for rule in told] == list(rules.ORDER)
    assert all(rule.passed for rule in told)


def test_of_a_rule_asked_twice_the_last_outcome_counts():
    told = rules.in_order([rules.rarity(0.5, 0.01), rules.rarity(1e-4, 0.01)])
    assert [rule.value for rule in told] == [1e-4]


@pytest.mark.parametrize(
    "rule",
    [
        rules.data("Exchange p1 and p2."),
        rules.rarity(0.02, 0.01),
        rules.relevance(0.02, 0.01),
        rules.held_out(constants.HELD_OUT_ERRORS - 0.1),
        rules.history_noise(constants.NO_IMITATION - 0.001),
        rules.residual(0.05, 0.05),
        rules.residual(0.05, 0.0),
        rules.pattern(0.96, "opening and dp"),
        rules.noise(1.4, False),
        rules.forecast(constants.FORECAST_ERRORS + 0.1, 1.1, 1.0),
        rules.black_box(1.3, constants.MARGIN, False),
        rules.probability(0.5, False),
        rules.probability(None, False),
    ],
    ids=lambda rule: rule.name,
)
def test_what_stops_a_name_says_how_far_off_it_was(rule):
    assert not rule.passed
    assert rule.sentence.endswith(".")
    if rule.value is not None:
        assert rule.limit is not None
    json.dumps(plain_records([rule]), allow_nan=False)


def test_a_rule_off_its_side_says_why():
    assert "wander" in rules.noise(1.6, True).sentence
    assert "two slow effects" in rules.noise(0.4, False).sentence
    assert "Too few rows" in rules.noise(None, False).sentence
    assert "something else is missing" in rules.black_box(1.5, 1.25, True, beside=True).sentence
    weak = rules.probability(0.9, False, "The interval of its bias includes the value of no effect.")
    assert weak.sentence.startswith("The interval of its bias")


def test_what_is_named_by_events_is_not_held_against_the_rules_on_a_fit():
    told = rules.without([rules.relevance(1.0, 0.01), rules.rarity(1e-6, 0.01)], rules.OF_A_FIT)
    assert [rule.name for rule in told] == ["rarity"]


def test_numbers_that_are_none_are_no_json():
    (plain,) = plain_records([rules.rarity(float("nan"), 0.01)])
    assert plain["value"] is None


def test_shares_are_told_without_exponents():
    assert "less than 0.01 %" in rules.rarity(1e-9, 0.01).sentence
    assert "100 %" in rules.relevance(1.0, 0.01).sentence
