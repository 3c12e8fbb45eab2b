# SPDX-License-Identifier: BSD-3-Clause
"""The catalogue as a whole: complete, its equal equations equal, its effects found again by a fit."""

import numpy as np
import pytest

from sklvalve.mismatch.data.preparation import candidates
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.mismatch.search.growing import fit_growing
from sklvalve.mismatch.search.onset_sample import to_the_sample
from sklvalve.simulation import Tolerance

from .conftest import DESIGNED, record

BY_KEY = {e.key: e for e in CATALOGUE}
PLACES = [(name, block) for block, names in DESIGNED.items() for name in names.split()]


def test_the_design_has_45_names():
    assert len({name for name, _ in PLACES}) == 45


@pytest.mark.parametrize(("name", "block"), PLACES)
def test_every_name_of_the_design_is_in_the_catalogue_in_its_block(name, block):
    assert any(e.name == name and e.block == block for e in CATALOGUE)


# ---- equal equations


@pytest.fixture(scope="module")
def bench(healthy):
    return Problem.of(healthy, Tolerance(), ())


@pytest.fixture(scope="module")
def values(bench):
    return {p.name: p.start for p in bench.calibration(bench.channels)}


EQUAL = [
    ("parallel", {"seat_leakage.leak_kv": 0.7}, {"bypass_open.bypass_kv": 0.7}),
    ("series", {"piping_reducers.loss": 1.2}, {"line_loss.loss": 1.2}),
    ("gain", {"flow_meter_gain.gain": 0.2}, {"capacity_error.gain": 0.2}),
    ("gain", {"flow_meter_gain.gain": 0.25}, {"density_change.ratio": 0.64}),
    ("growth", {"sedimentation.rate": 0.9}, {"flow_meter_drift_span.rate": -0.9}),
    ("pressure", {"inlet_pressure_bias.bias": 9e3}, {"outlet_pressure_bias.bias": -9e3}),
]


@pytest.mark.parametrize(("family", "one", "other"), EQUAL, ids=lambda x: x if isinstance(x, str) else "")
def test_effects_of_a_family_have_one_equation(family, one, other, bench, values):
    flows = []
    for own in (one, other):
        effect = BY_KEY[next(iter(own)).split(".")[0]]
        assert effect.family == family
        flows.append(bench.simulate((Term(effect),), values | own).predictions["flow"])
    np.testing.assert_allclose(flows[0], flows[1], rtol=1e-3, atol=1e-6 * bench.spans["flow"])
    healthy = bench.simulate((), values).predictions["flow"]
    assert np.max(np.abs(flows[0] - healthy)) > 0.01 * bench.spans["flow"]


# ---- tested or said why not


def test_every_name_is_tested_or_said_why_not(bench):
    found, untestable = candidates(bench, "all", [])
    told = {item["name"] for item in untestable}
    assert {e.name for e in found} | told == {e.name for e in CATALOGUE}
    # water between 0 and 100 degC, above its vapour pressure: neither a gas nor boiling
    assert {"gas_expansion", "flashing"} <= told
    assert not told & {e.name for e in found}


# ---- found again by a fit


def _calibrated(name, strength, onset=0.0):
    problem = Problem.of(record(name, strength, random_state=4, onset=onset), Tolerance(), ("choked_flow",))
    return calibrated(problem)


def _best(problem, nominal, key):
    effect = BY_KEY[key]
    many = max(len(q.starts) for q in effect.parameters)
    fits = [problem.fit((Term(effect),), start=nominal, attempt=k) for k in range(many)]
    return max(fits, key=lambda m: m.log_likelihood)


@pytest.mark.parametrize(
    ("name", "strength", "parameter", "size", "tolerance", "worse"),
    [
        # shares of a rated 40 m3/h; of a span of 60 m3/h in a third of an hour
        ("erosion", 0.06, "wear_kv", 2.4, 0.25, "seat_leakage"),
        ("sedimentation", 0.2, "rate", 0.6, 0.15, "flow_meter_drift"),
        ("flow_meter_drift", 0.06, "drift", 0.003, 0.15, "sedimentation"),
        ("sensor_lag", 10.0, "lag", 10.0, 0.1, "flow_inertia"),
    ],
)
def test_a_fit_finds_what_was_concealed(name, strength, parameter, size, tolerance, worse):
    problem, nominal = _calibrated(name, strength)
    fitted, other = _best(problem, nominal, name), _best(problem, nominal, worse)
    assert fitted.values[f"{name}.{parameter}"] == pytest.approx(size, rel=tolerance)
    assert fitted.log_likelihood > nominal.log_likelihood + 50.0
    assert fitted.log_likelihood > other.log_likelihood + 20.0


@pytest.mark.parametrize("onset", [400.0, 800.0])
def test_an_effect_that_grows_is_dated(onset):
    problem, nominal = _calibrated("sedimentation", 0.2, onset)
    begin = float(nominal.chain.clock[600])
    model = fit_growing(problem, nominal, BY_KEY["sedimentation"], onset=begin, max_steps=5)
    assert model.terms[-1].onset - nominal.chain.clock[0] == pytest.approx(onset, abs=50.0)
    assert model.values["sedimentation.rate"] == pytest.approx(0.2 * 3600.0 / (1200.0 - onset), rel=0.15)


def test_an_onset_is_moved_to_its_sample():
    problem, nominal = _calibrated("flow_meter_bias", 0.04, 500.0)
    begin, effect = float(nominal.chain.clock[0]), BY_KEY["flow_meter_bias"]
    for late in (-2.0, 0.0, 1.0):
        fitted = problem.fit((Term(effect, begin + 500.0 + late),), start=nominal)
        moved = to_the_sample(problem, fitted)
        # the meter shows at the first sample after its onset, or at that one
        assert moved.terms[-1].onset - begin == pytest.approx(500.5, abs=0.6)
        assert moved.log_likelihood >= fitted.log_likelihood
    throughout = problem.fit((Term(effect),), start=nominal)
    assert to_the_sample(problem, throughout) is throughout
