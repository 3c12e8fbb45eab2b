# SPDX-License-Identifier: BSD-3-Clause
"""Long recordings: what is searched of them, and that what is found holds for all rows."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.decide import rules, stretches
from sklvalve.mismatch.decide.detect import Evidence, covariates_of
from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.decide.stretches import STRETCH, over_the_whole, stretches_of
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.residual.goodness_of_fit import LeftOver
from sklvalve.mismatch.residual.pulses import Pulses
from sklvalve.mismatch.residual.stem_residual import StemResidual
from sklvalve.mismatch.result.contents import flagged_rows
from sklvalve.mismatch.result.effect_entry import effect_entry
from sklvalve.mismatch.search.rivals import Finding, Rival
from sklvalve.recording import Recording, Valve

ONSET = 2100.0
BY_KEY = {effect.key: effect for effect in CATALOGUE}
SEEN = {
    "strays": lambda rows: StemResidual(rows, 5, 20, 0.02),
    "pulses": lambda rows: Pulses(rows, 12, 0, True, 0.02, 1e-3),
}


@pytest.fixture(scope="module")
def leaky():
    """A seat that leaks from a moment on which lies between two of the stretches searched."""
    made = make_valve_recording(
        "seat_leakage", 0.06, onset=ONSET, loop="wide", n_samples=4200, n_later=0, random_state=5
    )
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


def test_short_recordings_are_searched_whole(leaky):
    assert stretches_of(leaky, None) is leaky
    assert stretches_of(leaky, len(leaky)) is leaky
    assert stretches_of(leaky, int(0.9 * len(leaky))) is leaky


def test_stretches_lie_evenly_with_their_own_times_and_settle_unseen(leaky):
    part = stretches_of(leaky, 2 * STRETCH)
    assert len(part) == 2 * STRETCH
    place = np.searchsorted(leaky.time, part.time)
    np.testing.assert_array_equal(leaky.time[place], part.time)
    np.testing.assert_array_equal(np.flatnonzero(np.diff(place) > 1), [STRETCH - 1])
    assert (place[0], place[-1]) == (0, len(leaky) - 1)
    for role in ("opening", "flow"):
        hidden = np.isnan(part[role])
        np.testing.assert_array_equal(np.flatnonzero(hidden), np.arange(STRETCH, STRETCH + 40))
        np.testing.assert_array_equal(part[role][~hidden], leaky[role][place][~hidden])
    np.testing.assert_array_equal(part["command"], leaky["command"][place])


@pytest.mark.slow
def test_what_stretches_show_is_fitted_to_all_rows_and_dated_by_them(leaky):
    stages = []
    finder = MissingPhysicsFinder(
        effects=["clogging", "seat_leakage", "piping_reducers", "flow_meter_gain"],
        search_rows=1200,
        callback=lambda stage, done: stages.append(done),
    ).fit(leaky)
    content = finder.diagnosis_.content
    assert content["verdict"] == "named"
    assert finder.diagnosis_.effects[0][0] == "seat_leakage"
    assert content["provenance"]["rows"] == len(leaky)
    # all rows ahead of the first origin
    assert content["fit"]["flow"]["held_out_rows"] == len(leaky) - int(0.4 * len(leaky))
    # the first forecasts are of rows before it began
    errors = content["fit"]["flow"]["interleaved"]["rmse"]
    assert errors["corrected"] < 0.3 * errors["nominal"]
    # no row between 1,020 and 3,579 s was searched
    low, high = content["location"]["onset_ci95"]
    assert low <= ONSET <= high
    assert abs(content["location"]["onset"] - ONSET) < 300.0
    assert stages == sorted(stages)


@pytest.mark.slow
def test_rows_that_stretches_show_are_asked_for_in_the_whole(leaky, monkeypatch):
    whole = prepared_problem(leaky)
    bench = prepared_problem(stretches_of(leaky, 2 * STRETCH), trim=whole.trim)
    bench = bench.with_noise_of(bench.fit(()))
    nominal = bench.fit(())
    few, many = (np.ones(len(b.recording), dtype=bool) for b in (bench, whole))
    evidence = Evidence(0.1, 0.0, None, covariates_of(bench))
    told = Judgement(bench, "cannot_tell", 0.005, [], None, nominal, nominal, evidence=evidence)
    suspected = bench.fit((Term(BY_KEY["seat_leakage"]),), start=nominal)
    found = over_the_whole(whole, replace(told, suspected=suspected), 0.01)
    assert len(flagged_rows(whole, found)) == len(leaky)
    # of what the whole shows as well the rows are its own
    monkeypatch.setattr(stretches, "stem_residual", lambda *_: StemResidual(many, 9, 90, 0.02))
    monkeypatch.setattr(stretches, "find_pulses", lambda *_: Pulses(many, 12, 0, True, 0.02, 1e-3))
    for name, one in SEEN.items():
        found = over_the_whole(whole, replace(told, **{name: one(few)}), 0.01)
        assert (found.verdict, found.p_value) == ("cannot_tell", 0.005)
        assert len(getattr(found, name).rows) == len(leaky)
        assert flagged_rows(whole, found).all()
    # what the whole does not show, for all its rows, was chance in a few: its rule is taken back with it
    monkeypatch.undo()
    asked = (rules.rarity(0.005, 0.01), rules.nameless("It hunts."))
    for name, one in SEEN.items():
        found = over_the_whole(whole, replace(told, rules=asked, **{name: one(few)}), 0.01)
        assert [rule.name for rule in found.rules] == ["rarity"]
        assert (found.verdict, found.strays, found.pulses) == ("no_mismatch", None, None)
        assert found.p_value > 0.5


@pytest.mark.slow
def test_rivals_and_what_comes_closest_are_simulated_in_the_whole(leaky):
    whole = prepared_problem(leaky)
    bench = prepared_problem(stretches_of(leaky, 2 * STRETCH), trim=whole.trim)
    nominal = bench.fit(())
    models = [bench.fit((Term(BY_KEY[k]),), start=nominal) for k in ("flow_meter_drift", "seat_leakage")]
    rivals = [Rival(m.terms[0], m, 0.5, 0.0) for m in models]
    finding = Finding(models[0].terms[0], rivals, 10.0, {"flow": 0.01})
    told = Judgement(bench, "none_of_these", 0.005, [], None, nominal, nominal, closest=[finding])
    found = over_the_whole(whole, told, 0.01)
    (closest,) = found.closest
    assert all(len(r.model.predictions["flow"]) == len(leaky) for r in closest.rivals)
    # what grows is dated for its interval, which asks for every row
    assert effect_entry(closest, leaky, whole)["members"][0]["name"]
    told = replace(told, verdict="named", model=models[0], findings=[finding], closest=[])
    (named,) = over_the_whole(whole, told, 0.01).findings
    lost = [named.rivals[0].model.log_likelihood - r.model.log_likelihood for r in named.rivals]
    assert lost == pytest.approx([0.0, models[0].log_likelihood - models[1].log_likelihood])


def test_too_few_rows_to_search_are_refused():
    with pytest.raises(ValueError, match="search_rows"):
        MissingPhysicsFinder(search_rows=100).fit(None)


def test_all_rows_are_asked_again_of_what_was_found_and_left_too_much_over_and_of_nothing_else():
    too_much = LeftOver("flow", 0.03, 0.01, 0.01, 50.0)
    found = [SimpleNamespace(term=Term(BY_KEY["backlash"]))]

    def asked(closest, findings=(), leaves=too_much):
        judged = SimpleNamespace(closest=closest, findings=list(findings), closest_leaves=leaves)
        return stretches._leaves_too_much(judged)

    assert asked(found)
    # nothing was found; slips of the stem have a name beside it; no rule was asked; it leaves what it may
    assert not asked([])
    assert not asked(found, findings=found)
    assert not asked(found, leaves=None)
    assert not asked(found, leaves=LeftOver("flow", 0.01, 0.01, 0.01, 50.0))


def test_what_all_rows_uphold_is_simulated_without_what_the_search_held_beside_it():
    stands, dropped = (Term(BY_KEY[key]) for key in ("backlash", "clogging"))
    model = Model((stands, dropped), None, {}, {}, -100.0, {})
    finding = Finding(stands, [Rival(stands, model, 1.0, 0.0)], 50.0, {"flow": 0.03})
    judged = Judgement(
        None, "none_of_these", 1e-5, [], None, model, model, closest=[finding], kept=True, why=("refused",)
    )
    again = stretches._before_the_rule(judged)
    assert again.verdict == "named"
    assert again.findings == [finding]
    assert again.model.terms == (stands,)
    assert again.closest == []
    assert not again.kept
    assert again.why == ()


@pytest.mark.slow
def test_play_whose_side_stretches_do_not_know_is_named_by_all_rows():
    made = make_valve_recording("backlash", 0.04, n_samples=9000, n_later=0, loop="closed", random_state=2)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    finder = MissingPhysicsFinder(effects=["backlash", "seat_leakage"], search_rows=3840, random_state=0)
    content = finder.fit(recording).diagnosis_.content
    assert [member["name"] for member in content["effects"][0]["members"]] == ["backlash"]
    (noise,) = [rule for rule in content["rules"] if rule["name"] == "noise"]
    # by the stretches alone 5.4 times as much is left over as may be
    assert noise["passed"]
    assert noise["value"] < 1.0
    assert content["effects"][0]["parameters"]["width"]["value"] == pytest.approx(0.04, rel=0.15)
