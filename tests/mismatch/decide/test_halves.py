# SPDX-License-Identifier: BSD-3-Clause
"""What half of a recording says of a name that the whole of it gave."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.constants import DISTINGUISHABLE
from sklvalve.mismatch.decide import halves, judging, rules
from sklvalve.mismatch.decide.halves import refuted_by_a_half
from sklvalve.mismatch.decide.reasons import refuted
from sklvalve.mismatch.effects import BypassOpen, Clogging, SeatLeakage
from sklvalve.mismatch.inference.hypothesis import Model, Term, switches_of
from sklvalve.mismatch.search.rivals import Finding, Rival

NOTHING = "nothing"


def finding_of(*probable):
    """A finding with rivals as probable as told."""
    rivals = [
        Rival(Term(effect), Model((Term(effect),), None, {}, {}, 0.0, {}), probability, 0.0)
        for effect, probability in probable
    ]
    return Finding(rivals[0].term, rivals, 100.0, {})


class Halves:
    """A problem whose fits to the first and to the second half are as likely as told, by effect."""

    def __init__(self, rows=None, **likelihoods):
        self.recording, self.rows, self.likelihoods, self.asked = range(101), rows, likelihoods, []

    def fit(self, terms, *, start, rows, max_steps):
        self.asked.append(rows)
        name = terms[0].effect.key if terms else NOTHING
        return Model(tuple(terms), None, {}, {}, self.likelihoods[name][not rows[:50].any()], {})


@pytest.fixture(autouse=True)
def prices(monkeypatch):
    """Every time at which an effect begins or ends costs 10 nats."""
    monkeypatch.setattr(halves, "penalty_with_times", lambda problem, model, term: 10.0 * switches_of(term))


@pytest.mark.parametrize(
    ("leak", "bypass", "clogging", "nothing", "apart"),
    [
        # each half asks for the class; which of it is all the same
        ((50.0, 40.0), (45.0, 60.0), (9.0, 9.0), (0.0, 0.0), 0.0),
        # one half shows nothing of it, and less than nothing
        ((50.0, 0.5), (45.0, 0.3), (9.0, 0.8), (0.0, 0.0), 0.58),
        ((50.0, -9.0), (45.0, -9.0), (9.0, -3.0), (0.0, 0.0), 0.0),
        # one half is for what the whole refuses
        ((50.0, 40.0), (45.0, 30.0), (9.0, 90.0), (0.0, 0.0), 20.0),
        ((-20.0, 80.0), (-30.0, 70.0), (19.0, 9.0), (0.0, 0.0), 20.5),
        # a large effect is simulated with a large error
        ((50.0, 9000.0), (45.0, 30.0), (9.0, 9050.0), (0.0, 0.0), 0.25),
    ],
)
def test_a_half_that_excludes_a_class_is_told(leak, bypass, clogging, nothing, apart):
    problem = Halves(seat_leakage=leak, bypass_open=bypass, clogging=clogging, nothing=nothing)
    finding = finding_of((SeatLeakage(), 0.6), (BypassOpen(), 0.39), (Clogging(), 0.01))
    behind, instead = refuted_by_a_half(problem, finding, ())
    assert behind == pytest.approx(apart, rel=0.1)
    assert behind < 10.0 or instead == "clogging"


def test_a_rival_in_spells_pays_for_them_in_each_half():
    finding = finding_of((SeatLeakage(), 0.99), (Clogging(), 0.01))
    spells = replace(finding.rivals[1], term=Term(finding.rivals[1].term.effect, 10.0, (20.0, 30.0, 40.0)))
    problem = Halves(seat_leakage=(40.0, 10.0), clogging=(70.0, 10.0), nothing=(0.0, 0.0))
    assert refuted_by_a_half(problem, finding, ())[0] > DISTINGUISHABLE
    assert refuted_by_a_half(problem, replace(finding, rivals=[finding.rivals[0], spells]), ())[0] == 0.0


def test_rows_that_are_not_used_are_in_no_half():
    used = np.arange(101) % 2 == 0
    problem = Halves(used, seat_leakage=(1.0, 1.0), nothing=(0.0, 0.0))
    refuted_by_a_half(problem, finding_of((SeatLeakage(), 1.0)), ())
    assert {int(rows.sum()) for rows in problem.asked} == {25, 26}
    assert not any((rows & ~used).any() for rows in problem.asked)


def test_the_rule_and_its_reason_say_what_half_of_the_recording_asks_for():
    rule = rules.halves(DISTINGUISHABLE + 3.0)
    assert (rule.name, rule.passed, rule.limit) == ("held_out", False, DISTINGUISHABLE)
    assert "it lies 17 behind another explanation; from 14 on two are told apart" in rule.sentence
    finding = finding_of((SeatLeakage(), 1.0))
    assert "half of them by itself is better explained by dead time" in refuted([finding], "dead_time")


@pytest.mark.parametrize(("behind", "named"), [(13.0, True), (15.0, False)])
def test_the_strongest_finding_is_named_as_long_as_no_half_refutes_it(behind, named):
    finding = finding_of((SeatLeakage(), 1.0))
    case = SimpleNamespace(
        held_out_gain=lambda _: 9.0,
        refuted_by_a_half=lambda finding, others: (behind, "dead_time"),
        left_where_they_act=lambda findings, model: None,
    )
    asked, why = judging._of_fit(case, [finding], finding.rivals[0].model, None)
    assert ([rule.name for rule in asked], asked[0].passed) == (["held_out"], named)
    assert ("dead time" in why) is not named
