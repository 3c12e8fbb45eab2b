# SPDX-License-Identifier: BSD-3-Clause
"""Forecasts of a recording from its own past."""

from collections import namedtuple
from types import SimpleNamespace

import numpy as np
import pytest

import sklvalve.mismatch.proof.forward as forward
from sklvalve.mismatch.inference.origins import spans_of

N = 400
Begun = namedtuple("Begun", "onset")


def _model(level, *onsets):
    members = tuple(map(Begun, onsets))
    chain = SimpleNamespace(clock=np.arange(float(N)))
    return _Model(members, {"level": level}, chain)


class _Model(SimpleNamespace):
    def __init__(self, members, values, chain):
        super().__init__(terms=members, values=values, chain=chain)
        self.predictions = {"flow": np.full(N, values["level"])}


@pytest.fixture
def bench(monkeypatch):
    monkeypatch.setattr(forward, "lines_of", lambda problem, model: None)
    monkeypatch.setattr(forward, "refitted", lambda problem, model, lines, rows: model.values)
    return SimpleNamespace(
        recording=np.zeros(N),
        history=None,
        channels=("flow",),
        homoscedastic=lambda model, rows: None,
        least_squares=lambda model: model,
        simulate=lambda members, values: _model(values["level"], *(m.onset for m in members)),
    )


def test_spans_in_which_no_effect_takes_part_are_those_of_the_nominal(bench, monkeypatch):
    monkeypatch.setattr(forward, "replace", lambda model, terms: _Model(terms, model.values, model.chain))
    spans = spans_of(N)
    nominal, model = _model(1.0), _model(2.0, 0.75 * N)
    made = forward.forecast(bench, model, spans, nominal=nominal)["flow"]
    early = [span for span in spans if span.start <= 0.75 * N]
    assert early
    for span in spans:
        # its calibration was fitted beside an effect that has no part here, and is no forecast of it
        assert (made[span] == (1.0 if span in early else 2.0)).all()


def test_without_a_nominal_the_same_calibration_goes_on(bench, monkeypatch):
    monkeypatch.setattr(forward, "replace", lambda model, terms: _Model(terms, model.values, model.chain))
    made = forward.forecast(bench, _model(2.0, float(N)), spans_of(N))["flow"]
    assert (made[spans_of(N)[0].start :] == 2.0).all()


@pytest.mark.parametrize("history", [None, "some"])
def test_rows_before_an_origin_are_fitted_by_the_noise_of_a_history(bench, monkeypatch, history):
    asked, of = [], []

    def as_the_history_has_it(model, cautious):
        of.append((model, cautious))
        return "as before"

    monkeypatch.setattr(forward, "lines_of", lambda problem, model: asked.append(problem))
    bench.history, bench.homoscedastic = history, lambda model, rows: "of one size"
    bench.with_noise_of = as_the_history_has_it
    nominal = _model(1.0)
    forward.forecast(bench, _model(2.0), spans_of(N), nominal=nominal)
    assert set(asked) == {"as before" if history else "of one size"}
    # both hypotheses by the same, that of the nominal
    assert of == ([(nominal, True)] if history else [])
