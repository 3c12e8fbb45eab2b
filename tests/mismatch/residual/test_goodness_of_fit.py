# SPDX-License-Identifier: BSD-3-Clause
"""What an explanation may leave over of a flow, and that an imitation loses its name for leaving more."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.mismatch.next_test.suggestions import next_test
from sklvalve.mismatch.residual.goodness_of_fit import (
    LeftOver,
    effective_number,
    held_against_noise,
    imitates_any_time_profile,
    left_over,
)
from sklvalve.mismatch.residual.smooth_pattern import Pattern
from sklvalve.mismatch.result import contents
from sklvalve.mismatch.search.explain import Explanation
from sklvalve.mismatch.search.rivals import Finding
from sklvalve.recording.dead_bands import DeadBand
from sklvalve.report import summary_sentence
from sklvalve.simulation import Tolerance
from sklvalve.simulation.stages import first_order_lag


def _left(recording):
    bench = Problem.of(recording, Tolerance(), recording.valve.physics)
    model = bench.fit((), max_steps=5)
    bench = bench.with_noise_of(model)
    return left_over(bench, model, model)


def _with_flow(recording, factor):
    return replace(recording, signals=recording.signals | {"flow": recording["flow"] * factor})


def _deposits(n, share, seed=0):
    """Factor of a flow through deposits that grow for minutes and are washed off at once."""
    rng, blocked, t = np.random.default_rng(seed), np.zeros(n), 30
    while t < n:
        length = int(rng.uniform(60.0, 200.0))
        stop = min(t + length, n)
        blocked[t:stop] = rng.uniform(0.6, 1.4) * (np.arange(stop - t) / length) ** 0.7
        t = stop + int(rng.uniform(50.0, 200.0))
    return 1.0 - share * blocked


def test_healthy_flow_leaves_less_than_its_quick_noise(healthy):
    left = _left(healthy)
    assert left.channel == "flow"
    assert left.size < left.noise < left.allowed
    assert not left.too_much
    assert not left.is_no_wander(0.01)


def test_quick_noise_of_a_flow_that_was_held_is_no_less_than_that_of_its_band(healthy):
    left = _left(healthy)
    band = 20.0 * left.noise * np.ptp(healthy["flow"])
    held = _left(replace(healthy, bands={"flow": (DeadBand(-np.inf, np.inf, band),)}))
    assert held.noise > 5.0 * left.noise
    assert held.allowed > left.allowed


def test_what_the_noise_model_takes_for_wander_is_told(healthy):
    left = _left(_with_flow(healthy, _deposits(len(healthy), 0.25)))
    assert left.too_much
    assert left.is_no_wander(0.01)
    assert left.size == pytest.approx(left.times * left.allowed)


def test_a_wander_of_half_the_quick_noise_is_none(healthy):
    rng, n = np.random.default_rng(2), len(healthy)
    slow = first_order_lag(rng.standard_normal(n), np.ones(n), 60.0, 0.0)
    level = 0.5 * _left(healthy).noise * np.nanmax(healthy["flow"])
    wandering = healthy["flow"] + level * slow / slow.std()
    assert not _left(replace(healthy, signals=healthy.signals | {"flow": wandering})).too_much


def test_what_is_explained_may_be_wrong_by_a_share_of_itself(healthy):
    bench = Problem.of(healthy, Tolerance(), healthy.valve.physics)
    model = bench.fit((), max_steps=5)
    bench = bench.with_noise_of(model)
    far = replace(model, predictions=model.predictions | {"flow": 0.8 * model.predictions["flow"]})
    plain, explaining = left_over(bench, model, model), left_over(bench, model, far)
    assert explaining.allowed > 1.5 * plain.allowed
    assert explaining.size == plain.size


@pytest.mark.parametrize("missing", [("opening",), ("p1", "p2")])
def test_nothing_is_said_where_stem_or_drop_are_not_recorded(healthy, missing):
    signals = {role: v for role, v in healthy.signals.items() if role not in missing}
    assert _left(replace(healthy, signals=signals)) is None


def test_noise_of_a_stem_that_never_rests_is_the_jitter_of_the_rest(healthy):
    n = len(healthy)
    wavy = healthy["opening"] + 0.01 * np.sin(np.arange(n) / 3.0)
    left = _left(replace(healthy, signals=healthy.signals | {"opening": wavy}))
    assert 0.0 < left.noise < 0.2


@given(n=st.integers(100, 400), keep=st.floats(0.0, 0.95), seed=st.integers(0, 1000), gap=st.integers(0, 40))
@settings(deadline=None, max_examples=40)
def test_correlated_values_count_for_fewer(n, keep, seed, gap):
    rng = np.random.default_rng(seed)
    series = rng.standard_normal(n)
    for k in range(1, n):
        series[k] += keep * series[k - 1]
    series[10 : 10 + gap] = np.nan
    number = effective_number(series)
    assert 0.0 < number <= n - gap
    if keep > 0.9:
        assert number < 0.4 * n


@pytest.mark.slow
def test_an_imitation_is_not_named(healthy):
    """Deposits that come and go pass for noise that is learnt from what they leave."""
    dirty = _with_flow(healthy, _deposits(len(healthy), 0.4, seed=3))
    found = MissingPhysicsFinder(effects=("backlash", "flow_meter_drift")).fit(dirty)
    told = found.diagnosis_.to_dict()
    assert told["verdict"] == "none_of_these"
    assert told["effects"] == []
    assert told["mismatch"]["detected"]
    assert told["mismatch"]["p_value"] < 0.01
    assert told["unknown"]["signal"] == "flow"
    # a place that the tried effects point to, and not the stem, which runs as simulated
    assert "valve" in told["location"]["blocks"]
    assert "actuator" not in told["location"]["blocks"]
    beyond = told["unknown"]["beyond_noise"]
    assert beyond["size"] > 1.3 * beyond["allowed"] > 1.3 * beyond["noise"]
    assert "no known effect" in summary_sentence(told)


def _nameless(unknown):
    """A diagnosis of what no effect explains."""
    return {
        "verdict": "none_of_these",
        "mismatch": {"detected": True, "p_value": 1e-6},
        "location": {"blocks": ["valve"], "regions": [], "onset": None, "intervals": []},
        "effects": [],
        "fit": {},
        "unknown": unknown,
    }


def test_the_sentence_says_what_comes_closest_and_what_it_leaves():
    members = [{"name": "backlash", "probability": 0.97}]
    d = _nameless(
        {
            "signal": "flow",
            "inputs": [],
            "size": 0.021,
            "beyond_noise": {"size": 0.021, "noise": 0.004, "allowed": 0.005},
            "closest": [{"members": members, "sentence": "There is play.", "size": {"flow": 0.02}}],
            "closest_leaves": 0.02,
        }
    )
    sentence = summary_sentence(d)
    assert "follows from nothing recorded" in sentence
    assert "Backlash fits best, but 2 % of span beyond noise would remain." in sentence
    d["unknown"]["closest_leaves"] = None
    told = "Backlash fits best, but two slow drifts together can mimic almost any third."
    assert told in summary_sentence(d)


@pytest.mark.parametrize(
    ("inputs", "words"),
    [((), "is smoother than noise, though it follows from nothing recorded"), (("opening",), "follows from")],
    ids=["time", "opening"],
)
def test_the_sentence_says_what_a_pattern_follows(inputs, words):
    entry = contents._unlearnt(Pattern("flow", inputs, 0.02, 4.0), None)
    assert (entry["inputs"], entry["size"], entry["p_value"]) == (list(inputs), 0.02, None)
    d = _nameless(entry)
    assert words in summary_sentence(d)
    assert "the recorded signals" not in summary_sentence(d)


def _said(recording):
    bench = Problem.of(recording, Tolerance(), recording.valve.physics)
    nominal = bench.fit((), max_steps=5)
    bench = bench.with_noise_of(nominal)
    effects = tuple(e for e in CATALOGUE if e.key in ("flow_meter_drift", "sedimentation", "backlash"))
    explanation = Explanation(bench, nominal, nominal, [], {}, effects)
    return held_against_noise(bench, explanation, nominal, [], 0.01)[1]


def test_what_a_known_effect_would_explain_is_doubtful_and_what_none_would_refutes(healthy):
    n = len(healthy)
    drifting = np.linspace(0.0, 0.06 * np.nanmax(healthy["flow"]), n)
    assert _said(healthy) == "fine"
    grown = replace(healthy, signals=healthy.signals | {"flow": healthy["flow"] + drifting})
    assert _said(grown) == "doubtful"
    assert _said(_with_flow(healthy, _deposits(n, 0.4))) == "refuted"


@pytest.mark.parametrize(
    ("keys", "imitates"),
    [
        (("viscosity_change", "flow_meter_drift_span"), True),
        (("sedimentation", "flow_meter_drift"), True),
        (("sedimentation", "choked_flow"), False),
        (("viscosity_change",), False),
        ((), False),
    ],
)
def test_two_slow_courses_imitate_any_other(keys, imitates):
    effects = {effect.key: effect for effect in CATALOGUE}
    findings = [Finding(Term(effects[key]), [], 50.0, {"flow": 0.02}) for key in keys]
    assert imitates_any_time_profile(findings) is imitates


@pytest.mark.parametrize(
    ("times", "many", "said"),
    [
        (1.2, 400.0, (False, False, False)),
        (1.5, 3.0, (True, False, False)),
        (1.5, 20.0, (True, True, False)),
        (2.0, 6.0, (True, True, False)),
        (2.0, 40.0, (True, True, True)),
    ],
)
def test_few_slow_turns_are_doubtful_and_many_clear(times, many, said):
    left = LeftOver("flow", 0.005 * times, 0.004, 0.005, many)
    assert (left.too_much, left.clearly, left.is_no_wander(0.01)) == said


def test_the_next_test_of_what_nothing_tells_holds_the_command(healthy):
    bench = Problem.of(healthy, Tolerance(), healthy.valve.physics)
    left = LeftOver("flow", 0.02, 0.004, 0.005, 20.0)
    assert next_test([], "none_of_these", left, bench).startswith("Hold the command")
