# SPDX-License-Identifier: BSD-3-Clause
"""Where effects are fitted from, one more beside those that were found."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.search import extended


@pytest.mark.parametrize("found", [(), ("backlash",)])
def test_beside_a_history_every_further_effect_is_tried_from_where_it_expects_the_valve(found, monkeypatch):
    begun = []

    def simulate(terms, values):
        begun.append((terms, values))
        return SimpleNamespace(terms=terms, values=values)

    problem = SimpleNamespace(simulate=simulate, judged=lambda m: m, fit=lambda terms, start: (terms, start))
    # the calibration has run away to take up what the hypothesis lacks
    model = SimpleNamespace(terms=found, values={"fl_scale": 0.92, "backlash.width": 0.04})
    monkeypatch.setattr(extended, "expected_values", lambda problem: {"fl_scale": 1.01})
    monkeypatch.setattr(
        extended,
        "screened",
        lambda problem, base, effects: [
            SimpleNamespace(terms=(*base.terms, SimpleNamespace(effect=e)), gain=k)
            for k, e in enumerate(effects)
        ],
    )
    monkeypatch.setattr(extended, "penalised_likelihood", lambda problem, m: m.gain)
    effects = [SimpleNamespace(key=key) for key in ("cavitation", "two_phase", "choked_flow")]
    tried = extended._from_what_is_known(problem, model, effects)
    assert begun == [(found, {"fl_scale": 1.01, "backlash.width": 0.04})]
    assert [terms[-1].effect.key for terms, _ in tried] == ["choked_flow", "two_phase"]
    assert all(terms[:-1] == found for terms, _ in tried)
