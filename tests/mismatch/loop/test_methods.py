# SPDX-License-Identifier: BSD-3-Clause
"""Published methods on a limit cycle by sticking, a sine from outside, noise, and nothing."""

import functools

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mismatch.loop.methods import (
    area,
    cross_correlation,
    curve_shape,
    ellipse,
    hammerstein,
    published_methods,
    relay,
)
from sklvalve.mismatch.loop.methods.ellipse import nonlinearity_indices, width_of_ellipse
from sklvalve.mismatch.loop.methods.half_periods import (
    POINTS,
    half_periods,
    relays,
    residual_squares,
    sines,
    triangles,
)
from sklvalve.mismatch.loop.oscillation import find_oscillation

_NAMES = [
    "cross-correlation",
    "relay fitting",
    "peak area",
    "bicoherence and ellipse",
    "curve fitting",
    "Hammerstein fit",
]


@functools.cache
def _loop(stick=4.0, slip=2.0, upset=0.0, noise=0.02, rows=16000):
    """Command [%] and value of a PI loop whose valve sticks, period about 190 rows; `upset` from outside."""
    rng = np.random.default_rng(0)
    command = stem = value = 50.0
    last = 0.0
    out = np.empty((2, rows))
    for k in range(rows):
        seen = value + noise * rng.standard_normal()
        error = 50.3 - seen
        command += 0.2 * (error - last + error / 5.0)
        last = error
        if abs(command - stem) > 0.5 * (stick + slip):
            stem = command - np.sign(command - stem) * 0.5 * (stick - slip)
        value += (stem + upset * np.sin(k / 40.0) - value) / 3.0
        out[:, k] = command, seen
    return out[:, 1000:]


def _at(signals, rows_wanted, count=None):
    """Signals on another grid of rows, so that a period has as many as wanted."""
    period = find_oscillation(*signals, 1.0).rows
    at = np.arange(0.0, signals.shape[1] - 1.0, period / rows_wanted)[:count]
    return np.array([np.interp(at, np.arange(signals.shape[1]), each) for each in signals])


def _says(signals, sample_time, **given):
    return {found.method: found for found in published_methods(*signals, sample_time, **given)}


@pytest.mark.parametrize("sample_time", [0.2, 60.0])
@pytest.mark.parametrize("rows", [20, 100, 500])
def test_a_limit_cycle_by_sticking_is_found_by_all(rows, sample_time):
    found = _says(_at(_loop(), rows), sample_time, is_flow=True)
    assert list(found) == _NAMES
    # a value that stays where it jumped to has a flat top: where its peak lies is then left to the noise
    assert found["peak area"].statistic > 1.2
    assert {found[name].says for name in _NAMES if name != "peak area"} == {"stiction"}
    assert found["Hammerstein fit"].band == pytest.approx(4.0, rel=0.3)
    assert found["bicoherence and ellipse"].band == pytest.approx(4.0, rel=0.3)


def test_five_rows_in_a_period_are_too_few_for_a_shape():
    found = _says(_at(_loop(), 5), 1.0, is_flow=True)
    for name in ("relay fitting", "peak area", "bicoherence and ellipse", "curve fitting"):
        assert found[name].says == "not applicable"
        assert "rows" in found[name].detail
    assert found["cross-correlation"].says == "stiction"
    assert found["Hammerstein fit"].says == "stiction"


@pytest.mark.parametrize("rows", [5, 20, 100, 500])
def test_a_sine_from_outside_has_the_shape_of_a_sine(rows):
    found = _says(_at(_loop(stick=0.0, slip=0.0, upset=2.0), rows), 1.0, is_flow=True)
    wanted = "not applicable" if rows == 5 else "no stiction"
    for name in ("relay fitting", "bicoherence and ellipse", "curve fitting"):
        assert found[name].says == wanted
    assert found["peak area"].says in ("undecided", "not applicable")
    assert found["Hammerstein fit"].says == "no stiction"


def test_a_fast_outside_sine_is_even():
    wave = np.arange(2000) * 2.0 * np.pi / 30.0
    signals = -np.sin(wave), np.sin(wave + 0.2)
    assert cross_correlation(*signals, find_oscillation(*signals, 1.0)).says == "no stiction"


def test_noise_is_no_oscillation_and_no_stiction():
    found = _says(np.random.default_rng(1).standard_normal((2, 1500)), 1.0, is_flow=True)
    assert found.pop("Hammerstein fit").says == "no stiction"
    assert {result.says for result in found.values()} == {"not applicable"}


@pytest.mark.parametrize("count", [5, 400])
def test_what_does_not_move_is_not_applicable(count):
    for result in published_methods(np.full(count, 40.0), np.full(count, 2.5), 1.0):
        assert result.says == "not applicable"
        assert result.statistic is None
        assert result.band is None


def test_units_offsets_and_signs_change_nothing():
    command, value = _at(_loop(), 40, 2400)
    first = published_methods(command, value, 1.0)
    second = published_methods(0.01 * command, 1e3 - 50.0 * value, 1.0)
    for one, other in zip(first, second, strict=True):
        assert one.says == other.says
        assert other.statistic == pytest.approx(one.statistic, rel=1e-4)
        if one.band is not None:
            assert other.band == pytest.approx(0.01 * one.band, rel=1e-4)


def test_gaps_and_a_set_point_are_taken():
    command, value = _at(_loop(), 40, 2400)
    value = value.copy()
    value[500:505] = np.nan
    results = published_methods(command, value, 1.0, setpoint=np.full(len(value), 50.3))
    assert [result.says for result in results] == ["stiction"] * 6


def test_a_process_that_may_integrate_is_left_alone_by_two():
    signals = _at(_loop(), 40, 2400)
    found = _says(signals, 1.0, is_flow=False)
    assert found["cross-correlation"].says == found["peak area"].says == "not applicable"
    # steps of the value are far from triangles
    assert found["curve fitting"].statistic != _says(signals, 1.0)["curve fitting"].statistic


@pytest.mark.parametrize("peak", [0.2, 0.5, 0.8])
def test_triangles_and_sines_are_told_apart(peak):
    phase = np.arange(3000) / 37.3 % 1.0
    half = 2.0 * phase % 1.0
    wave = np.sign(0.5 - phase) * np.minimum(half / peak, (1.0 - half) / (1.0 - peak))
    oscillation = find_oscillation(wave, wave, 1.0)
    assert curve_shape(wave, wave, oscillation).says == "stiction"
    assert curve_shape(np.sin(2 * np.pi * phase), wave, oscillation).says == "no stiction"
    assert relay(wave, oscillation).says == "stiction"
    # the filter against noise rounds the peak off and moves it towards the middle
    ratio, wanted = area(wave, oscillation).statistic, peak / (1.0 - peak)
    assert min(wanted, 1.0) * 0.9 < ratio < max(wanted, 1.0) * 1.1
    assert (ratio - 1.0) * (wanted - 1.0) >= 0.0 or peak == 0.5


def test_a_relays_answer_leaves_nothing_of_itself():
    at = np.linspace(0.0, 1.0, POINTS)
    shapes = relays(np.array([1e-3, 0.3, 30.0]))
    assert_allclose(shapes[0][2:-2], 1.0, atol=0.02)
    assert_allclose(shapes[2] / shapes[2].max(), np.minimum(2.0 * at, 2.0 - 2.0 * at), atol=0.05)
    assert_allclose(shapes[:, [0, -1]], 0.0, atol=1e-9)
    assert residual_squares(shapes[1:2], relays(np.array([0.3])))[0] == pytest.approx(0.0, abs=1e-12)


def test_half_periods_are_cut_from_zero_to_zero():
    wave = np.sin(2.0 * np.pi * np.arange(1000) / 50.0) + np.linspace(0.0, 20.0, 1000)
    shapes = half_periods(wave, 50.0)
    assert 34 <= len(shapes) <= 40
    assert (residual_squares(shapes, sines()) < 0.01 * (shapes**2).sum(axis=1)).mean() > 0.9
    assert triangles().max() <= 1.0


def test_the_width_of_an_ellipse_is_its_chord_along_the_command():
    angle = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    command, value = 10.0 + 3.0 * np.cos(angle), 5.0 + 2.0 * np.sin(angle + 0.4)
    # on the chord through the centre the value is at its middle: sin(angle + 0.4) = 0
    assert width_of_ellipse(command, value) == pytest.approx(6.0 * np.cos(0.4), rel=1e-6)
    assert width_of_ellipse(np.ones(9), np.ones(9)) is None


def test_coupled_harmonics_are_nonlinear_and_loose_ones_are_not():
    rng = np.random.default_rng(2)
    phase = 2.0 * np.pi * np.arange(1000) / 10.4 + np.cumsum(0.1 * rng.standard_normal(1000))
    loose = 2.0 * np.pi * np.arange(1000) / 5.2 + np.cumsum(0.3 * rng.standard_normal(1000))
    noise = 0.1 * rng.standard_normal(1000)
    gaussian, linear = nonlinearity_indices(np.sin(phase) + 0.4 * np.sin(2.0 * phase) + noise)
    assert gaussian > 0.1
    assert linear > 0.1
    assert nonlinearity_indices(np.sin(phase) + 0.4 * np.sin(loose) + noise)[0] < 0.001


def test_few_periods_are_too_few_for_a_bicoherence():
    signals = _at(_loop(), 50, 600)
    result = ellipse(*signals, find_oscillation(*signals, 1.0))
    assert result.says == "not applicable"
    assert "periods" in result.detail


def test_a_short_record_is_not_fitted():
    signals = _at(_loop(), 20, 50)
    assert "rows" in hammerstein(*signals, find_oscillation(*signals, 1.0)).detail
