# SPDX-License-Identifier: BSD-3-Clause
"""A verdict is held against forecasts: what a black box does better, and what makes rows ahead worse."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import sklvalve.mismatch.decide.referee as decision
from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.proof.black_box import black_box_prediction, settings_of
from sklvalve.mismatch.proof.comparison import Compared, compare, share_explained
from sklvalve.mismatch.proof.forward import Forward

N = 400
SPANS = tuple(slice(low, low + 60) for low in range(160, 400, 60))


class Recording(dict):
    """Signals by role, in SI and as recorded alike."""

    sample_time = 1.0

    def __len__(self):
        return N

    def per_si(self, channel):
        return 1.0

    def unit(self, channel):
        return "m3/h"


def _bench(**signals):
    flow = np.sin(np.arange(N) / 9.0)
    recording = Recording({"flow": flow, "p1": flow, "p2": flow} | signals)
    return SimpleNamespace(
        channels=("flow",),
        recording=recording,
        spans={"flow": 2.0},
        least=lambda channel: 0.005,
        touched_by=lambda terms: {c for m in terms for c in m.effect},
        plain=SimpleNamespace(clock=np.arange(float(N))),
    )


def _finding(*channels):
    return SimpleNamespace(term=SimpleNamespace(effect=channels))


def _forward(bench, **errors):
    noise = np.random.default_rng(0).standard_normal(N)
    made = {kind: {"flow": bench.recording["flow"] - size * noise} for kind, size in errors.items()}
    return Forward(made, SPANS, {"flow": False})


def _judgement(verdict, findings=(), p_value=0.4):
    return Judgement(None, verdict, p_value, list(findings), None, "nominal", SimpleNamespace(terms=()))


def _refereed(monkeypatch, bench, judged, **errors):
    monkeypatch.setattr(decision, "simulated", lambda model: model)
    monkeypatch.setattr(decision, "forward_in_time", lambda *asked: _forward(bench, **errors))
    return decision.refereed(bench, judged)


def test_nothing_is_missing_only_where_the_black_box_is_no_better(monkeypatch):
    bench = _bench()
    kept, _ = _refereed(
        monkeypatch, bench, _judgement("no_mismatch"), nominal=0.1, corrected=0.1, black_box=0.09
    )
    assert kept.verdict == "no_mismatch"
    told = "flow error is 0.102 m3/h; that of a black box on the same signals is 0.0914 m3/h"
    assert told in kept.referee.reasons[0]
    beaten, _ = _refereed(
        monkeypatch, bench, _judgement("no_mismatch"), nominal=0.1, corrected=0.1, black_box=0.04
    )
    assert beaten.verdict == "cannot_tell"
    assert beaten.detected
    assert beaten.p_value <= decision.BY_CHANCE
    assert beaten.suspects == ("valve",)
    assert "2.5 times better" in beaten.referee.reasons[0]


def test_what_is_too_small_to_count_is_not_held_against_a_simulation(monkeypatch):
    kept, _ = _refereed(
        monkeypatch, _bench(), _judgement("no_mismatch"), nominal=0.008, corrected=0.008, black_box=0.002
    )
    assert kept.verdict == "no_mismatch"


def test_without_pressures_it_abstains_and_says_what_to_record(monkeypatch):
    bench = _bench()
    del bench.recording["p2"]
    judged, _ = _refereed(
        monkeypatch, bench, _judgement("no_mismatch"), nominal=0.2, corrected=0.2, black_box=0.04
    )
    assert judged.verdict == "cannot_tell"
    assert not judged.detected
    assert "record p1 and p2" in judged.referee.reasons[0]


def test_a_correction_that_makes_rows_ahead_worse_is_taken_back(monkeypatch):
    named = _judgement("named", [object()])
    judged, forward = _refereed(monkeypatch, _bench(), named, nominal=0.05, corrected=0.06, black_box=0.09)
    assert judged.verdict == "cannot_tell"
    assert not judged.findings
    assert judged.model == "nominal"
    assert judged.suspected is named.model
    assert forward.predictions["corrected"] is forward.predictions["nominal"]
    assert "rises from 0.0508 m3/h to 0.0609 m3/h" in judged.referee.reasons[0]


def test_a_correction_that_makes_rows_ahead_worse_by_chance_stays(monkeypatch):
    bench, rng = _bench(), np.random.default_rng(1)
    forward = _forward(bench, nominal=0.05, corrected=0.05, black_box=0.09)
    recorded, noise = bench.recording["flow"], 0.05 * rng.standard_normal(N)
    # errors of the same size, none the other's, and one chosen to be larger by less than it scatters
    better = recorded - forward.predictions["nominal"]["flow"]
    scale = np.sqrt(1.005 * np.mean(better[forward.held] ** 2) / np.mean(noise[forward.held] ** 2))
    forward.predictions["corrected"]["flow"] = recorded - scale * noise
    monkeypatch.setattr(decision, "simulated", lambda model: model)
    monkeypatch.setattr(decision, "forward_in_time", lambda *asked: forward)
    judged, _ = decision.refereed(bench, _judgement("named", [_finding("flow")]))
    asked = next(rule for rule in judged.rules if rule.name == "forecast")
    assert 0.0 < asked.value < asked.limit
    assert judged.verdict == "named"
    assert "it rises by" in asked.sentence


def test_a_name_that_accounts_for_little_is_no_name(monkeypatch):
    named = _judgement("named", [_finding("flow")])
    judged, _ = _refereed(monkeypatch, _bench(), named, nominal=0.1, corrected=0.09, black_box=0.03)
    assert judged.verdict == "cannot_tell"
    assert judged.findings == named.findings
    assert judged.referee.share == pytest.approx((0.1**2 - 0.09**2) / (0.1**2 - 0.03**2))
    much, _ = _refereed(monkeypatch, _bench(), named, nominal=0.3, corrected=0.09, black_box=0.03)
    assert much.verdict == "named"
    assert "something else is missing too" in much.referee.reasons[0]
    elsewhere = _judgement("named", [_finding("opening")])
    kept, _ = _refereed(monkeypatch, _bench(), elsewhere, nominal=0.1, corrected=0.09, black_box=0.03)
    assert kept.verdict == "named"


def test_all_is_explained_where_the_correction_is_the_best():
    bench = _bench()
    compared = compare(bench, _forward(bench, nominal=0.3, corrected=0.02, black_box=0.1))
    assert share_explained(compared) == pytest.approx(1.0)
    nothing = compare(bench, _forward(bench, nominal=0.02, corrected=0.02, black_box=0.1))
    assert share_explained(nothing) is None


def test_a_black_box_must_be_better_nearly_everywhere():
    rmse, losses = {"corrected": 2.0, "black_box": 1.0}, {"corrected": 4.0, "black_box": 1.0}
    better = Compared("flow", 9, rmse, losses, consistent=3, exogenous=True, closed=False, added=np.zeros(9))
    assert better.clearly_better
    assert not replace(better, consistent=2).clearly_better
    # where nobody recorded the drop, the drop may be what it follows
    assert not replace(better, exogenous=False).clearly_better
    assert replace(better, exogenous=False, consistent=4).clearly_better


@pytest.mark.slow
def test_a_diagnosis_holds_the_comparison(found_healthy, found_leaking):
    for finder in (found_healthy, found_leaking):
        content = finder.diagnosis_.content
        told = content["referee"]
        assert set(told["channels"]) == {"opening", "flow"}
        for channel in told["channels"].values():
            assert set(channel["rmse"]) == {"nominal", "corrected", "black_box"}
            assert not channel["clearly_better"]
        assert content["reasons"] or finder is found_leaking
    assert found_healthy.diagnosis_.content["proof"] == "forward"
    # it begins at 500 s of 1,200: of the forecasts of the first stretch nothing of it is known yet
    assert found_leaking.diagnosis_.content["referee"]["share_explained"] > 0.5


@pytest.mark.slow
def test_forecasts_use_no_later_row(healthy):
    """Rows behind the last origin may be anything: what is forecast of the rows before stays as it is."""
    from sklvalve.mismatch.data.preparation import prepared_problem
    from sklvalve.mismatch.inference.calibrating import calibrated
    from sklvalve.mismatch.proof.forward import forward_in_time

    flow = healthy["flow"].copy()
    last = int(0.85 * len(healthy))
    flow[last:] = flow[last:][::-1]
    forecasts = []
    for signals in (healthy.signals, {**healthy.signals, "flow": flow}):
        bench = prepared_problem(replace(healthy, signals=signals))
        nominal = bench.simulate((), calibrated(prepared_problem(healthy))[1].values)
        forecasts.append(forward_in_time(bench, nominal, nominal).predictions)
    for kind in ("nominal", "black_box"):
        one, two = (made[kind]["flow"][:last] for made in forecasts)
        np.testing.assert_allclose(one, two, rtol=2e-3, equal_nan=True)


def test_a_channel_that_is_first_known_late_has_a_rival_all_the_same(healthy):
    flow = healthy["flow"].copy()
    flow[:600] = np.nan
    rows = np.arange(len(flow)) < 480
    made = black_box_prediction(replace(healthy, signals={**healthy.signals, "flow": flow}), "flow", rows)
    assert np.isfinite(made).all()
    still = {role: np.full(len(flow), 0.5) for role in ("command", "opening")}
    made = black_box_prediction(replace(healthy, signals={**healthy.signals, **still}), "opening", rows)
    np.testing.assert_allclose(made, 0.5)


def test_rows_asked_for_are_those_of_the_whole_prediction(healthy):
    train, later = np.arange(len(healthy)) < 480, slice(480, 560)
    whole = black_box_prediction(healthy, "flow", train)
    made = black_box_prediction(healthy, "flow", train, at=later)
    np.testing.assert_allclose(made, whole[later], rtol=1e-9)


def test_settings_are_those_of_the_rows_learnt_from_alone(healthy):
    train, later = np.arange(len(healthy)) < 700, np.arange(len(healthy)) >= 700
    disturbed = np.where(later, 3.0 * healthy["flow"] + 1.0, healthy["flow"])
    other = replace(healthy, signals={**healthy.signals, "flow": disturbed})
    chosen = settings_of(healthy, "flow", train)
    assert chosen is not None
    assert settings_of(other, "flow", train) == chosen
    made = black_box_prediction(healthy, "flow", train, settings=chosen)
    np.testing.assert_array_equal(made, black_box_prediction(healthy, "flow", train))
    # chosen otherwise they are heeded
    assert not np.allclose(made, black_box_prediction(healthy, "flow", train, settings=(2.0, 0.1)))


def test_settings_of_few_rows_serve_no_other_origin(healthy):
    assert settings_of(healthy, "flow", np.arange(len(healthy)) < 300) is None
