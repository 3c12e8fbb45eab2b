# SPDX-License-Identifier: BSD-3-Clause
"""What stands of the findings, and where to look where nothing can be named."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder
from sklvalve.mismatch.constants import HELD_OUT_ERRORS
from sklvalve.mismatch.decide import case as case_module
from sklvalve.mismatch.decide import judging, standing, weighing
from sklvalve.mismatch.decide.detect import Evidence
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.search.taking_up import Tried
from sklvalve.recording import Recording
from sklvalve.simulation.calibration import span_of
from tests.mismatch.conftest import record

BY_KEY = {effect.key: effect for effect in CATALOGUE}


def _explanation(tried, *found):
    findings = [SimpleNamespace(term=SimpleNamespace(effect=BY_KEY[key])) for key in found]
    return SimpleNamespace(
        tried={key: Tried(gain, {}) for key, gain in tried.items()}, findings=findings, effects=CATALOGUE
    )


def test_suspected_is_what_comes_near_the_best():
    tried = {"seat_leakage": 100.0, "flow_meter_bias": 25.0, "line_loss": 24.0, "dead_time": -3.0}
    assert judging._suspects(_explanation(tried)) == ("measurement", "valve")
    # what the search ended with counts however little it gains by itself
    assert judging._suspects(_explanation(tried, "dead_time")) == ("actuator", "measurement", "valve")
    assert judging._suspects(_explanation({})) == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rarity", "named"),
    [(1e-4, True), (0.2, False)],
    ids=["rare among healthy recordings", "not rare"],
)
def test_a_weak_finding_stands_where_the_mismatch_is_told_without_it(monkeypatch, rarity, named):
    """Under its own noise the leak is no clear one; that something is missing the first look told already."""
    monkeypatch.setattr(weighing, "p_value_of_what_counts", lambda findings, *_: 0.05 if findings else 1e-6)
    monkeypatch.setattr(case_module, "p_value_of_one", lambda *_: rarity)
    leaking = record("seat_leakage", 0.05, random_state=1)
    found = MissingPhysicsFinder(effects=["seat_leakage", "flow_meter_bias", "line_loss"]).fit(leaking)
    told = found.diagnosis_.to_dict()
    assert told["mismatch"]["detected"]
    assert (told["verdict"] == "named") is named
    # a place is told either way, and it holds the true one
    assert "valve" in told["location"]["blocks"]
    assert "actuator" not in told["location"]["blocks"]


@pytest.mark.slow
def test_the_p_value_told_is_that_which_decided(monkeypatch):
    """With the finding chance is not ruled out, without it it is: what is named then stands by the latter."""
    first = iter([0.012])
    monkeypatch.setattr(weighing, "mismatch_p_value", lambda evidence: next(first, 1e-5))
    monkeypatch.setattr(weighing, "p_value_of_what_counts", lambda *_: 1e-6)
    monkeypatch.setattr(case_module, "p_value_of_one", lambda *_: 1e-4)
    leaking = record("seat_leakage", 0.05, random_state=1)
    told = MissingPhysicsFinder(effects=["seat_leakage", "line_loss"]).fit(leaking).diagnosis_.to_dict()
    assert (told["verdict"], told["mismatch"]["detected"]) == ("named", True)
    assert told["mismatch"]["p_value"] == 1e-5


@pytest.mark.slow
def test_what_may_not_be_named_tells_when_and_in_which_rows_it_acts(monkeypatch):
    monkeypatch.setattr(weighing, "p_value_of_what_counts", lambda findings, *_: 0.05 if findings else 1e-6)
    monkeypatch.setattr(case_module, "p_value_of_one", lambda *_: 0.2)
    leaking = record("seat_leakage", 0.05, random_state=1, onset=900.0)
    found = MissingPhysicsFinder(effects=["seat_leakage", "flow_meter_bias", "line_loss"]).fit(leaking)
    told, flagged = found.diagnosis_.to_dict(), found.diagnosis_.traces["flagged"]
    assert (told["verdict"], told["effects"]) == ("cannot_tell", [])
    assert told["location"]["onset"] == pytest.approx(900.0, abs=30.0)
    assert not flagged[:870].any()
    assert flagged[930:].mean() > 0.5


@pytest.mark.slow
def test_a_meter_may_read_off_by_half_of_what_it_shows():
    healthy = record(random_state=0)
    columns = {role: healthy[role].copy() for role in healthy.signals}
    shift = 0.45 * span_of(columns["flow"])
    columns["flow"] -= shift
    # of what it shows the shift is more than half: 0.45 of 0.55
    assert shift > 0.5 * span_of(columns["flow"])
    # columns named by their roles hold SI units
    in_si = replace(healthy.valve, roles={})
    off = Recording.from_frame({"time": healthy.time} | columns, in_si)
    found = MissingPhysicsFinder(effects=["flow_meter_bias", "external_leakage"]).fit(off)
    (effect,) = found.diagnosis_.to_dict()["effects"]
    assert "flow_meter_bias" in {member["name"] for member in effect["members"]}


class _Case(SimpleNamespace):
    """A case that knows of each finding how rare it is and what it gains."""

    def held_out_gain(self, finding):
        return self.gains[finding.term]

    def is_rare(self, finding, level=0.01):
        return self.rarity[finding.term] <= level


CLEAR, RARE, USUAL = 5e-5, 5e-3, 0.02


@pytest.mark.parametrize(
    ("gains", "rarity", "alone", "kept"),
    [
        ({"b": HELD_OUT_ERRORS, "c": 9.0}, {"b": CLEAR, "c": CLEAR}, False, "abc"),
        ({"b": HELD_OUT_ERRORS - 0.1, "c": 9.0}, {"b": CLEAR, "c": CLEAR}, False, "ac"),
        ({"b": 9.0, "c": 9.0}, {"b": RARE, "c": CLEAR}, False, "ac"),
        ({"b": 9.0, "c": 9.0}, {"b": RARE, "c": USUAL}, True, "ab"),
        ({"b": 0.0, "c": 0.0}, {"b": CLEAR, "c": CLEAR}, True, "a"),
    ],
    ids=[
        "all gain and are clear",
        "one predicts nothing",
        "one is not as rare as alpha twice over",
        "in a signal of its own alpha is enough",
        "the strongest is judged later",
    ],
)
def test_what_is_named_beside_a_stronger_one_is_rare_and_gains(monkeypatch, gains, rarity, alone, kept):
    monkeypatch.setattr(standing, "_shows_alone", lambda *_: alone)
    findings = [SimpleNamespace(term=name) for name in "abc"]
    problem, search = SimpleNamespace(fit=lambda terms, start: terms), SimpleNamespace(nominal=None)
    case = _Case(problem=problem, explanation=search, alpha=0.01, gains=gains, rarity=rarity)
    stand, model = standing.upheld(case, findings, tuple(f.term for f in findings))
    assert "".join(f.term for f in stand) == "".join(model) == kept


@pytest.mark.parametrize(
    ("signals", "coupled", "alone"), [("flow", False, True), ("opening", False, False), ("flow", True, False)]
)
def test_what_shows_in_a_signal_of_its_own(signals, coupled, alone):
    shown = {"a": ("opening",), "b": (signals,)}
    first, second = (SimpleNamespace(term=SimpleNamespace(effect=name)) for name in shown)
    problem = SimpleNamespace(
        coupled=coupled, touched_by=lambda terms: {c for m in terms for c in shown[m.effect]}
    )
    assert standing._shows_alone(problem, second, [first]) is alone


@pytest.mark.parametrize(
    ("shown", "leave_much", "kept", "passed"),
    [
        ({"a": "flow", "b": "opening"}, {"opening"}, "a", True),
        ({"a": "flow", "b": "opening"}, {"flow"}, "b", True),
        ({"a": "flow", "b": "opening"}, {"flow", "opening"}, "", False),
        ({"a": "flow", "b": "opening"}, set(), "ab", True),
        ({"a": "flow", "b": "flow", "c": "opening"}, {"opening"}, "ab", True),
        ({"a": "flow", "b": "flow opening"}, {"opening"}, "", False),
        ({"a": "flow", "b": "opening"}, {"flow", "opening", "not asked"}, "ab", None),
    ],
    ids=[
        "one signal",
        "the stronger one's",
        "both",
        "none",
        "two in one",
        "two share one",
        "without a history",
    ],
)
def test_what_is_explained_keeps_its_name_beside_a_signal_that_is_not(
    monkeypatch, shown, leave_much, kept, passed
):
    findings = [SimpleNamespace(term=name) for name in shown]
    problem = SimpleNamespace(
        touched_by=lambda terms: {channel for term in terms for channel in shown[term].split()}
    )

    class Asked(_Case):
        def left_where_they_act(self, findings, model):
            if "not asked" in leave_much:
                return None
            met = leave_much & problem.touched_by([f.term for f in findings])
            return SimpleNamespace(effect_size=9.0 if met else 0.1)

    monkeypatch.setattr(
        standing, "p_value_of_residual", lambda evidence: 0.001 if evidence.residual > 1.0 else 0.5
    )
    monkeypatch.setattr(standing, "exceeds_noise", lambda new, some, problem: "too much is left")
    case = Asked(problem=problem, explanation=None, alpha=0.01, gains=dict.fromkeys(shown, 9.0), rarity={})
    evidence = Evidence(1.0, 1.0, None, None)
    asked, stand, why = standing.of_fit(case, findings, None, evidence)
    assert "".join(f.term for f in stand) == kept
    assert bool(why) is (len(stand) < len(findings))
    of_noise = [rule.passed for rule in asked if rule.name == "history_noise"]
    assert of_noise == ([] if passed is None else [passed])


LEFT = LeftSince("opening", 0.03, 0.008, 0.01, many=60, rows=16, effect_size=5.0)


@pytest.mark.parametrize(
    ("touched", "channels", "asked"),
    [
        (("flow",), None, ("flow",)),
        (("opening", "flow"), None, ("opening", "flow")),
        (("opening", "flow"), ("flow",), ("flow",)),
        (("opening",), ("flow",), ()),
        (("opening",), (), ()),
    ],
    ids=["one signal", "both", "beside events", "none beside events", "without flow"],
)
def test_an_imitation_is_sought_in_the_signals_that_the_findings_change(
    monkeypatch, touched, channels, asked
):
    monkeypatch.setattr(
        case_module, "left_since", lambda problem, model, channels: channels if problem.history else None
    )
    monkeypatch.setattr(case_module.Case, "residual_of", lambda case, model: SimpleNamespace(fitted=model))
    problem = SimpleNamespace(
        channels=("opening", "flow"),
        touched_by=lambda terms: {c for _ in terms for c in touched},
        history="learnt",
    )
    case = case_module.Case(SimpleNamespace(problem=problem), None, None, 0.01, 0, channels)
    finding = SimpleNamespace(term=SimpleNamespace(effect="seat_leakage"))
    assert case.left_where_they_act([finding], None) == asked
    problem.history = None
    assert case.left_where_they_act([finding], None) is None


@pytest.mark.parametrize(
    ("touched", "rare", "kept"),
    [(("flow",), True, True), (("flow",), False, False), (("opening",), True, False)],
    ids=["elsewhere", "by chance", "where it acts"],
)
def test_what_differs_in_another_signal_is_kept_beside_a_name(monkeypatch, touched, rare, kept):
    monkeypatch.setattr(standing, "leaves_rare", lambda case, evidence: rare and evidence.residual == 5.0)
    problem = SimpleNamespace(touched_by=lambda terms: {c for _ in terms for c in touched})
    case = SimpleNamespace(problem=problem, residual_of=lambda model: SimpleNamespace(new=LEFT))
    finding = SimpleNamespace(term=SimpleNamespace(effect="seat_leakage"))
    new = standing.elsewhere(case, [finding], None, Evidence(0.0, 0.0, 1.0, None))
    assert new is (LEFT if kept else None)
