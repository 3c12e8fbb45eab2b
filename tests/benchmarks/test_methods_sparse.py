# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from benchmarks.concealed.methods.nominal import nominal_of
from benchmarks.concealed.methods.operators import filled, slope_by, stick_and_jump
from benchmarks.concealed.methods.sparse_dictionary import dictionary
from benchmarks.concealed.methods.sparse_regression import System
from sklvalve.mismatch import CATALOGUE
from sklvalve.simulation.stages import play
from tests.benchmarks.methods_records import made, without


def test_a_stem_without_jumps_is_play():
    rng = np.random.default_rng(1)
    signal = 0.5 + 0.01 * np.cumsum(rng.standard_normal(300))
    assert stick_and_jump(signal, 0.04, 0.0) == pytest.approx(play(signal, 0.04), abs=1e-12)


def test_a_full_jump_ends_where_it_was_asked_to():
    stem = stick_and_jump(np.linspace(0.0, 1.0, 1001), 0.1, 0.1)
    moved = np.flatnonzero(np.diff(stem)) + 1
    assert stem[moved] == pytest.approx(np.linspace(0.0, 1.0, 1001)[moved], abs=1e-12)
    assert np.diff(stem)[moved - 1] == pytest.approx(0.051, abs=1.1e-3)


def test_slope_of_a_curve():
    x = np.random.default_rng(2).uniform(0.0, 1.0, 4000)
    slope = slope_by(x, x**2)
    inside = (x > 0.1) & (x < 0.9)
    assert slope[inside] == pytest.approx(2.0 * x[inside], abs=0.05)
    assert not slope_by(np.full(10, 0.3), np.ones(10)).any()


def test_gaps_are_bridged():
    assert filled(np.array([np.nan, 1.0, np.nan, 3.0])).tolist() == [1.0, 1.0, 2.0, 3.0]
    assert filled(np.full(2, np.nan)).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("roles", [(), ("opening",), ("p1", "p2"), ("command",), ("temperature",)])
def test_columns_are_of_the_catalogue_and_finite(roles):
    recording = without(made(), *roles)
    nominal = nominal_of(recording)
    columns = dictionary(nominal)
    known = {effect.name for effect in CATALOGUE}
    assert {name for c in columns for name in c.names} <= known
    assert {channel for c in columns for channel in c.parts} == set(nominal.problem.channels)
    assert all(part.shape == recording.time.shape for c in columns for part in c.parts.values())


def test_what_the_calibration_can_answer_is_projected_away():
    system = System(nominal_of(made()))
    # a zero of the meter throughout is calibration; one that comes about is not
    at = [k for k, names in enumerate(system.names) if names == ("flow_meter_bias",)]
    whole = next(k for k in at if system.begins[k] is None)
    half = next(k for k in at if system.begins[k] == 0.5)
    assert system.norms[whole] < 0.1 * system.norms[half]


def test_pursuit_finds_planted_columns_in_order_of_their_size():
    system = System(nominal_of(made()))
    names = [("sensor_lag",), ("erosion",)]
    planted = [
        next(k for k, n in enumerate(system.names) if n == name and system.begins[k] is None)
        for name in names
    ]
    sizes = np.array([2.0, 1.0]) / np.sqrt(system.norms[planted])
    grams = system._grams[:, planted]
    system._rights = np.einsum("i,bij->bj", sizes, grams)
    assert system.pursue(np.arange(10), 2) == planted
    assert system.weights(planted, np.arange(10)) == pytest.approx(sizes, rel=1e-6)


def test_chance_of_noise_is_no_small_number():
    nominal = nominal_of(made())
    system = System(nominal)
    rng = np.random.default_rng(3)
    p_values = []
    for _ in range(20):
        for channel in system._y:
            system._y[channel] = rng.standard_normal(len(system._y[channel]))
        p_values.append(system.p_value(rng))
    assert min(p_values) >= 1.0 / 200.0
    # twenty draws of a uniform number
    assert np.mean(p_values) == pytest.approx(0.5, abs=0.25)
