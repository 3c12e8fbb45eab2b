# SPDX-License-Identifier: BSD-3-Clause
"""The p-value: monotone, without steps, its tail open, and large for what is healthy."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.mismatch import CATALOGUE
from sklvalve.mismatch.decide.detect import (
    Evidence,
    covariates_of,
    effect_sizes,
    in_counts,
    law_for,
    mismatch_p_value,
    p_value_of_effects,
)
from sklvalve.mismatch.decide.null_reference import (
    AGAINST_HISTORY,
    AGAINST_SHEET,
    Covariates,
    survival,
)
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.search.relevance import standardized_effect_size as effect_size
from sklvalve.mismatch.search.rivals import Finding
from sklvalve.mismatch.search.scatter import OverTime
from sklvalve.mismatch.search.taking_up import Tried

EFFECTS, BEGUN, RESIDUAL = AGAINST_SHEET.throughout, AGAINST_SHEET.within, AGAINST_SHEET.residual
TABLES = [table for law in (AGAINST_SHEET, AGAINST_HISTORY) for table in law.tables.values()]
USUAL = Covariates(noise=-0.5, travel=0.6, no_opening=0.0, no_drop=0.0)
CIRCUMSTANCES = st.builds(
    Covariates,
    noise=st.floats(-6.0, 6.0),
    travel=st.floats(0.0, 1.5),
    no_opening=st.sampled_from((0.0, 1.0)),
    no_drop=st.sampled_from((0.0, 1.0)),
    one_pressure=st.sampled_from((0.0, 1.0)),
    held_opening=st.sampled_from((0.0, 1.0)),
    held_flow=st.sampled_from((0.0, 1.0)),
)
STRENGTHS = st.floats(0.0, 200.0)
BY_KEY = {effect.key: effect for effect in CATALOGUE}


def _explanation(tried, *findings, acting=None):
    return SimpleNamespace(tried=tried, acting=acting or {}, findings=list(findings))


BENCH = SimpleNamespace(least=lambda channel: {"flow": 0.005, "opening": 0.01}[channel], history=None)


def test_strength_takes_noise_and_a_wrong_simulation_together():
    assert effect_size(3.0, 0.8) == pytest.approx((1.0 / 9.0 + 0.1**2 / 0.8**2) ** -0.5, rel=1e-12)
    assert effect_size(5.0, 1e9) == pytest.approx(5.0)
    # however clear it is: what counts stands ten times above what a healthy simulation gets wrong
    assert effect_size(1e9, 1.0) == pytest.approx(10.0)
    assert effect_size(0.0, 1.0) == effect_size(1.0, 0.0) == effect_size(-1.0, 1.0) == 0.0


@settings(max_examples=50, deadline=None)
@given(STRENGTHS, STRENGTHS, st.floats(0.0, 50.0), st.floats(0.0, 50.0))
def test_strength_grows_with_what_is_borne_out_and_with_the_size(z, size, more, larger):
    assert effect_size(z + more, size + larger) >= effect_size(z, size) * (1.0 - 1e-12)
    assert effect_size(z, size) <= z * (1.0 + 1e-12)


def test_strongest_fit_of_each_effect_and_largest_channel_are_taken():
    assert in_counts({"flow": 0.01, "opening": 0.01}, BENCH) == pytest.approx(2.0)
    assert in_counts({}, BENCH) == 0.0


def test_stretches_that_disagree_take_from_the_strength_of_an_effect():
    sizes = {"flow": 0.02}
    tried = {"clogging": Tried(50.0, sizes), "erosion": Tried(50.0, sizes, over_time=OverTime(9.0, 50.0))}
    found = Finding(Term(BY_KEY["seat_leakage"]), [], 50.0, sizes, over_time=OverTime(9.0, 50.0))
    explanation = _explanation(tried, found)
    strengths = effect_sizes(explanation, BENCH)["throughout"]
    assert strengths["clogging"] == pytest.approx(effect_size(10.0, 4.0))
    assert strengths["erosion"] == strengths["seat_leakage"] < 0.5 * strengths["clogging"]
    weak, strong = Tried(8.0, {"flow": 0.005}), Tried(50.0, {"flow": 0.02})
    delayed = Tried(-9.0, {"opening": 0.5}, stage="actuator")
    tried = {"clogging": weak, "erosion": strong, "dead_time": delayed}
    searched = _explanation(tried)
    alone = {
        "clogging": effect_size(4.0, 1.0),
        "erosion": effect_size(10.0, 4.0),
    }
    seen = {"throughout": pytest.approx(alone), "stem": {"dead_time": 0.0}, "within": {}}
    assert effect_sizes(searched, BENCH) == seen
    eroded = Term(BY_KEY["erosion"])
    searched.findings = [Finding(eroded, [], 5000.0, {"flow": 0.02})]
    found = alone | {"erosion": effect_size(100.0, 4.0)}
    assert effect_sizes(searched, BENCH)["throughout"] == pytest.approx(found)
    assert effect_sizes(_explanation({}), BENCH) == {"throughout": {}, "stem": {}, "within": {}}


def test_what_begins_counts_by_what_it_gains_by_beginning():
    tried = {
        "clogging": Tried(5000.0, {"flow": 0.02}, by_beginning=50.0),
        "erosion": Tried(50.0, {"flow": 0.02}),
    }
    begun = Finding(Term(BY_KEY["clogging"], 900.0), [], 9000.0, {"flow": 0.02}, by_beginning=72.0)
    seen = effect_sizes(_explanation(tried, begun), BENCH)
    assert seen["within"] == {"clogging": pytest.approx(effect_size(12.0, 4.0))}
    assert seen["throughout"] == {"erosion": pytest.approx(effect_size(10.0, 4.0))}


def test_what_fits_better_with_a_beginning_counts_as_acting_throughout_too():
    tried = {"clogging": Tried(60.0, {"flow": 0.03}, by_beginning=10.0)}
    acting = {"clogging": Tried(50.0, {"flow": 0.02})}
    seen = effect_sizes(_explanation(tried, acting=acting), BENCH)
    assert seen["within"] == {"clogging": pytest.approx(effect_size(np.sqrt(20.0), 6.0))}
    assert seen["throughout"] == {"clogging": pytest.approx(effect_size(10.0, 4.0))}


@pytest.mark.parametrize("table", TABLES)
@settings(max_examples=50, deadline=None)
@given(STRENGTHS, st.floats(1e-3, 50.0), CIRCUMSTANCES)
def test_chance_of_more_falls_with_the_strength(table, value, more, where):
    assert 0.0 < survival(table, value + more, where) < survival(table, value, where) <= 1.0


@pytest.mark.parametrize("table", TABLES)
def test_chance_has_no_step_and_the_tail_goes_on_where_the_quantiles_end(table):
    at = np.array(table.quantiles) * table.typical(USUAL)
    for value, chance in zip(at[1:], np.linspace(1.0, table.above, len(at))[1:], strict=True):
        if value == 0.0:  # healthy recordings that show nothing
            continue
        for side in (1.0 - 1e-9, 1.0 + 1e-9):
            assert survival(table, side * value, USUAL) == pytest.approx(chance, abs=1e-6)
    assert survival(table, 0.0, USUAL) == 1.0
    far = np.sqrt(table.quantiles[-1] ** 2 + 6.0 * table.scale) * table.typical(USUAL)
    assert survival(table, far, USUAL) < 1.0 / table.recordings


def test_tail_is_that_of_pareto_or_of_the_exponential_where_its_shape_is_zero():
    table = replace(EFFECTS, shape=0.2, scale=0.5)
    over = np.sqrt(table.quantiles[-1] ** 2 + 2.0) * table.typical(USUAL)
    assert survival(table, over, USUAL) == pytest.approx(table.above * (1.0 + 0.2 * 4.0) ** -5.0)
    assert survival(replace(table, shape=0.0), over, USUAL) == pytest.approx(table.above * np.exp(-4.0))


def test_beyond_the_circumstances_of_the_reference_their_edge_is_taken():
    far, edge = (replace(USUAL, noise=noise) for noise in (9.0, EFFECTS.ranges["noise"][1]))
    assert EFFECTS.typical(far) == EFFECTS.typical(edge) > EFFECTS.typical(USUAL)


@settings(max_examples=50, deadline=None)
@given(st.tuples(STRENGTHS, STRENGTHS, STRENGTHS), st.tuples(*[st.floats(0.0, 50.0)] * 3), CIRCUMSTANCES)
def test_stronger_evidence_never_raises_the_p_value(found, more, where):
    weak, strong = Evidence(*found, where), Evidence(*np.add(found, more).tolist(), where)
    assert 1e-12 <= mismatch_p_value(strong) <= mismatch_p_value(weak) <= 1.0


@pytest.mark.parametrize(
    ("look", "share"), [("throughout", 0.225), ("stem", 0.225), ("within", 0.3), ("residual", 0.25)]
)
def test_looks_share_the_level(look, share):
    quiet = {"throughout": 0.0, "stem": 0.0, "within": 0.0, "residual": 0.0}
    alone = survival(AGAINST_SHEET.tables[look], 6.0, USUAL)
    seen = Evidence(**quiet | {look: 6.0}, covariates=USUAL)
    assert mismatch_p_value(seen) == pytest.approx(1.0 - (1.0 - alone) ** (1.0 / share))
    if look != "residual":
        # where nothing is known of what is left over the others have its share
        unknown = replace(seen, residual=None)
        assert mismatch_p_value(unknown) == pytest.approx(1.0 - (1.0 - alone) ** (0.75 / share))
        assert p_value_of_effects(seen) == mismatch_p_value(unknown)


def test_p_values_of_drawn_strengths_are_uniform():
    rng, chances = np.random.default_rng(0), []
    grid = np.geomspace(1e-3, 100.0, 4000)
    tables = AGAINST_SHEET.tables
    laws = {look: np.array([survival(table, v, USUAL) for v in grid]) for look, table in tables.items()}
    for _ in range(400):
        drawn = {look: float(np.interp(rng.random(), law[::-1], grid[::-1])) for look, law in laws.items()}
        chances.append(mismatch_p_value(Evidence(**drawn, covariates=USUAL)))
    share = np.searchsorted(np.sort(chances), [0.01, 0.05, 0.1, 0.5, 0.9]) / len(chances)
    # four standard deviations of a share of 400
    assert share == pytest.approx([0.01, 0.05, 0.1, 0.5, 0.9], abs=0.1)
    assert share[0] < 0.03


def test_circumstances_are_those_of_the_noise_and_of_the_movement():
    rows = np.linspace(0.2, 0.8, 1001)
    bench = SimpleNamespace(
        recording={"opening": rows, "command": rows, "flow": 3.0 * rows, "p1": rows, "p2": rows},
        channels=("opening", "flow"),
        spans={"opening": 1.0, "flow": 2.0},
        noise={"opening": SimpleNamespace(floor=0.005), "flow": SimpleNamespace(floor=0.02)},
        least=BENCH.least,
    )
    found = covariates_of(bench)
    assert found.noise == pytest.approx(np.log(2.0))
    assert found.travel == pytest.approx(0.9 * 0.6)
    assert (found.no_opening, found.no_drop, found.one_pressure) == (0.0, 0.0, 0.0)
    assert (found.held_opening, found.held_flow) == (0.0, 0.0)
    bench.recording = {"flow": 3.0 * rows}
    found = covariates_of(bench)
    assert found.travel == pytest.approx(0.9 * 0.6 / 0.8)
    assert (found.no_opening, found.no_drop, found.one_pressure) == (1.0, 1.0, 0.0)
    bench.recording = {"flow": 3.0 * rows, "p1": rows}
    assert (covariates_of(bench).no_drop, covariates_of(bench).one_pressure) == (1.0, 1.0)


def test_what_a_historian_leaves_out_is_a_circumstance():
    rows = np.linspace(0.2, 0.8, 101)
    bench = SimpleNamespace(
        recording={"opening": rows, "flow": rows, "p1": 8e5 + rows, "p2": 6e5 + rows},
        channels=("opening", "flow"),
        spans={"opening": 1.0, "flow": 4.0},
        noise={"opening": SimpleNamespace(floor=0.005), "flow": SimpleNamespace(floor=0.005)},
        least=BENCH.least,
        tolerated=lambda channel: 0.005,
    )

    def held(*found):
        told = covariates_of(bench, [{"finding": "compressed", **each} for each in found])
        return told.held_opening, told.held_flow

    lines, coarse = {"role": "opening"}, {"finding": "quantised", "role": "flow", "size": 1.0}
    assert held() == held(lines, coarse) == held({"role": "temperature", "size": 9.0}) == (0.0, 0.0)
    # in multiples of what counts: of the travel, of the span of the flow, of what a pressure moves the flow
    opening, flow, pressure = (
        {"role": role, "size": size} for role, size in (("opening", 0.005), ("flow", 0.04), ("p1", 8e3))
    )
    assert held(opening) == pytest.approx((np.log(2.0), 0.0))
    assert held(flow) == pytest.approx((0.0, np.log(3.0)))
    assert held(pressure) == pytest.approx((0.0, np.log(5.0)))
    # each channel for itself, by its widest
    assert held(pressure, flow, opening) == pytest.approx((np.log(2.0), np.log(5.0)))
    # where the drop is nowhere told, a pressure moves no simulated flow
    del bench.recording["p2"]
    assert held(pressure) == (0.0, 0.0)


def test_without_a_flow_no_drop_is_missed():
    rows = np.linspace(0.2, 0.8, 101)
    bench = SimpleNamespace(
        recording={"opening": rows, "command": rows},
        channels=("opening",),
        spans={"opening": 1.0},
        noise={"opening": SimpleNamespace(floor=0.005)},
        least=BENCH.least,
    )
    found = covariates_of(bench)
    assert (found.no_drop, found.one_pressure) == (0.0, 0.0)


@pytest.mark.parametrize("lacking", ["no_opening", "no_drop"])
def test_noise_is_known_as_far_as_it_went_among_recordings_that_lack_the_same(lacking):
    low, high = EFFECTS.ranges[lacking.replace("no_", "noise_without_")]
    lacks = replace(USUAL, **{lacking: 1.0})
    for far, edge in ((low - 1.0, low), (high + 1.0, high)):
        assert EFFECTS.typical(replace(lacks, noise=far)) == EFFECTS.typical(replace(lacks, noise=edge))
    between = EFFECTS.typical(replace(lacks, noise=0.5 * (low + high)))
    ends = [EFFECTS.typical(replace(lacks, noise=noise)) for noise in (low, high)]
    assert between == pytest.approx(np.sqrt(np.prod(ends)))


@pytest.mark.slow
def test_healthy_recording_is_one_among_many_and_a_leak_is_not(found_healthy, found_leaking):
    healthy = found_healthy.diagnosis_.to_dict()["mismatch"]["p_value"]
    leaking = found_leaking.diagnosis_.to_dict()["mismatch"]["p_value"]
    assert 0.02 < healthy <= 1.0
    assert leaking < 1e-4
    assert found_leaking.evidence_.throughout > 2.0 * found_healthy.evidence_.throughout


@pytest.mark.parametrize("history", [None, SimpleNamespace(rehearsals_=[])])
def test_what_drives_the_stem_is_looked_at_by_itself(history):
    searched = _explanation(
        {
            "friction": Tried(50.0, {"opening": 0.02}, stage="actuator"),
            "erosion": Tried(8.0, {"flow": 0.02}, stage="capacity"),
        }
    )
    problem = SimpleNamespace(least=BENCH.least, history=history)
    apart, law = effect_sizes(searched, problem), law_for(problem)
    assert set(apart["stem"]) == {"friction"}
    assert set(apart["throughout"]) == {"erosion"}
    evidence = Evidence.of(apart, None, USUAL, law)
    assert evidence.looks["stem"] == apart["stem"]["friction"] > evidence.looks["throughout"]
    weaker = Evidence.of(apart | {"stem": {}}, None, USUAL, law)
    assert mismatch_p_value(evidence) < mismatch_p_value(weaker)
