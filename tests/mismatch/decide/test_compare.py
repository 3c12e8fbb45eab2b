# SPDX-License-Identifier: BSD-3-Clause
"""The table of hypotheses: what it holds of a simulated fault, and of a healthy valve."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import CATALOGUE
from sklvalve.mismatch.constants import IN_CLASS
from sklvalve.mismatch.decide import compare, rules
from sklvalve.mismatch.decide.compare import Comparison, HeldOut, Row, compared
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.search.rivals import Finding, Rival
from sklvalve.mismatch.search.taking_up import Tried
from sklvalve.recording import Recording, Valve

BY_KEY = {effect.key: effect for effect in CATALOGUE}


@pytest.fixture(scope="module")
def finder():
    made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=1500, n_later=0, random_state=3)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    return MissingPhysicsFinder(n_jobs=1).fit(recording)


def test_the_best_row_is_the_fault_and_nothing_is_in_the_table(finder):
    table = finder.comparison_
    first = table[table.place == 1]
    assert list(first["rank"][:-1]) == list(range(1, len(first)))
    assert first.iloc[0].hypothesis == "clogging"
    assert first.iloc[0].in_class
    nothing = first[first.hypothesis == "nothing"].iloc[0]
    assert nothing.log_likelihood == 0.0
    assert nothing.posterior < 1e-6
    assert first.posterior.is_monotonic_decreasing
    assert first.posterior.sum() <= 1.0 + 1e-3


def test_the_posterior_follows_from_the_columns_beside_it(finder):
    first = finder.comparison_.query("place == 1 and hypothesis != 'nothing'")
    assert first.tempering.nunique() == 1
    assert first.tempering.iloc[0] > 1.0
    behind = (first.log_evidence - first.log_evidence.iloc[0]) / first.tempering
    expected = first.posterior.iloc[0] * np.exp(behind)
    # numbers of the table have four digits
    digits = 5e-4 * first.log_evidence.abs().max() / first.tempering.iloc[0]
    assert (np.log(first.posterior / expected).abs() < 2.0 * digits).all()


def test_the_best_row_predicts_rows_left_out_of_its_fit(finder):
    best = finder.comparison_.iloc[0]
    assert best.held_out_gain > 2.0 * best.held_out_se > 0.0
    assert best.size_over_relevance > 1.0


def test_classes_are_those_of_the_table(finder):
    content = finder.diagnosis_.content
    inside = {row["hypothesis"] for row in content["comparison"] if row["place"] == 1 and row["in_class"]}
    assert {m["name"] for m in content["effects"][0]["members"]} == inside


def test_the_rules_that_were_asked_are_in_the_diagnosis(finder):
    told = finder.diagnosis_.content["rules"]
    names = [rule["name"] for rule in told]
    assert names == [name for name in rules.ORDER if name in names]
    assert {"data", "rarity", "held_out", "probability"} <= set(names)
    assert all(rule["passed"] for rule in told)
    json.dumps(told, allow_nan=False)


def test_of_a_healthy_valve_what_was_tried_is_told_and_rarity_stops_it():
    made = make_valve_recording(None, loop="wide", n_samples=1200, n_later=0, random_state=1)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    content = MissingPhysicsFinder(n_jobs=1).fit(recording).diagnosis_.content
    assert content["verdict"] == "no_mismatch"
    assert any(row["hypothesis"] == "nothing" for row in content["comparison"])
    failed = {rule["name"] for rule in content["rules"] if not rule["passed"]}
    assert failed & {"rarity", "relevance"}


def _row(place, rank=1):
    return Row(
        place, rank, "clogging", "clogging", "throughout", True, "flow", 0.1, None, 20.0, 5.0, 4.0, 0.9
    )


def test_tables_are_put_behind_one_another_with_places_of_their_own():
    both = Comparison((_row(1), _row(2))).behind(Comparison((_row(1), _row(1, 2))))
    assert [(row.place, row.rank) for row in both.rows] == [(1, 1), (1, 2), (2, 1), (3, 1)]


def _finding(key, *rivals, gain=30.0):
    made = [
        Rival(Term(BY_KEY[k]), SimpleNamespace(log_likelihood=ll, spreads={}, values={}, chain=None), p, 0.0)
        for k, ll, p in rivals
    ]
    return Finding(Term(BY_KEY[key]), made, gain, {"flow": 0.05})


def test_places_follow_the_effects_of_a_diagnosis(monkeypatch):
    monkeypatch.setattr(compare, "_relative_spread", lambda one: None)
    search = Comparison((_row(1), replace(_row(2), hypothesis="erosion", form="erosion")))
    events = _finding("stiction", ("stiction", -5.0, 0.6), ("friction", -5.0, 0.4), gain=0.0)
    erosion = _finding("erosion", ("erosion", -5.0, 1.0))
    rows = search.in_order_of(_bench(), [events, erosion]).rows
    assert [(r.place, r.hypothesis, r.stands) for r in rows] == [
        (1, "stiction", True),
        (1, "friction", True),
        (2, "erosion", True),
        (3, "clogging", False),
    ]
    assert rows[0].log_likelihood is None
    assert [r.in_class for r in rows[:2]] == [True, True]
    known = Comparison().in_order_of(_bench(), [erosion]).rows
    assert (known[0].log_likelihood, known[0].rank) == (30.0, 1)


def test_a_place_is_found_by_the_likeliest_effect_of_a_finding(monkeypatch):
    monkeypatch.setattr(compare, "_relative_spread", lambda one: None)
    # what was taken up first may be less likely, by its own noise, than others of its place
    finding = _finding("seat_leakage", ("seat_leakage", -2.0, 0.02), ("clogging", -5.0, 0.98))
    rows = Comparison((_row(1),)).in_order_of(_bench(), [finding]).rows
    assert [(r.place, r.hypothesis, r.stands) for r in rows] == [(1, "clogging", True)]


def test_rivals_are_told_apart_by_what_each_gains_by_its_own_noise(monkeypatch):
    monkeypatch.setattr(compare, "_relative_spread", lambda one: None)
    finding = _finding("erosion", ("erosion", -90.0, 0.7), ("clogging", -5.0, 0.3), gain=50.0)
    finding = replace(
        finding, rivals=[replace(r, gain=g) for r, g in zip(finding.rivals, (20.0, 12.0), strict=True)]
    )
    rows = Comparison().in_order_of(_bench(), [finding]).rows
    assert [(r.hypothesis, r.log_likelihood) for r in rows] == [("erosion", 50.0), ("clogging", 42.0)]


def test_the_gain_on_rows_left_out_is_told_in_standard_errors():
    gained = [replace(_row(1, k), held_out_gain=g, held_out_se=4.0) for k, g in ((2, 12.0), (3, 2.0))]
    outside = replace(_row(1, 4), held_out_gain=80.0, held_out_se=4.0, in_class=False)
    table = Comparison((_row(1), *gained, outside, _row(2)))
    # a class predicts where one of its members does
    assert [table.held_out_errors(place) for place in (1, 2, 3)] == [3.0, 0.0, 0.0]


def _bench(**more):
    return SimpleNamespace(recording=range(3000), least=lambda channel: 0.005, **more)


def test_where_nothing_was_found_nothing_may_be_the_likeliest():
    tried = {"clogging": Tried(2.0, {"flow": 0.02}), "erosion": Tried(60.0, {"flow": 0.01})}
    effects = (BY_KEY["clogging"], BY_KEY["erosion"])
    explanation = SimpleNamespace(problem=_bench(), findings=[], tried=tried, effects=effects)
    rows = compared(explanation, 15.0).rows
    assert [row.hypothesis for row in rows] == ["erosion", "nothing", "clogging"]
    assert [row.in_class for row in rows] == [True, False, False]
    assert sum(row.posterior for row in rows) == pytest.approx(1.0)
    assert rows[0].size_over_relevance == pytest.approx(2.0)
    # what gains less than an effect must add is less likely than nothing
    tried = {"erosion": Tried(20.0, {"flow": 0.01})}
    weak = SimpleNamespace(problem=_bench(), findings=[], tried=tried, effects=effects)
    assert compared(weak, 15.0).rows[0].hypothesis == "nothing"
    nothing = SimpleNamespace(problem=_bench(), findings=[], tried={}, effects=())
    alone = compared(nothing, 15.0).rows
    assert [row.hypothesis for row in alone] == ["nothing"]
    assert alone[0].posterior >= IN_CLASS


def test_gains_on_rows_left_out_are_summed_by_blocks(monkeypatch):
    losses = {"without": np.full(16, 5.0), "with": np.r_[np.full(8, 1.0), np.full(8, 3.0)]}
    held = HeldOut(_bench(), "without")
    monkeypatch.setattr(held, "_losses", lambda model: losses[model])
    gain, error = held.gain("with")
    assert gain == pytest.approx(48.0)
    assert error == pytest.approx(4.0 * np.std(losses["with"], ddof=1))
