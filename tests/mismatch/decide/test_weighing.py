# SPDX-License-Identifier: BSD-3-Clause
"""A change at one time that a finding makes is evidence by itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.decide import case as of_case
from sklvalve.mismatch.decide import weighing
from sklvalve.mismatch.decide.case import Case
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.residual.change import Change
from sklvalve.mismatch.search.rivals import Finding, Rival

EFFECTS = {e.key: e for e in CATALOGUE}
JUMP = Change("flow", 1733, (1731, 1736), -0.05, 0.0, 1e-9)


def finding(key, onset, *switches, size=0.05, channel="flow"):
    term = Term(EFFECTS[key], onset, switches)
    return Finding(term, [Rival(term, None, 1.0, 0.0)], 50.0, {channel: size})


def case_of(monkeypatch, *changes, channels=None):
    """A case whose simulation without effects leaves changes over, of which 0.01 counts."""
    looked = []
    monkeypatch.setattr(of_case, "find_changes", lambda problem, model: looked.append(1) or changes)
    problem = SimpleNamespace(
        least=lambda channel: 0.01, spans={"flow": 1.0, "opening": 1.0}, channels=("opening", "flow")
    )
    nominal = SimpleNamespace(chain=SimpleNamespace(clock=100.0 + np.arange(4000.0)))
    explanation = SimpleNamespace(problem=problem, nominal=nominal)
    return Case(explanation, None, None, 0.01, 0, channels), looked


@pytest.mark.parametrize("row", [1730, 1733, 1737])
def test_a_finding_that_begins_with_the_change_makes_it(monkeypatch, row):
    case, _ = case_of(monkeypatch, JUMP)
    assert case.change_by([finding("friction", None), finding("flow_meter_bias", 100.0 + row)]) is JUMP


@pytest.mark.parametrize("row", [1728, 1739, 2500])
def test_a_finding_that_begins_at_another_time_does_not(monkeypatch, row):
    case, _ = case_of(monkeypatch, JUMP)
    assert case.change_by([finding("flow_meter_bias", 100.0 + row)]) is None


def test_a_spell_that_ends_with_the_change_makes_it(monkeypatch):
    case, _ = case_of(monkeypatch, JUMP)
    assert case.change_by([finding("flow_meter_bias", 600.0, 1833.0)]) is JUMP


def test_what_acts_throughout_or_grows_makes_no_change_and_none_is_looked_for(monkeypatch):
    case, looked = case_of(monkeypatch, JUMP)
    assert case.change_by([]) is None
    assert case.change_by([finding("flow_meter_bias", None), finding("flow_meter_drift", 1833.0)]) is None
    assert not looked


def test_a_name_that_acts_throughout_makes_none_though_a_rival_begins_with_it(monkeypatch):
    case, _ = case_of(monkeypatch, JUMP)
    begun, named = Term(EFFECTS["flow_meter_bias"], 1833.0), Term(EFFECTS["seat_leakage"], None)
    rivals = [Rival(named, None, 0.7, 0.0), Rival(begun, None, 0.3, 1.0)]
    assert case.change_by([Finding(begun, rivals, 50.0, {"flow": 0.05})]) is None


def test_an_effect_that_hardly_moves_the_signal_does_not_make_it(monkeypatch):
    case, _ = case_of(monkeypatch, JUMP)
    assert case.change_by([finding("position_sensor_bias", 1833.0, channel="opening")]) is None
    assert case.change_by([finding("flow_meter_bias", 1833.0, size=0.009)]) is None


def test_a_clearer_change_of_another_signal_hides_none(monkeypatch):
    slip = Change("opening", 500, (499, 502), 0.05, 0.0, 1e-12)
    case, _ = case_of(monkeypatch, slip, JUMP)
    assert case.change_by([finding("flow_meter_bias", 1833.0)]) is JUMP
    # events explain the opening: what is left of it counts for nothing else
    case, _ = case_of(monkeypatch, slip, channels=("flow",))
    assert case.change_by([finding("position_sensor_bias", 600.0, channel="opening")]) is None


@pytest.mark.parametrize(
    "change",
    [
        Change("flow", 1733, (1731, 1736), -0.015, 0.0, 1e-9),
        Change("flow", 1733, (1731, 1736), -0.05, 0.0, 2e-3),
    ],
)
def test_a_change_that_is_small_or_no_rarity_tells_nothing(monkeypatch, change):
    case, _ = case_of(monkeypatch, change)
    assert case.change_by([finding("flow_meter_bias", 1833.0)]) is None


@pytest.mark.parametrize(("change", "p_value"), [(None, 0.2), (JUMP, 1e-9)])
def test_the_p_value_is_that_of_the_change_where_it_is_rarer(monkeypatch, change, p_value):
    monkeypatch.setattr(weighing, "effect_sizes", lambda *args: {})
    monkeypatch.setattr(weighing, "law_for", lambda problem: None)
    monkeypatch.setattr(weighing, "Evidence", SimpleNamespace(of=lambda *args: None))
    monkeypatch.setattr(weighing, "mismatch_p_value", lambda evidence: 0.2)
    monkeypatch.setattr(weighing, "leaves_rare", lambda case, evidence: False)
    monkeypatch.setattr(weighing, "p_value_of_what_counts", lambda *args: None)
    case = SimpleNamespace(
        residual_of=lambda model: SimpleNamespace(unknown=None, strong=None, new=None),
        explanation=SimpleNamespace(tried={}),
        problem=None,
        covariates=None,
        alpha=0.01,
        is_rare=lambda finding: False,
        change_by=lambda findings: change,
    )
    weighed = weighing.weigh(case, [finding("flow_meter_bias", 1833.0)], None)
    assert weighed.p_value == p_value
    assert weighed.enough == (change is not None)
