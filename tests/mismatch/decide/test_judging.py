# SPDX-License-Identifier: BSD-3-Clause
"""What stands of the findings, and where to look where nothing can be named."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder
from sklvalve.mismatch.decide import case as case_module
from sklvalve.mismatch.decide import judging, rules, weighing
from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.decide.standing import Fit
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


@pytest.mark.parametrize(
    ("history", "kept", "asked", "verdict", "shares"),
    [
        ("learnt", True, [rules.pattern(0.1, "time")], "named", []),
        ("learnt", True, [], "none_of_these", [False]),
        (None, True, [], "none_of_these", [False]),
        ("learnt", False, [rules.pattern(0.1, "time")], "none_of_these", [False]),
        ("learnt", False, [rules.pattern(0.99, "time")], "none_of_these", []),
    ],
    ids=[
        "no pattern beside a name",
        "nothing known since the history",
        "no history",
        "refused otherwise",
        "refused for a pattern",
    ],
)
def test_what_is_learnt_of_a_residual_is_asked_where_a_pattern_has_not_decided(
    monkeypatch, history, kept, asked, verdict, shares
):
    monkeypatch.setattr(judging, "_explained", lambda *_: 0.01)
    finding = SimpleNamespace(term="leak")
    fit = Fit(tuple(asked), [finding] if kept else [])
    weighed = SimpleNamespace(unknown=SimpleNamespace(channel="flow", size=0.05), enough=True)
    case = SimpleNamespace(problem=SimpleNamespace(history=history))
    said, names, about = judging._beside_what_is_left(case, fit, [finding], None, weighed)
    assert (said, bool(names)) == (verdict, verdict == "named")
    assert [rule.passed for rule in about] == shares


@pytest.mark.parametrize(("pattern", "verdict"), [(None, "cannot_tell"), ("left", "none_of_these")])
def test_what_imitates_is_none_of_these_though_nothing_was_learnt_of_the_residual(pattern, verdict):
    fit = Fit(why="A pattern is left.", pattern=pattern)
    weighed = SimpleNamespace(unknown=None, enough=True)
    case = SimpleNamespace(problem=SimpleNamespace(history="learnt"))
    assert judging._beside_what_is_left(case, fit, [], None, weighed)[0] == verdict
    judged = SimpleNamespace(findings=[], verdict=verdict, unknown=None)
    nothing = SimpleNamespace(
        residual_of=lambda model: SimpleNamespace(unknown=None), explanation=SimpleNamespace(nominal=None)
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judging, "replace", lambda judged, **new: new)
        assert judging._nameless(nothing, judged, False)["verdict"] == verdict


@pytest.mark.parametrize(
    ("verdict", "beside", "pattern", "also"),
    [
        ("cannot_tell", (), None, "left"),
        ("none_of_these", (), "pattern", "pattern"),
        ("no_mismatch", (), None, None),
        ("named", ("leak",), None, "named too"),
    ],
    ids=["more than noise is left", "a pattern is left", "nothing is missing", "a name beside"],
)
def test_what_stops_a_name_beside_events_is_told_and_is_no_rule_of_theirs(
    monkeypatch, verdict, beside, pattern, also
):
    """A stem that slips has its name from its slips; what is wrong with the flow beside it is told."""
    asked = (rules.rarity(1e-6, 0.01), rules.history_noise(1e-5), rules.noise(0.3, True))
    judged = Judgement(
        None, verdict, 1e-6, list(beside), None, None, None, evidence="known", rules=asked, why=("too much",),
        pattern=pattern, also="named too" if beside else None,
    )  # fmt: skip
    problem = SimpleNamespace(channels=("opening", "flow"))
    case = case_module.Case(SimpleNamespace(problem=problem, findings=[], model=None), None, None, 0.01, 0)
    monkeypatch.setattr(judging, "_judged", lambda case, findings, model: judged)
    monkeypatch.setattr(judging, "_names_one_of", lambda *_: False)
    monkeypatch.setattr(judging, "with_events", lambda *_: ("slips", None))
    monkeypatch.setattr(judging, "cross_validated", lambda *_: None)
    monkeypatch.setattr(
        judging, "elsewhere", lambda case, findings, *_: "left" if case.channels == ("flow",) else "wrong"
    )
    told = judging.judge(case, SimpleNamespace(names={"stiction"}))
    assert (told.verdict, told.findings) == ("named", ["slips", *beside])
    assert [rule.name for rule in told.rules] == ["rarity", "noise"]
    assert (told.also, told.pattern, told.why) == (also, None, ())
