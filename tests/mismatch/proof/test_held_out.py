# SPDX-License-Identifier: BSD-3-Clause
"""Held-out rows are hidden from everything that predicts them, the learnt correction too."""

from dataclasses import replace
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

import sklvalve.mismatch.decide.case as case_module
import sklvalve.mismatch.decide.judgement as judgement_module
import sklvalve.mismatch.decide.judging as judging_module
import sklvalve.mismatch.finder as finder_module
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.mismatch.proof.forward import forward_in_time
from sklvalve.mismatch.proof.held_out import (
    CrossValidated,
    blocks,
    correction_holds_out,
    cross_validated,
    errors,
)
from sklvalve.mismatch.residual.low_pass_residual import learn_residual
from sklvalve.simulation import Tolerance
from tests.mismatch.conftest import record


@pytest.fixture(scope="module")
def bowed():
    """Trim that bends with the temperature: no effect of the catalogue."""
    return record("thermal_bow", 0.03, random_state=0)


# what is learnt of: a rest of the flow that has no period
REST = SimpleNamespace(channel="flow", period=None)


@pytest.fixture(scope="module")
def bench(bowed):
    return Problem.of(bowed, Tolerance(), bowed.valve.physics)


@pytest.fixture(scope="module")
def nominal(bench):
    return bench.least_squares(bench.fit((), max_steps=5))


def _shuffled_within(recording, held):
    """The same recording with the flow of some rows in another order, so that its span stays."""
    flow = recording["flow"].copy()
    flow[held] = np.random.default_rng(0).permutation(flow[held])
    return replace(recording, signals={**recording.signals, "flow": flow})


def test_blocks_cover_every_row_once():
    seen = np.zeros(1001, dtype=int)
    for held, others in blocks(1001):
        seen[held] += 1
        assert not others[held].any()
        assert others.sum() == 1001 - (held.stop - held.start)
    assert (seen == 1).all()


def test_correction_learns_from_the_rows_given_and_no_others(bowed, bench, nominal):
    held, others = next(iter(blocks(len(bowed))))
    changed = Problem.of(_shuffled_within(bowed, held), Tolerance(), bowed.valve.physics)
    same = changed.simulate((), nominal.values)
    one, two = (learn_residual(w, m, REST, others) for w, m in ((bench, nominal), (changed, same)))
    assert one.keys() == two.keys()
    for key in ("support", "coefficients", "intercept", "gamma", "span"):
        np.testing.assert_array_equal(one[key], two[key])
    assert one["inputs"] == two["inputs"]
    whole = [learn_residual(w, m, REST) for w, m in ((bench, nominal), (changed, same))]
    assert not np.array_equal(whole[0]["coefficients"], whole[1]["coefficients"])


def test_every_block_has_a_correction_of_its_own(bench, nominal):
    tried = cross_validated(bench, nominal, REST)
    once = cross_validated(bench, nominal)
    np.testing.assert_array_equal(once.learnt_residual, 0.0)
    for c, signal in once.predictions.items():
        np.testing.assert_array_equal(signal, tried.predictions[c])
    for held, _ in blocks(len(tried.learnt_residual)):
        assert np.abs(tried.learnt_residual[held]).max() > 0.0


def _tried(rest):
    """A flow of zeros and ones, simulated as zeros, with a rest learnt block by block."""
    flow = np.tile([0.0, 1.0], 200)
    bench = SimpleNamespace(recording={"flow": flow})
    return bench, CrossValidated({"flow": np.zeros(400)}, rest(flow))


@pytest.mark.parametrize(
    ("rest", "holds"),
    [
        (lambda flow: flow, True),
        (lambda flow: -flow, False),
        (lambda flow: np.zeros(400), False),
        # better in sum, thanks to half of the blocks
        (lambda flow: np.where(np.arange(400) < 200, flow, -0.2 * flow), False),
    ],
    ids=["right", "wrong", "none", "in places"],
)
def test_correction_must_improve_what_it_was_not_learnt_from(rest, holds):
    bench, tried = _tried(rest)
    kept, (without, with_it) = correction_holds_out(bench, tried, "flow")
    assert kept is holds
    assert without == pytest.approx(np.sqrt(0.5))
    assert with_it == pytest.approx(np.sqrt(np.mean((bench.recording["flow"] - tried.learnt_residual) ** 2)))


def _unrefereed(bench, judged):
    unknown = judged.unknown if judged.kept else None
    return judged, forward_in_time(bench, judged.nominal, judged.model, unknown)


@pytest.mark.slow
@pytest.mark.parametrize("kept", [True, False])
def test_a_rest_that_does_not_hold_out_is_not_told(monkeypatch, kept):
    told, bowed = [], record("thermal_bow", 0.06, random_state=0)

    def judged(*args):
        told.append(correction_holds_out(*args)[1])
        return kept, told[-1]

    monkeypatch.setattr(case_module, "correction_holds_out", judged)
    monkeypatch.setattr(judgement_module, "correction_holds_out", judged)
    # a rest as large as this one would be told all the same, and so would one beyond noise
    monkeypatch.setattr(case_module, "_LARGE", 1e3)
    monkeypatch.setattr(judging_module, "held_against_noise", lambda *args: (None, judging_module.FINE))
    # what rows ahead in time say of it is asked elsewhere
    monkeypatch.setattr(finder_module, "refereed", _unrefereed)
    # whether it is told at any lower level is no matter here
    finder = MissingPhysicsFinder(effects=("clogging",), alpha=0.5).fit(bowed)
    content = finder.diagnosis_.content
    assert (content["verdict"] == "none_of_these") is kept
    assert ("unknown" in content) is kept
    error = content["fit"]["flow"]["rmse"]
    same = np.array_equal(
        finder.corrected_simulation_.predict(bowed), finder.nominal_simulation_.predict(bowed)
    )
    assert same is not kept
    assert error["corrected"] == pytest.approx(error["nominal"], rel=1e-12) or kept
    if kept:
        assert content["unknown"]["correction"]["added"]
        # in the recording's own unit
        assert content["unknown"]["correction"]["rmse_with"] == pytest.approx(3600.0 * told[-1][1], rel=1e-9)
        interleaved = content["fit"]["flow"]["interleaved"]["rmse"]
        assert interleaved["corrected"] == pytest.approx(3600.0 * told[-1][1], rel=1e-6)


@pytest.mark.slow
def test_a_large_rest_that_does_not_hold_out_is_told_and_left_out(bowed, monkeypatch):
    for module in (case_module, judgement_module):
        monkeypatch.setattr(module, "correction_holds_out", lambda *args: (False, (1.0, 2.0)))
    finder = MissingPhysicsFinder(effects=("clogging",)).fit(bowed)
    content = finder.diagnosis_.content
    assert content["verdict"] == "none_of_these"
    assert content["unknown"]["correction"]["added"] is False
    error = content["fit"]["flow"]["rmse"]
    assert error["corrected"] == pytest.approx(error["nominal"], rel=1e-12)


def test_floor_that_was_passed_is_none():
    flow = np.random.default_rng(0).standard_normal(400)

    class Whole:
        bands: ClassVar[dict] = {}

        def __len__(self):
            return len(flow)

        def unit(self, role):
            return "m3/s"

        def in_recorded_units(self, role, values):
            return np.asarray(values)

        def per_si(self, role):
            return 1.0

        def __getitem__(self, role):
            return flow

        def __contains__(self, role):
            return role == "flow"

        def resolution(self, role):
            return 0.0

    made = {
        "nominal": {"flow": 0.0 * flow},
        "corrected": {"flow": 0.9 * flow},
        "black_box": {"flow": 0.5 * flow},
    }
    entry = errors(Whole(), made, np.ones(400, dtype=bool), "flow", 0.4)
    assert entry["noise_floor"] == pytest.approx(entry["rmse"]["corrected"])
    assert entry["skill"] == pytest.approx(1.0)
    assert max(entry["skill_ci95"]) <= 1.0
    low = errors(Whole(), made, np.ones(400, dtype=bool), "flow", 0.05)
    assert low["noise_floor"] == 0.05
    assert low["skill"] < 1.0
