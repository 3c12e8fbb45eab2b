# SPDX-License-Identifier: BSD-3-Clause
"""Intervals of parameters by their two parts."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch.distance import SHARE_MISTAKEN
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.hypothesis import Member
from sklvalve.mismatch.intervals import interval_of
from sklvalve.mismatch.workbench import Workbench
from sklvalve.simulation import Tolerance

BY_KEY = {e.key: e for e in CATALOGUE}


@pytest.fixture(scope="module")
def bench(healthy):
    return Workbench(healthy, Tolerance(), ())


def _fitted(bench, key, own, spreads):
    member = Member(BY_KEY[key])
    nominal = bench.fit((), max_steps=2)
    values = nominal.values | {f"{key}.{name}": value for name, value in own.items()}
    model = replace(bench.simulate((member,), values), spreads={f"{key}.{n}": s for n, s in spreads.items()})
    return member, model


@pytest.mark.parametrize("spread", [0.0, 2e-5, 2e-4])
def test_of_what_acts_in_proportion_the_share_is_that_of_its_value(bench, spread):
    member, model = _fitted(bench, "flow_meter_bias", {"bias": 4e-4}, {"bias": spread})
    low, high = interval_of(bench, member, model, member.effect.quantities(model.chain)[0])
    half = np.hypot(1.96 * spread, SHARE_MISTAKEN * 4e-4)
    np.testing.assert_allclose([low, high], [4e-4 - half, 4e-4 + half], rtol=1e-6)


def test_of_a_limit_it_is_as_far_as_changes_the_effect_by_its_share(bench):
    member, model = _fitted(bench, "clogging", {"limit": 0.5}, {"limit": 1e-4})
    low, high = interval_of(bench, member, model, member.effect.quantities(model.chain)[0])
    assert 0.4 < low < 0.5 < high < 0.6
    own = model.predictions["flow"]
    none = bench.simulate((), model.values).predictions["flow"]
    moved = bench.simulate(model.members, model.values | {"clogging.limit": high}).predictions["flow"]
    share = np.sqrt(np.nanmean((moved - own) ** 2) / np.nanmean((own - none) ** 2))
    assert share == pytest.approx(SHARE_MISTAKEN, rel=0.25)


def test_without_a_deviation_there_is_no_interval_and_none_leaves_what_is_possible(bench):
    member, model = _fitted(bench, "clogging", {"limit": 0.5}, {})
    quantity = member.effect.quantities(model.chain)[0]
    assert interval_of(bench, member, model, quantity) is None
    member, model = _fitted(bench, "clogging", {"limit": 0.5}, {"limit": 10.0})
    assert interval_of(bench, member, model, quantity) == (quantity.low, quantity.high)
