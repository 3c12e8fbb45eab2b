# SPDX-License-Identifier: BSD-3-Clause
"""Every effect of the catalogue: named as designed, with possible numbers, nothing at no size."""

import re

import numpy as np
import pytest

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.effects.backlash import play_with_overshoot
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.simulation import Tolerance
from sklvalve.simulation.stages import play

from .conftest import DESIGNED

# parameters at which an effect is none, where its nulls do not say so
NOTHING = {
    "slew_limit": {"speed": 1e9, "closing_ratio": 1e9},
    "choked_flow": {"fl": 1e3, "knee": 12.0, "slope": 0.0},
    "clogging": {"limit": 1.0},
    "clogging_closing": {"limit": 0.0},
    "sensor_lag": {"lag": 1e-6},
    "viscous_flow": {"viscosity": 1e-12, "sharpness": 2.0},
    "viscosity_change": {"viscosity": 1e-12, "fall": 0.04, "sharpness": 2.0},
    "gas_expansion": {"xt": 1e12},
}


def _nothing(effect):
    """Parameters at which an effect is none; None where there are none."""
    if effect.key in NOTHING:
        return NOTHING[effect.key]
    if all(q.null is None for q in effect.parameters):
        return None
    return {q.name: q.starts[0] if q.null is None else q.null for q in effect.parameters}


each_effect = pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.key)


@pytest.fixture(scope="module")
def bench(healthy):
    return Problem.of(healthy, Tolerance(), ())


@pytest.fixture(scope="module")
def plain(bench):
    values = {p.name: p.start for p in bench.calibration(bench.channels)}
    return bench.simulate((), values)


def _with(bench, plain, effect, own):
    values = plain.values | {f"{effect.key}.{name}": value for name, value in own.items()}
    return bench.simulate((Term(effect),), values)


def _start(effect, chain, i=0):
    return {q.name: q.starts[min(i, len(q.starts) - 1)] for q in effect.quantities(chain)}


def test_keys_are_unique():
    keys = [effect.key for effect in CATALOGUE]
    assert len(set(keys)) == len(keys)


@each_effect
def test_name_block_and_fault_are_as_designed(effect):
    designed = [block for block, names in DESIGNED.items() if effect.name in names.split()]
    assert effect.block in (designed or DESIGNED)
    assert re.fullmatch(r"(f\d+)?", effect.damadics)
    assert effect.separated_by.endswith(".")
    assert effect.needs
    assert effect.__doc__


@each_effect
def test_phrase_can_be_spoken(effect, plain):
    spoken = effect.phrase.format(pressure_unit="Pa", **_start(effect, plain.chain))
    assert spoken
    assert "{" not in spoken
    assert not spoken.endswith(".")


@each_effect
def test_parameters_lie_within_their_bounds(effect, plain):
    quantities = effect.quantities(plain.chain)
    assert [q.name for q in quantities] == [q.name for q in effect.parameters]
    for q in quantities:
        assert q.low < q.high
        assert not q.log or q.low > 0.0
        for i, start in enumerate(q.starts):
            assert q.low <= start <= q.high
            parameter = q.parameter_of(effect.key, i)
            assert (parameter.name, parameter.start) == (f"{effect.key}.{q.name}", start)
        # more attempts than starts: the last one again
        assert q.parameter_of(effect.key, 99).start == q.starts[-1]


@each_effect
def test_at_no_size_it_changes_nothing(effect, bench, plain):
    if getattr(effect, "motor", False):
        pytest.skip("a motor is another actuator: test_effects_motor.py")
    nothing = _nothing(effect)
    if nothing is None:
        pytest.skip("it is there wholly, or not at all")
    same = _with(bench, plain, effect, nothing)
    for quantity in effect.parameters:
        if quantity.null is not None:
            assert nothing[quantity.name] == pytest.approx(quantity.null, abs=1e-5)
    for channel, signal in plain.predictions.items():
        np.testing.assert_allclose(
            same.predictions[channel], signal, rtol=1e-9, atol=1e-9 * bench.spans[channel], err_msg=channel
        )


@each_effect
def test_at_its_start_it_changes_what_it_says(effect, bench, plain):
    touched = bench.channels_touched(effect)
    assert touched
    changed = False
    for i in range(max(len(q.starts) for q in effect.parameters)):
        other = _with(bench, plain, effect, _start(effect, plain.chain, i))
        sizes = bench.change(other, plain)
        assert all(sizes[c] == 0.0 for c in set(sizes) - set(touched))
        changed |= any(sizes[c] > 1e-4 for c in touched)
        assert all(np.isfinite(other.predictions[c]).all() for c in touched)
    # what this valve cannot have may change nothing here
    assert changed or not effect.possible(plain.chain)


@each_effect
def test_nothing_is_within_tolerance_where_there_is_one(effect, plain):
    tolerance = Tolerance()
    beyond = effect.beyond_tolerance(_start(effect, plain.chain), plain.chain, tolerance, True)
    assert beyond in (True, False)
    if effect.key in ("backlash", "dead_time", "flow_meter_bias", "position_sensor_bias", "capacity_error"):
        assert not effect.beyond_tolerance(_nothing(effect), plain.chain, tolerance, False)
        most = {q.name: q.high for q in effect.quantities(plain.chain)}
        assert effect.beyond_tolerance(most, plain.chain, tolerance, False)


def test_play_without_overshoot_is_play():
    stem = np.cumsum(0.02 * np.random.default_rng(0).standard_normal(500)) + 0.5
    stem[100:110] = np.nan
    np.testing.assert_array_equal(play_with_overshoot(stem, np.ones(500), 0.05, 0.0, 0.0), play(stem, 0.05))


def test_plug_stays_where_the_unseen_peak_of_a_stroke_took_it():
    # a stroke of 0.4 swings 0.02 beyond between two samples, and is back when it is seen
    stem = np.r_[np.full(20, 0.3), np.full(40, 0.7), np.full(40, 0.69)]
    plug = play_with_overshoot(stem, np.ones(100), 0.04, 0.05, 0.0)
    np.testing.assert_allclose(plug[20:], 0.7, atol=1e-12)
    assert np.all(np.abs(plug - stem) <= 0.02 + 1e-12)
    np.testing.assert_allclose(play(stem, 0.04)[20:], 0.68, atol=1e-12)
    # what moves slowly does not swing
    ramp = np.linspace(0.2, 0.4, 400)
    np.testing.assert_allclose(
        play_with_overshoot(ramp, np.ones(400), 0.04, 0.05, 0.0)[100:], ramp[100:] - 0.02, atol=1e-4
    )


@pytest.mark.parametrize("side", [-1.0, 0.5, 1.0])
def test_plug_stands_on_its_first_side_until_it_is_driven(side):
    stem = np.r_[np.full(10, 0.5), np.full(10, 0.9), np.full(10, 0.5)]
    plug = play_with_overshoot(stem, np.ones(30), 0.04, 0.0, side)
    np.testing.assert_allclose(plug[:10], 0.5 + 0.02 * side, atol=1e-12)
    np.testing.assert_allclose(plug[10:20], 0.88, atol=1e-12)
    np.testing.assert_allclose(plug[20:], 0.52, atol=1e-12)
