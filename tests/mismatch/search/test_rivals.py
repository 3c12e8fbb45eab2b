# SPDX-License-Identifier: BSD-3-Clause
"""What else could stand in the place of an effect: every other effect is fitted, and sampled where near."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.search import rivals

FOUND, POORLY_SCREENED, FAR = (
    next(e for e in CATALOGUE if e.key == key) for key in ("transducer_fault", "actuator_leak", "dead_time")
)
# of a gain of 1,900 nats 600 count as fourteen
# what is screened to first order may promise more than a fit keeps
SCREENED = {"actuator_leak": -3450.0, "dead_time": -3000.0}
FITTED = {"actuator_leak": -2500.0, "dead_time": -3490.0}
SAMPLED = {"actuator_leak": -2280.0, "dead_time": -2000.0}


def _model(effect, log_likelihood):
    return SimpleNamespace(terms=(Term(effect),), values={}, log_likelihood=log_likelihood)


@pytest.fixture
def bench(monkeypatch):
    """Fits whose likelihoods are known; it keeps which effects were sampled."""
    kept = []

    def sampled(problem, model):
        effect = model.terms[-1].effect
        kept.append(effect.key)
        return _model(effect, SAMPLED[effect.key])

    monkeypatch.setattr(
        rivals, "screened", lambda p, base, effects, **_: [_model(e, SCREENED[e.key]) for e in effects]
    )
    monkeypatch.setattr(rivals, "sampled_fit", sampled)
    monkeypatch.setattr(rivals, "to_the_sample", lambda problem, model: model)
    return SimpleNamespace(
        sampled=kept,
        simulate=lambda *_: None,
        judged=lambda _: _model(FOUND, -4160.0),
        fit=lambda terms, start: _model(terms[-1].effect, FITTED[terms[-1].effect.key]),
    )


def test_a_rival_that_is_screened_into_a_poor_valley_is_fitted_and_one_that_stays_far_is_not_sampled(bench):
    found, without = _model(FOUND, -2260.0), SimpleNamespace(log_likelihood=-4160.0)
    places = rivals._others_in_place(bench, found, (), without, (POORLY_SCREENED, FAR), found.terms[0])
    likelihoods = {term.effect.key: model.log_likelihood for term, model in places}
    assert likelihoods == {"actuator_leak": -2280.0, "dead_time": -3490.0}
    assert bench.sampled == ["actuator_leak"]
