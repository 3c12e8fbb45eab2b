# SPDX-License-Identifier: BSD-3-Clause
"""A smooth pattern beside a hypothesis: its evidence against none, under the noise of the history."""

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from sklvalve import MissingPhysicsFinder
from sklvalve.history import ValveHistory
from sklvalve.history.allowance import Allowance
from sklvalve.mismatch.constants import PATTERN_POSTERIOR
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.decide import case as case_module
from sklvalve.mismatch.effects.flow_meter_gain import FlowMeterGain
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.residual import smooth_pattern
from sklvalve.mismatch.residual.smooth_pattern import Pattern, _evidence, pattern_left
from sklvalve.simulation.noise import NoiseModel
from tests.history.plant import changed, without


def _prepared(recording, history):
    problem, nominal = calibrated(prepared_problem(recording, None, None, history=history))
    return problem, problem.least_squares(nominal)


def _bumps(values):
    """Smooth, up and down three times over the range of a signal, rms 1."""
    low, high = np.nanmin(values), np.nanmax(values)
    return np.sqrt(2.0) * np.sin(6.0 * np.pi * (values - low) / (high - low))


def _clock(rows):
    return np.arange(rows, dtype=float)


def test_evidence_is_that_of_the_gaussian_process():
    rng = np.random.default_rng(0)
    free, wrong, white = rng.normal(size=(40, 5)), 0.5 * rng.normal(size=(40, 3)), rng.normal(size=40)
    amplitudes = np.array([0.0, 0.1, 1.0, 3.0])
    log_z, means = _evidence(free, wrong, white, amplitudes)
    none = multivariate_normal(np.zeros(40)).logpdf(white)
    for s, z, mean in zip(amplitudes, log_z, means, strict=True):
        covariance = np.eye(40) + wrong @ wrong.T + s**2 * free @ free.T
        assert z == pytest.approx(multivariate_normal(np.zeros(40), covariance).logpdf(white) - none)
        np.testing.assert_allclose(mean, s**2 * free.T @ np.linalg.solve(covariance, white), atol=1e-12)


@pytest.mark.parametrize("channel", ["opening", "flow"])
def test_none_is_likelier_for_a_healthy_valve(learnt, after, channel):
    pattern = pattern_left(*_prepared(after, learnt), {channel})
    assert pattern.channel == channel
    assert pattern.posterior < 0.5


@pytest.mark.parametrize("over", ["opening", "time"])
def test_a_pattern_is_told_with_what_it_is_a_function_of(learnt, after, over):
    values = after["opening"] if over == "opening" else _clock(len(after))
    added = 0.01 * np.nanmax(after["flow"]) * _bumps(values)
    problem, nominal = _prepared(changed(after, flow=after["flow"] + added), learnt)
    pattern = pattern_left(problem, nominal, problem.channels)
    assert pattern.channel == "flow"
    assert pattern.posterior > 0.99
    assert over in pattern.over
    assert ("opening" in pattern.inputs) is (over == "opening")
    # about as large as what was added
    assert pattern.size == pytest.approx(np.std(added) / problem.spans["flow"], rel=0.5)
    # and nothing of it is in the other signal
    assert pattern_left(problem, nominal, {"opening"}).posterior < 0.5


@pytest.mark.parametrize(("share", "likely"), [(0.1, False), (0.6, True)])
def test_an_effect_may_be_wrong_by_a_share_of_what_it_changes(learnt, after, share, likely):
    gained = 0.1 * (1.0 + share * _bumps(after["opening"]))
    problem, nominal = _prepared(changed(after, flow=after["flow"] * (1.0 - gained)), learnt)
    model = problem.least_squares(problem.fit((Term(FlowMeterGain()),), start=nominal))
    pattern = pattern_left(problem, model, {"flow"})
    assert (pattern.posterior > PATTERN_POSTERIOR) is likely
    # without the effect both show
    assert pattern_left(problem, nominal, {"flow"}).posterior > 0.99


def test_a_search_that_learnt_the_noise_from_the_residual_changes_nothing(learnt, after):
    added = 0.02 * np.nanmax(after["flow"]) * _bumps(_clock(len(after)))
    problem, nominal = calibrated(
        prepared_problem(changed(after, flow=after["flow"] + added), None, None, history=learnt)
    )
    own = problem.with_noise_of(nominal)
    assert own.noise["flow"].total > 1.2 * problem.noise["flow"].total
    assert pattern_left(own, nominal, {"flow"}) == pattern_left(problem, nominal, {"flow"})


def test_nothing_is_said_without_a_history_or_where_it_has_not_been(learnt, after):
    problem, nominal = _prepared(after, learnt)
    assert pattern_left(problem, nominal, ()) is None
    elsewhere = copy(learnt)
    elsewhere.range_ = SimpleNamespace(met=lambda recording, _: np.zeros(len(recording), dtype=bool))
    assert pattern_left(replace(problem, history=elsewhere), nominal, problem.channels) is None
    assert pattern_left(*_prepared(after, None), {"flow"}) is None


def test_what_a_healthy_valve_may_do_is_no_pattern(learnt, after):
    added = 0.01 * np.nanmax(after["flow"]) * _bumps(after["opening"])
    problem, nominal = _prepared(changed(after, flow=after["flow"] + added), learnt)
    allowing = copy(learnt)
    allowing.allowance = Allowance(response=0.02)
    assert pattern_left(problem, nominal, {"flow"}).posterior > 0.99
    assert pattern_left(replace(problem, history=allowing), nominal, {"flow"}).posterior < 0.5


@pytest.mark.parametrize("counts", [False, True])
def test_rows_where_the_history_has_not_been_do_not_count(learnt, after, counts):
    away = np.arange(len(after)) >= 800
    added = 0.03 * np.nanmax(after["flow"]) * np.where(away, _bumps(_clock(len(after))), 0.0)
    _, nominal = _prepared(after, learnt)
    elsewhere = copy(learnt)
    elsewhere.range_ = SimpleNamespace(met=lambda recording, _: ~away | counts)
    wandering = prepared_problem(changed(after, flow=after["flow"] + added), None, None, history=elsewhere)
    model = wandering.simulate((), nominal.values)
    assert (pattern_left(wandering, model, {"flow"}).posterior > 0.95) is counts


@pytest.mark.parametrize(("first", "counts"), [(0, False), (300, True)])
def test_a_simulation_that_settles_leaves_no_pattern(learnt, after, first, counts):
    # over within 5 % of the rows
    rows = np.arange(len(after)) - first
    added = 0.1 * np.nanmax(after["flow"]) * np.where(rows >= 0, np.exp(-np.abs(rows) / 10.0), 0.0)
    _, nominal = _prepared(after, learnt)
    settling = prepared_problem(changed(after, flow=after["flow"] + added), None, None, history=learnt)
    model = settling.simulate((), nominal.values)
    assert (pattern_left(settling, model, {"flow"}).posterior > 0.5) is counts


def _level(n):
    """Two standard deviations of the wander: a filter learns it from the first row that counts."""
    return np.full(n, 4.0)


def _outliers(n):
    """A row far off: a stroke that came late."""
    return np.where(np.arange(n) == n // 2, 60.0, 0.0)


@pytest.mark.parametrize("shape", [_level, _outliers])
def test_what_noise_may_be_is_no_pattern(monkeypatch, shape):
    assert _over_time(monkeypatch, shape(1200), np.zeros(1200)).posterior < 0.5


@pytest.mark.parametrize(("share", "likely"), [(0.05, False), (1.0, True)])
def test_an_effect_that_acts_at_times_may_be_wrong_on_the_whole_too(monkeypatch, share, likely):
    # ten strokes explained down to noise, and between them a swing that is small beside what they come to
    n = 1200
    moved = np.where(np.arange(n) % 120 < 6, 200.0, 0.0)
    swing = share * np.sqrt(np.mean(moved**2)) * np.sqrt(2.0) * np.sin(6.0 * np.pi * np.arange(n) / n)
    left = np.where(moved > 0.0, 0.0, swing) + np.random.default_rng(1).normal(size=n)
    assert (_over_time(monkeypatch, left, moved).posterior > PATTERN_POSTERIOR) is likely


def _over_time(monkeypatch, left, changed):
    """Pattern over time in what is left over of a flow, where an effect changes it."""
    n = len(left)
    noise = NoiseModel(np.ones(n), np.ones(n), 10.0, 0.0, 1e5, 4.0)
    problem = SimpleNamespace(
        residuals=lambda model: {"flow": left},
        noise={"flow": noise},
        spans={"flow": 100.0},
        least=lambda channel: 0.005,
        history=SimpleNamespace(allowed=Allowance()),
        recording=None,
    )
    bare, model = (
        SimpleNamespace(predictions={"flow": made}, chain=None, values=None)
        for made in (np.zeros(n), changed)
    )
    monkeypatch.setattr(smooth_pattern, "drop_is_unknown", lambda recording: False)
    monkeypatch.setattr(smooth_pattern, "rows_known", lambda problem, channel: np.ones(n, dtype=bool))
    monkeypatch.setattr(smooth_pattern, "static_inputs", lambda *_: {})
    return smooth_pattern._in_channel(problem, model, bare, "flow")


def test_a_flow_of_which_no_pressure_drop_is_known_says_nothing(before, after):
    blind = ValveHistory().fit(without(before, "p1", "p2"))
    problem, nominal = _prepared(without(after, "p1", "p2"), blind)
    assert pattern_left(problem, nominal, {"flow"}) is None


@pytest.mark.slow
def test_what_only_resembles_an_effect_is_none_of_these(learnt, after):
    # a gain that comes to less, and by bumps over the opening that no effect makes
    gained = 0.06 * (1.0 + 0.4 * _bumps(after["opening"]))
    recording = changed(after, flow=after["flow"] * (1.0 - gained))
    told = MissingPhysicsFinder(history=learnt, random_state=0, n_jobs=1).fit(recording).diagnosis_.content
    assert told["verdict"] == "none_of_these"
    rule = next(each for each in told["rules"] if each["name"] == "residual")
    assert rule["value"] > rule["limit"] == PATTERN_POSTERIOR
    assert "smooth pattern" in rule["sentence"]


@pytest.mark.slow
@pytest.mark.parametrize(("log_odds", "verdict"), [(2.0, "named"), (4.0, "none_of_these")])
def test_a_likely_pattern_takes_the_name(monkeypatch, learnt, after, log_odds, verdict):
    beside = Pattern("flow", ("opening",), 0.01, log_odds)
    monkeypatch.setattr(case_module, "pattern_left", lambda *_: beside)
    recording = changed(after, flow=0.9 * after["flow"])
    told = MissingPhysicsFinder(history=learnt, random_state=0, n_jobs=1).fit(recording).diagnosis_.content
    assert told["verdict"] == verdict
    assert any("smoothly over opening" in reason for reason in told["reasons"]) is (log_odds > 3.0)
