# SPDX-License-Identifier: BSD-3-Clause
"""Intervals of parameters by their parts."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch.describe.intervals import SHARE_OFF, interval_of
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.simulation import Tolerance
from sklvalve.simulation.fitting import Misfit

BY_KEY = {e.key: e for e in CATALOGUE}


@pytest.fixture(scope="module")
def bench(healthy):
    return Problem.of(healthy, Tolerance(), ())


def _fitted(bench, key, own, spreads, onset=None):
    member = Term(BY_KEY[key], onset)
    nominal = bench.fit((), max_steps=2)
    values = nominal.values | {f"{key}.{name}": value for name, value in own.items()}
    model = replace(bench.simulate((member,), values), spreads={f"{key}.{n}": s for n, s in spreads.items()})
    return member, model


def _interval(bench, key, own, spread, onset=None):
    first = next(iter(own))
    member, model = _fitted(bench, key, own, {first: spread}, onset)
    quantity = next(q for q in member.effect.quantities(model.chain) if q.name == first)
    return interval_of(bench, member, model, quantity)


@pytest.fixture
def held(bench, monkeypatch):
    """The problem with a calibration that answers nothing."""

    def alone(problem, model, channels):
        (member,) = model.terms
        touched = problem.channels_touched(member.effect)
        own = [q.parameter_of(member.effect.key) for q in member.effect.quantities(model.chain)]
        return [Misfit(model.chain, own, touched, problem.noise, fixed=model.values)]

    monkeypatch.setattr(Problem, "misfits", alone)
    return bench


@pytest.mark.parametrize("spread", [0.0, 2e-5, 2e-4])
def test_of_what_acts_in_proportion_the_share_is_that_of_its_value(held, spread):
    ends = _interval(held, "flow_meter_bias", {"bias": 4e-4}, spread)
    half = np.hypot(1.96 * spread, SHARE_OFF * 4e-4)
    np.testing.assert_allclose(ends, [4e-4 - half, 4e-4 + half], rtol=1e-6)


def test_of_a_limit_it_is_as_far_as_changes_the_effect_by_its_share(held):
    member, model = _fitted(held, "clogging", {"limit": 0.5}, {"limit": 1e-4})
    low, high = interval_of(held, member, model, member.effect.quantities(model.chain)[0])
    assert 0.4 < low < 0.5 < high < 0.6
    own = model.predictions["flow"]
    none = held.simulate((), model.values).predictions["flow"]
    moved = held.simulate(model.terms, model.values | {"clogging.limit": high}).predictions["flow"]
    share = np.sqrt(np.nanmean((moved - own) ** 2) / np.nanmean((own - none) ** 2))
    assert share == pytest.approx(SHARE_OFF, rel=0.25)


def test_a_calibration_answers_as_far_as_the_sheet_lets_it(healthy, bench):
    def width(problem):
        low, high = _interval(problem, "flow_meter_bias", {"bias": 4e-4}, 0.0)
        return high - low

    alone = 2.0 * SHARE_OFF * 4e-4
    narrow = Tolerance(capacity=1e-6, trim=1e-6, position_zero=1e-6, flow_zero=1e-6, pressure_zero=1e-6)
    assert width(Problem.of(healthy, narrow, ())) == pytest.approx(alone, rel=0.05)
    assert 1.2 * alone < width(bench) < 4.0 * alone


@pytest.mark.parametrize(
    ("key", "name", "value", "sound"),
    [
        ("backlash_linkage", "width", 0.04, 0.01),
        ("positioner_deadband", "half_width", 0.03, 0.005),
        ("friction", "friction", 0.2, 0.025),
    ],
)
def test_a_static_error_of_a_sound_valve_may_be_in_it_or_not(held, key, name, value, sound):
    ends = {}
    for error in (1e-6, 0.01):
        open_by = replace(held, tolerance=replace(held.tolerance, static_error=error, play=error))
        ends[error] = np.array(_interval(open_by, key, {name: value}, 0.0))
    np.testing.assert_allclose(ends[0.01] - ends[1e-6], [-sound, sound], rtol=1e-3)


def test_a_delay_from_the_start_is_known_to_one_scan_at_best(held):
    clock, scan = held.plain.clock, held.recording.sample_time
    early = np.array(_interval(held, "dead_time", {"delay": 6.0}, 0.0))
    late = np.array(_interval(held, "dead_time", {"delay": 6.0}, 0.0, float(clock[len(clock) // 3])))
    assert early[0] < 6.0 - scan
    assert early[1] > 6.0 + scan
    # what a calibration holds of it was seen before, then
    assert late[1] - late[0] < early[1] - early[0] - scan


def test_what_grows_may_have_begun_elsewhere_and_grow_faster(bench, monkeypatch):
    clock = bench.plain.clock
    onset = float(clock[len(clock) // 3])
    ends = {}
    for sizes in ((1.0, 1.0), (0.8, 1.6)):
        monkeypatch.setattr(
            "sklvalve.mismatch.describe.intervals.time_profile_of_cause",
            lambda *_, sizes=sizes: type("Course", (), {"sizes": sizes}),
        )
        ends[sizes] = np.array(_interval(bench, "sedimentation", {"rate": 2e-5}, 1e-7, onset))
    np.testing.assert_allclose(ends[0.8, 1.6] - ends[1.0, 1.0], [-0.2 * 2e-5, 0.6 * 2e-5], rtol=1e-3)


def test_without_a_deviation_there_is_no_interval_and_none_leaves_what_is_possible(bench):
    member, model = _fitted(bench, "clogging", {"limit": 0.5}, {})
    quantity = member.effect.quantities(model.chain)[0]
    assert interval_of(bench, member, model, quantity) is None
    member, model = _fitted(bench, "clogging", {"limit": 0.5}, {"limit": 10.0})
    assert interval_of(bench, member, model, quantity) == (quantity.low, quantity.high)
