# SPDX-License-Identifier: BSD-3-Clause
"""What a simulation gets wrong of an effect brings its explanation nearer to others."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.distance import DISTINGUISHABLE, SHARE_MISTAKEN
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.excitation import Explanation
from sklvalve.mismatch.hypothesis import Member
from sklvalve.mismatch.rivals import weighed

EFFECTS = {effect.key: effect for effect in CATALOGUE}
BARE, BIAS, RIVAL = (SimpleNamespace(log_likelihood=value) for value in (0.0, 300.0, 275.0))


def _distances(monkeypatch, *keys):
    monkeypatch.setattr("sklvalve.mismatch.rivals.price", lambda workbench, who: 0.0)
    places = [(Member(EFFECTS["flow_meter_bias"]), BIAS), *((Member(EFFECTS[k]), RIVAL) for k in keys)]
    return {r.member.effect.key: r.distance for r in weighed(None, places, BARE)}


def test_viscous_flow_in_the_place_of_another_is_granted_more(monkeypatch):
    found = _distances(monkeypatch, "clogging", "viscous_flow", "viscosity_change")
    assert found["flow_meter_bias"] == 0.0
    assert found["clogging"] == pytest.approx(50.0 / (1.0 + SHARE_MISTAKEN**2 * 600.0 / DISTINGUISHABLE))
    for key in ("viscous_flow", "viscosity_change"):
        assert found[key] == pytest.approx(50.0 / (1.0 + 0.3**2 * 600.0 / DISTINGUISHABLE))
        assert found[key] < DISTINGUISHABLE < found["clogging"]


@pytest.mark.parametrize(("key", "share"), [("clogging", SHARE_MISTAKEN), ("viscous_flow", 0.3)])
def test_the_next_test_is_planned_with_the_same_share(key, share):
    model = SimpleNamespace(members=(Member(EFFECTS["flow_meter_bias"]), Member(EFFECTS[key])))
    assert Explanation(EFFECTS[key].name, 0.5, model, []).mistaken == share
