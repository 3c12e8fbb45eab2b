# SPDX-License-Identifier: BSD-3-Clause
"""The test that a diagnosis asks for tells what it says it would, and asking never costs the diagnosis."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from benchmarks.next_test import Stand
from sklvalve.mismatch import MissingPhysicsFinder, TestLimits, plan_next_test
from sklvalve.mismatch.advice import reopened
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.next_test.excitation import Advisor, Answer, Explanation
from sklvalve.mismatch.next_test.plan import (
    SURE,
    Pair,
    apart,
    appreciable,
    confusion,
    distances_in_words,
    sentence_of,
)
from sklvalve.mismatch.next_test.planning import _Choice, planned
from sklvalve.mismatch.next_test.programs import library
from sklvalve.mismatch.next_test.suggestions import next_test, plan_of
from sklvalve.recording import InputError

EFFECTS = {e.key: e for e in CATALOGUE}
PAIR = ("seat_leakage", "flow_meter_bias")


@pytest.fixture(scope="module")
def stand():
    return Stand({"seat_leakage": 0.0375}, 21, rows=1200)


@pytest.fixture(scope="module")
def found(stand):
    return MissingPhysicsFinder(effects=list(PAIR)).fit(stand.recording)


@pytest.fixture(scope="module")
def plan(stand, found):
    return plan_next_test(found, stand.recording)


@pytest.fixture(scope="module")
def lags():
    """Two lags that a flow alone does not tell apart, on a problem without a position."""
    recording = Stand({"actuator_lag": 10.0}, 5, rows=900).recording
    signals = {role: values for role, values in recording.signals.items() if role != "opening"}
    problem = prepared_problem(replace(recording, signals=signals))
    problem, nominal = calibrated(problem)
    models = [problem.fit((Term(EFFECTS[k]),), start=nominal) for k in ("actuator_lag", "sensor_lag")]
    problem = problem.with_noise_of(models[0])
    models = [problem.fit(m.terms, start=m) for m in models]
    bare = problem.fit((), start=nominal)
    explanations = [Explanation(m.keys[0], 0.5, m, problem.misfits(m, ("flow",))) for m in models]
    without = Explanation("without", 0.0, bare, problem.misfits(bare, ("flow",)))
    gain = models[0].log_likelihood - bare.log_likelihood
    return Advisor(problem, explanations, without, gain)


@pytest.mark.slow
def test_the_test_asked_for_leaves_a_smaller_class(stand, found, plan):
    assert set(found.diagnosis_.effects[0]) == set(PAIR)
    assert plan.pairs[0].expected > 14.0
    assert plan.moved  # at one pressure drop a leak and a zero are the same
    # one level of the command is as good as another near it; what is moved, and how far, is not
    moves = plan.sentence.split(":")[0].split("at each move ")[1]
    assert moves.startswith("the outlet pressure")
    assert f"at each move {moves}:" in found.diagnosis_.content["next_test"]
    both = stand.tested(plan)
    again = MissingPhysicsFinder(effects=list(PAIR)).fit(both)
    assert again.diagnosis_.effects == (("seat_leakage",),)
    _, (finding,) = reopened(again, both, names=PAIR)
    reached = {r.term.effect.name: r.distance for r in finding.rivals}["flow_meter_bias"]
    # what was expected of it where a leak is the truth; another plant may move its pressures further
    expected = plan.pairs[0].if_true[plan.pairs[0].names.index("seat_leakage")]
    assert reached > max(14.0, 0.5 * expected)


@pytest.mark.slow
def test_a_plan_tells_what_to_do_and_what_comes_of_it(stand, plan):
    (pair,) = plan.pairs
    assert set(pair.names) == set(PAIR)
    assert pair.now < 14.0 <= pair.expected
    assert pair.confusion == pytest.approx(confusion(pair.expected))
    assert plan.time.shape == plan.command.shape == plan.moved["p2"].shape
    assert np.diff(plan.time) == pytest.approx(1.0)
    drop = np.median(stand.recording["p1"] - stand.recording["p2"])
    # a third of the drop would leave the two too near one another
    assert np.abs(plan.moved["p2"]).max() == pytest.approx(0.6 * drop)
    assert "outlet pressure" in plan.sentence
    # what a simulation gets wrong leaves a chance of confusion, and it is told
    assert "% of cases (" in plan.sentence
    assert plan.considered["slow triangle"] < plan.considered["p2 moved"]


@pytest.mark.slow
def test_within_limits_no_pressure_moves_and_the_command_stays_inside(stand, found):
    limits = TestLimits(opening=(0.2, 0.6), rate=0.01, duration=300.0)
    plan = plan_next_test(found, stand.recording, limits=limits)
    # far from the seat, at the same pressures, no command tells them apart
    assert plan is None or not plan.decides
    problem, findings = reopened(found, stand.recording)
    wider = planned(problem, findings, TestLimits(opening=(0.0, 1.0), pressures=("p1", "p2"), duration=300.0))
    assert len(wider.command) == 300
    assert set(wider.moved) <= {"p1", "p2"}


@pytest.mark.slow
def test_a_plan_is_the_same_every_time(stand, found, plan):
    again = plan_next_test(found, stand.recording)
    assert again.sentence == plan.sentence
    assert np.array_equal(again.command, plan.command)


@pytest.mark.slow
def test_one_explanation_alone_gets_the_program_that_narrows_its_interval():
    late = Stand({"dead_time": 6.75}, 12, loop="closed", rows=900).recording
    plan = plan_next_test(MissingPhysicsFinder(effects=["dead_time"]).fit(late), late)
    assert plan.pairs == ()
    # a late command shows where it changes at once, and hardly where it stays about one place
    # which of the two is ahead hangs on the last digits of the fit
    assert plan.name in ("square", "steps")
    assert 0.0 < plan.considered["square"] < 0.7 * plan.considered["reversals"]
    assert "narrow the 95 % interval of the delay (dead time)" in plan.sentence
    assert EFFECTS["dead_time"].separated_by in plan.sentence


def test_a_stem_sensor_tells_lags_apart_that_flow_confuses(lags):
    square = next(p for p in library(0.1, 0.9, 0.5, 400, 1.0, TestLimits()) if p.name == "square")
    without, sensed = lags.distances(square), lags.distances(square, "opening")
    assert min(sensed[0, 1], sensed[1, 0]) > max(14.0, 2.0 * min(without[0, 1], without[1, 0]))


def test_a_rival_answers_no_worse_the_more_often_it_is_asked(lags):
    square = next(p for p in library(0.1, 0.9, 0.5, 400, 1.0, TestLimits()) if p.name == "square")
    record = lags.records(square)[0]
    own, rival = (Answer(record, e) for e in lags.explanations)
    assert own.least(own.slopes(), 1) == pytest.approx(0.0, abs=0.1)
    costs = [rival.least(rival.slopes(), rounds) for rounds in (0, 1, 3)]
    assert costs[0] > costs[1] >= costs[2] > 0.0


@pytest.mark.slow
def test_the_finder_has_the_plan_that_its_diagnosis_asks_for(found):
    assert found.next_test_.sentence == found.diagnosis_.content["next_test"]
    assert {name for pair in found.next_test_.pairs for name in pair.names} == set(PAIR)


@pytest.mark.slow
def test_nothing_found_and_nothing_simulated_need_no_plan(stand, found):
    nothing = SimpleNamespace(recording=stand.recording)
    assert planned(nothing, []) is None
    loop = MissingPhysicsFinder()
    loop.diagnosis_ = found.diagnosis_
    with pytest.raises(InputError, match="where the valve is simulated"):
        plan_next_test(loop, stand.recording)


@pytest.mark.slow
def test_too_short_a_test_is_refused_in_one_sentence(stand, found):
    with pytest.raises(ValueError, match="20 samples at least, 20 s"):
        plan_next_test(found, stand.recording, limits=TestLimits(duration=5.0))


def test_a_plan_that_fails_costs_no_diagnosis():
    member = SimpleNamespace(effect=EFFECTS["clogging"])
    broken = SimpleNamespace(recording={"opening"})
    findings = [SimpleNamespace(rivals=None)]
    plan = plan_of(broken, findings)
    assert plan is None
    told_instead = next_test([{"clogging": (1.0, member, None)}], "named", None, broken, plan)
    assert told_instead == EFFECTS["clogging"].separated_by


def test_groups_hold_what_stays_together():
    far, near = 30.0, 2.0
    distances = np.array([[0, near, far], [near, 0, far], [far, far, 0]])
    assert apart("abc", distances) == [[0, 1], [2]]
    chained = np.array([[0, near, far], [near, 0, near], [far, near, 0]])
    assert apart("abc", chained) == [[0, 1, 2]]


def test_words_say_what_is_told_apart_and_what_is_not():
    now, after = np.full((3, 3), 1.0), np.full((3, 3), 40.0)
    after[0, 1] = after[1, 0] = 2.0
    said = sentence_of(
        "Do this", ("erosion", "seat_leakage", "clogging"), now, after, ["First.", "Second.", "Third."]
    )
    assert said.startswith("Do this: this should tell erosion or seat leakage from clogging")
    assert "(one would be taken for the other in less than 0.1 % of cases, now in 31 %)" in said
    assert said.endswith("For the others: First.")
    assert "D =" not in said
    poor = sentence_of(
        "Do this", ("erosion", "clogging"), now[:2, :2], np.full((2, 2), 6.0), ["First.", "Second."]
    )
    assert (
        "this distinguishes erosion and clogging best, but one would still be taken for the other in 11 % of "
        "cases (31 % now). First." in poor
    )


def test_distances_are_for_the_details():
    now, after = np.full((2, 2), 1.0), np.full((2, 2), 40.0)
    said = distances_in_words(("erosion", "clogging"), now, after)
    assert "erosion from clogging 1 and 40" in said
    assert "Two can be distinguished from 14 on; a test should promise 28." in said


def test_a_test_lowers_no_distance(lags):
    still = library(0.45, 0.5, 0.47, 60, 1.0, TestLimits())[0]
    now, then = lags.now(), lags.distances(still)
    # much more of the effect, and nothing between the two: by the pooled formula alone D would fall
    loud = Advisor(lags.problem, lags.explanations, lags.without, 100.0 * lags.gain)
    assert np.all(then >= now)
    assert np.all(loud.distances(still) >= loud.now())


def test_only_what_chance_cannot_undo_is_promised():
    # what a record shows of D scatters by 2 sqrt(D): nine of ten are beyond the end of a class
    assert norm.cdf((SURE - 14.0) / (2.0 * np.sqrt(SURE))) == pytest.approx(0.907, abs=0.001)
    now, after = np.full((2, 2), 3.0), np.full((2, 2), 20.0)
    said = sentence_of("Do this", ("erosion", "clogging"), now, after, ["First.", "Second."])
    assert "one would still be taken for the other in 1.3 % of cases (19 % now)" in said
    assert not Pair(("erosion", "clogging"), 3.0, (20.0, 60.0)).separates
    assert Pair(("erosion", "clogging"), 3.0, (30.0, 60.0)).separates
    # a pair that the present recording tells apart needs no more
    now, after = np.full((3, 3), 3.0), np.full((3, 3), 40.0)
    now[0, 2] = now[2, 0] = after[0, 2] = after[2, 0] = 16.0
    said = sentence_of(
        "Do this", ("erosion", "clogging", "backlash"), now, after, ["First.", "Second.", "Third."]
    )
    assert "should tell erosion from clogging from backlash" in said
    assert "For the others" not in said


def test_words_tell_the_pair_that_grows_and_those_that_stay():
    names, advice = ("two_phase", "cavitation", "choked_flow"), ["Bleed.", "Listen.", "Lower p2."]
    now = np.array([[0.0, 2.3, 9.0], [2.3, 0.0, 5.0], [9.0, 5.0, 0.0]])
    after = np.array([[0.0, 2.3, 32.0], [2.3, 0.0, 6.0], [32.0, 6.0, 0.0]])
    said = sentence_of("Do this", names, now, after, advice)
    assert "should tell two phase from choked flow (one would be taken for the other in 0.23 % of" in said
    assert "It does not tell two phase from cavitation, nor cavitation from choked flow." in said
    poor = np.array([[0.0, 2.3, 9.0], [2.3, 0.0, 12.0], [9.0, 12.0, 0.0]])
    said = sentence_of("Do this", names, now, poor, advice)
    assert "this distinguishes cavitation and choked flow best, but one would still be taken" in said
    assert "and it does not tell two phase from cavitation, nor two phase from choked flow. Bleed." in said


@pytest.mark.parametrize(
    ("now", "after", "worth"),
    [(2.3, 2.3, False), (2.3, 3.4, False), (2.3, 7.0, True), (13.5, 14.1, True), (15.0, 40.0, False)],
)
def test_only_what_halves_the_confusion_is_worth_a_test(now, after, worth):
    assert appreciable(now, after) is worth


class _Programs:
    """Stands for an advisor whose programs reach given distances."""

    def __init__(self, now, then):
        recording = Stand({"clogging": 0.5}, 1, rows=300).recording
        trim = SimpleNamespace(known=True)
        self.problem = SimpleNamespace(recording=recording, trim=trim, coupled=False)
        self.explanations = [SimpleNamespace(name=n, probability=0.3) for n in ("a", "b", "c")]
        self._now, self._then = np.array(now), np.array(then)

    def now(self):
        return self._now

    def distances(self, program, sensor=None, rounds=1):
        return self._then


def test_no_plan_where_no_pair_gets_appreciably_larger():
    now = [[0.0, 2.3, 9.0], [2.3, 0.0, 15.0], [9.0, 15.0, 0.0]]
    # one was told apart before the test, another grows by more than one, but not by enough to be worth it
    then = [[0.0, 3.5, 9.0], [3.5, 0.0, 90.0], [9.0, 90.0, 0.0]]
    assert _Choice(_Programs(now, then), None, TestLimits()).plan() is None


@pytest.mark.parametrize(
    ("found", "asks", "first"),
    [
        # more than enough is no better, and the programs come in the order of their haste
        ([60.0, 400.0], [0, 0], 0),
        ([30.0, 50.0], [0, 0], 1),
        # what tells them apart for sure comes before what asks less, and less is asked before more is told
        ([20.0, 40.0], [0, 1], 1),
        ([40.0, 400.0], [0, 1], 0),
        ([5.0, 12.0], [0, 1], 1),
    ],
)
def test_what_is_told_for_sure_counts_then_what_is_asked_then_how_far_it_gets(found, asks, first):
    choice = _Choice(_Programs(np.full((3, 3), 2.0), np.full((3, 3), 2.0)), None, TestLimits())
    assert choice._order([[d] * 3 for d in found], asks)[0] == first


def test_a_stage_without_a_program_hands_over_to_the_next(monkeypatch):
    def planned_by(*stages):
        choice = _Choice(_Programs(np.full((3, 3), 2.0), np.full((3, 3), 60.0)), None, TestLimits())
        monkeypatch.setattr(choice, "_stages", lambda: iter([(programs, None) for programs in stages]))
        monkeypatch.setattr(choice, "_as_plan", lambda program, *_: program)
        return choice.plan()

    assert planned_by([], ["p"]) == "p"
    assert planned_by([], []) is None


def test_pressures_are_moved_one_by_one_and_further_before_both():
    choice = _Choice(_Programs(np.full((3, 3), 2.0), np.full((3, 3), 2.0)), None, None)
    stages = [[p for p in programs if p.moved] for programs, _ in choice._stages()]
    moved = [
        (
            sorted({r for p in s for r in p.moved}),
            max(np.abs(p.moved["p2"]).max() for p in s if "p2" in p.moved),
        )
        for s in stages
        if s
    ]
    assert moved == [(["p2"], 0.3), (["p2"], 0.6), (["p1", "p2"], 0.3)]
    assert all("p1" in p.moved for p in stages[-1])
    assert any("shut" in p.name for p in stages[-1])
