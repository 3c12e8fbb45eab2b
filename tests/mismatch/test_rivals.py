# SPDX-License-Identifier: BSD-3-Clause
"""How explanations in one place are weighed: by distance, and by what they are spared of the price."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch import CATALOGUE, rivals
from sklvalve.mismatch.hypothesis import SWITCH_PRICE, Member, begun

BY_KEY = {effect.key: effect for effect in CATALOGUE}
BENCH = SimpleNamespace(recording=range(3000))
# one parameter each, so that only switches differ in price
COMES_AND_GOES = Member(BY_KEY["position_sensor_gain"], 900.0, (1400.0, 2100.0))
STAYS = Member(BY_KEY["actuator_leak"], 900.0)
BEST = -100.0


def _weighed(monkeypatch, lost, distance, who=STAYS):
    """Log odds of the explanation in spells against one that loses so much, at this distance."""
    by_loss = {BEST: 0.0, BEST - lost: distance}
    monkeypatch.setattr(rivals, "_distance", lambda w, best, other, *_: by_loss[other.log_likelihood])
    places = [
        (COMES_AND_GOES, SimpleNamespace(log_likelihood=BEST)),
        (who, SimpleNamespace(log_likelihood=BEST - lost)),
    ]
    told = {r.member: r.probability for r in rivals.weighed(BENCH, places, None)}
    return float(np.log(told[COMES_AND_GOES] / told[who]))


@pytest.mark.parametrize("part", [1.0, 0.3])
def test_of_what_is_lost_and_of_what_is_spared_the_same_part_counts(monkeypatch, part):
    # two switches fewer; of the loss the distance counts a part, for no simulation is true
    lost, spared = 60.0, 2.0 * SWITCH_PRICE
    assert _weighed(monkeypatch, lost, 2.0 * part * lost) == pytest.approx(part * (lost - spared))


def test_what_loses_less_than_it_is_spared_is_likelier(monkeypatch):
    assert _weighed(monkeypatch, 5.0, 10.0) < 0.0
    assert _weighed(monkeypatch, 5.0, 3.0) < 0.0


def test_what_pays_for_the_same_switches_is_weighed_by_its_distance(monkeypatch):
    other = Member(BY_KEY["position_sensor_bias"], 900.0, (1400.0, 2100.0))
    assert _weighed(monkeypatch, 60.0, 20.0, other) == pytest.approx(10.0)


def test_what_cannot_begin_acts_throughout_in_the_place_of_what_began():
    fixed = next(e for e in CATALOGUE if not e.may_begin)
    assert begun(fixed, 400.0).times is begun(fixed, (400.0, 500.0)).times is None
    assert begun(STAYS.effect, (400.0, 500.0)).times == 400.0


def test_what_fits_as_well_is_spared_the_whole_price():
    assert rivals._not_spared(2, 0.0, 0.0) == 0.0
    assert rivals._not_spared(0, 5.0, 60.0) == 0.0
