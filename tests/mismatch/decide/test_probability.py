# SPDX-License-Identifier: BSD-3-Clause
"""How often names hold: what raises and lowers it, and where no name is given."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.mismatch.decide.borne_out import SEALED, USUAL_P, Numbers
from sklvalve.mismatch.decide.probability import (
    Grounds,
    is_coarse,
    left_over,
    log_odds_of_name,
    probability_of,
    vanishing,
    without_interval,
)
from sklvalve.mismatch.effects import CATALOGUE, EVENTS

USUAL = Grounds("backlash", USUAL_P)
FORMS = {effect.key: effect for effect in (*CATALOGUE, *EVENTS)}


def test_by_hand():
    numbers = Numbers(1.0, 0.5, (0.3, -0.6, -0.9, -1.2), (0.2, 0.5), {"a": (24, 24), "b": (8, 16)})
    # "b" is drawn towards the usual share, 32 of 40, by eight classes more: (8 + 6.4) / 24 = 0.6
    of_b = np.log(0.6 / 0.4) - np.log(0.8 / 0.2)
    assert log_odds_of_name("b", numbers.held) == pytest.approx(of_b)
    assert log_odds_of_name("never seen", numbers.held) == pytest.approx(0.0)
    grounds = Grounds("b", 0.1 * USUAL_P, beside=True, coarse=True, may_vanish=True)
    odds = 1.0 + 0.5 * of_b + 0.3 - 0.6 - 0.9 - 1.2
    assert probability_of(grounds, numbers) == pytest.approx(1.0 / (1.0 + np.exp(-odds)))
    few = replace(grounds, few_signals=True)
    assert probability_of(few, numbers) == pytest.approx(1.0 / (1.0 + np.exp(-(0.2 + 0.5 * odds))))


def test_what_speaks_against_a_name_lowers_its_probability():
    usual = probability_of(USUAL)
    for change in ({"beside": True}, {"coarse": True}, {"may_vanish": True}, {"few_signals": True}):
        assert probability_of(replace(USUAL, **change)) < usual
    assert probability_of(replace(USUAL, p_value=0.01)) < usual < probability_of(replace(USUAL, p_value=1e-9))
    assert probability_of(replace(USUAL, leading="rod_bend")) < usual


def test_it_spreads():
    worst = Grounds("rod_bend", 0.01, beside=True, coarse=True)
    assert probability_of(worst) < 0.4 < probability_of(Grounds("friction", 1e-4)) < 0.8
    assert NAMED_FROM < 0.95 < probability_of(Grounds("dead_time", 1e-6))


def test_what_a_class_leaves_of_its_difference_lowers_its_probability():
    numbers = Numbers(1.0, 0.0, (0.0,) * 4, (0.0, 1.0), {"a": (1, 2)}, left_over=(0.5, -0.1))
    said = probability_of(Grounds("a", USUAL_P, left=20.0), numbers)
    assert said == pytest.approx(1.0 / (1.0 + np.exp(-(1.0 + 0.5 - 0.1 * 20.0))))
    assert (
        probability_of(replace(USUAL, left=20.0))
        < probability_of(USUAL)
        < probability_of(replace(USUAL, left=0.0))
    )


def test_what_is_left_by_hand():
    # of 200 nats, of which a tenth counts: T = 1 + 2 * 0.15^2 * 200 = 10
    assert left_over(200.0, 0.5) == pytest.approx(100.0 / 10.0)
    assert left_over(200.0, 1.2) == 0.0
    assert left_over(200.0, -0.1) == pytest.approx(220.0 / 10.0)
    assert left_over(200.0, -300.0) == pytest.approx(400.0 / 10.0)
    # no forecast, nothing gained, or no number: it is not known
    for gain, skill in ((200.0, None), (0.0, 0.0), (np.nan, 0.5), (np.inf, 0.5), (200.0, np.nan)):
        assert left_over(gain, skill) is None
    # what an equation gets wrong of a large difference is no reason against it
    assert left_over(20_000.0, 0.98) < left_over(200.0, 0.9)


def test_names_of_the_table_are_those_of_the_catalogue():
    assert set(SEALED.held) <= {effect.name for effect in FORMS.values()}
    assert all(0 <= right <= many for right, many in SEALED.held.values())


def test_coarse_values():
    def told(finding, role):
        return [{"finding": finding, "role": role}]

    assert is_coarse(told("compressed", "p1"))
    assert is_coarse(told("quantised", "opening"))
    assert not is_coarse(told("quantised", "p1"))
    assert not is_coarse([])


# ---- an interval that holds the value at which an effect vanishes


def _intervals(**ends):
    return {name: {"ci95": ci} for name, ci in ends.items()}


@pytest.mark.parametrize(
    ("key", "ends", "names"),
    [
        ("flow_meter_bias", {"bias": [-0.1, 0.2]}, ["bias"]),
        ("flow_meter_bias", {"bias": [0.1, 0.2]}, []),
        ("flow_meter_bias", {"bias": None}, []),
        ("external_leakage", {"leak_kv": [0.0, 2.9]}, ["leak_kv"]),
        # of a ratio it is one
        ("density_change", {"ratio": [0.95, 1.02]}, ["ratio"]),
        ("density_change", {"ratio": [1.05, 1.2]}, []),
        # both must be able to vanish
        ("transducer_fault", {"gain": [-0.1, 0.1], "bias": [0.02, 0.05]}, []),
        ("transducer_fault", {"gain": [-0.1, 0.1], "bias": [-0.02, 0.05]}, ["gain", "bias"]),
        # how a play begins is no size of it, and a limit of speed has no value at which it is none
        ("backlash", {"width": [0.01, 0.03], "overshoot": [0.0, 0.3], "first_side": [-1.0, 1.0]}, []),
        ("slew_limit", {"speed": [0.001, 1.0], "closing_ratio": [0.25, 4.0]}, []),
    ],
)
def test_vanishing(key, ends, names):
    assert vanishing(FORMS[key], _intervals(**ends)) == names


@pytest.mark.parametrize(
    ("key", "ends", "names"),
    [
        ("flow_meter_bias", {"bias": None}, ["bias"]),
        ("flow_meter_bias", {"bias": [-0.1, 0.2]}, []),
        ("transducer_fault", {"gain": None, "bias": None}, ["gain", "bias"]),
        ("transducer_fault", {"gain": None, "bias": [-0.02, 0.05]}, []),
        ("backlash", {"width": None, "overshoot": None, "first_side": None}, ["width"]),
        # a limit of speed has no value at which it is none
        ("slew_limit", {"speed": None, "closing_ratio": None}, []),
    ],
)
def test_without_interval(key, ends, names):
    assert without_interval(FORMS[key], _intervals(**ends)) == names


def test_every_size_that_has_a_null_value_can_reach_it_or_come_near():
    for effect in FORMS.values():
        for quantity in effect.parameters:
            if quantity.null is not None:
                low, high = min(quantity.low, 0.0), quantity.high * (1.1 if quantity.log else 1.0)
                assert low <= quantity.null <= high, (effect.key, quantity.name)
