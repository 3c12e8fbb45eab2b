# SPDX-License-Identifier: BSD-3-Clause
"""Which findings may be named, beside one another and down to the noise of a history."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.constants import HELD_OUT_ERRORS
from sklvalve.mismatch.decide import case as case_module
from sklvalve.mismatch.decide import standing
from sklvalve.mismatch.decide.detect import Evidence
from sklvalve.mismatch.residual.since_history import LeftSince
from sklvalve.mismatch.residual.smooth_pattern import Pattern


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
    findings = [SimpleNamespace(term=name, stage="meter") for name in shown]
    problem = SimpleNamespace(
        touched_by=lambda terms: {channel for term in terms for channel in shown[term].split()}
    )

    class Asked(_Case):
        def left_where_they_act(self, findings, model):
            if "not asked" in leave_much:
                return None, None
            met = leave_much & problem.touched_by([f.term for f in findings])
            return SimpleNamespace(effect_size=9.0 if met else 0.1), None

    monkeypatch.setattr(
        standing, "p_value_of_residual", lambda evidence: 0.001 if evidence.residual > 1.0 else 0.5
    )
    monkeypatch.setattr(standing, "exceeds_noise", lambda new, some, problem: "too much is left")
    case = Asked(problem=problem, explanation=None, alpha=0.01, gains=dict.fromkeys(shown, 9.0), rarity={})
    evidence = Evidence(1.0, 1.0, None, None)
    fit = standing.fit_of(case, findings, None, evidence)
    assert "".join(f.term for f in fit.kept) == kept
    # why there is no name, or what differs beside one
    assert bool(fit.why) is not bool(kept)
    assert (fit.beside is not None) is (0 < len(fit.kept) < len(findings))
    of_noise = [rule.passed for rule in fit.asked if rule.name == "history_noise"]
    assert of_noise == ([] if passed is None else [passed])


@pytest.mark.parametrize(
    ("leave_much", "gains", "kept"),
    [
        ({"flow"}, {"a": 0.0, "b": 9.0}, "b"),
        ({"flow"}, {"a": 9.0, "b": 0.0}, ""),
        (set(), {"a": 0.0, "b": 9.0}, ""),
    ],
    ids=["of what is dropped", "of what is kept", "of the strongest"],
)
def test_rows_left_out_are_asked_of_the_strongest_that_may_be_named(monkeypatch, leave_much, gains, kept):
    signals = {"a": {"flow"}, "b": {"opening"}}
    findings = [SimpleNamespace(term=name, stage="meter") for name in signals]

    class Asked(_Case):
        def left_where_they_act(self, findings, model):
            met = any(leave_much & signals[f.term] for f in findings)
            return SimpleNamespace(effect_size=9.0 if met else 0.1), None

    monkeypatch.setattr(
        standing, "p_value_of_residual", lambda evidence: 0.001 if evidence.residual > 1.0 else 0.5
    )
    monkeypatch.setattr(standing, "not_upheld", lambda findings: "predicts nothing")
    problem = SimpleNamespace(touched_by=lambda terms: {c for term in terms for c in signals[term]})
    case = Asked(problem=problem, explanation=None, alpha=0.01, gains=gains, rarity={})
    fit = standing.fit_of(case, findings, None, Evidence(1.0, 1.0, None, None))
    assert "".join(f.term for f in fit.kept) == kept
    assert [rule.passed for rule in fit.asked if rule.name == "held_out"] == [bool(kept)]


@pytest.mark.parametrize(
    ("stages", "patterns", "kept", "imitates"),
    [
        ({"a": "meter", "b": "stem"}, set(), "ab", False),
        ({"a": "meter", "b": "stem"}, {"flow"}, "b", False),
        ({"a": "meter"}, {"flow"}, "", True),
        ({"b": "stem"}, {"opening"}, "", False),
    ],
    ids=["no pattern", "of one", "of the flow", "of the stem"],
)
def test_beside_a_pattern_nothing_is_named(stages, patterns, kept, imitates):
    signals = {"a": {"flow"}, "b": {"opening"}}
    findings = [SimpleNamespace(term=name, stage=stage) for name, stage in stages.items()]

    class Asked(_Case):
        def left_where_they_act(self, findings, model):
            met = any(patterns & signals[f.term] for f in findings)
            channel = min(signals[findings[0].term])
            return None, Pattern(channel, ("opening",), 0.01, 4.0 if met else 2.0)

    problem = SimpleNamespace(touched_by=lambda terms: {c for term in terms for c in signals[term]})
    gains = dict.fromkeys(signals, 9.0)
    case = Asked(problem=problem, explanation=None, alpha=0.01, gains=gains, rarity={})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(standing, "leaves_pattern", lambda pattern, some, problem: "a pattern is left")
        fit = standing.fit_of(case, findings, None, Evidence(1.0, 1.0, None, None))
    assert "".join(f.term for f in fit.kept) == kept
    assert (fit.pattern is not None, bool(fit.why)) == (imitates, not kept)
    assert isinstance(fit.beside, Pattern) is (0 < len(kept) < len(stages))
    assert [rule.name for rule in fit.asked] == ["held_out", "residual"]


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
    for name in ("left_since", "pattern_left"):
        monkeypatch.setattr(
            case_module, name, lambda problem, model, channels: channels if problem.history else None
        )
    monkeypatch.setattr(case_module.Case, "residual_of", lambda case, model: SimpleNamespace(fitted=model))
    problem = SimpleNamespace(
        channels=("opening", "flow"),
        touched_by=lambda terms: {c for _ in terms for c in touched},
        history="learnt",
    )
    case = case_module.Case(SimpleNamespace(problem=problem), None, None, 0.01, 0, channels)
    finding = SimpleNamespace(term=SimpleNamespace(effect="seat_leakage"))
    assert case.left_where_they_act([finding], None) == (asked, asked)
    problem.history = None
    assert case.left_where_they_act([finding], None) == (None, None)


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
