# SPDX-License-Identifier: BSD-3-Clause
"""Noise models whiten what they were fitted to, gaps included, and take no more than they may."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from scipy.signal import lfilter

from sklvalve.simulation import noise_fit
from sklvalve.simulation.noise import TIMING, NoiseModel, NoiseParts, movement
from sklvalve.simulation.noise_fit import fit_noise
from sklvalve.simulation.robust import robust_cost

ROWS = 2000


def _noise(seed, *, white=1.0, fast=0.0, fast_time=4.0, slow=0.0, slow_time=200.0):
    """White noise, quickly correlated noise and wander of these standard deviations, a row a second."""
    rng = np.random.default_rng(seed)
    total = white * rng.standard_normal(ROWS)
    for size, time in ((fast, fast_time), (slow, slow_time)):
        keep = np.exp(-1.0 / time)
        drive = size * np.sqrt(1.0 - keep * keep) * rng.standard_normal(ROWS)
        drive[0] = size * rng.standard_normal()
        total += lfilter([1.0], [1.0, -keep], drive)
    return total


def _autocorrelation(values, lag):
    left = values - values.mean()
    return float(np.sum(left[lag:] * left[:-lag]) / np.sum(left * left))


MIXTURES = {
    "white": {},
    "quickly correlated": {"white": 0.5, "fast": 1.0},
    "wandering": {"white": 1.0, "slow": 1.0},
    "all": {"white": 0.7, "fast": 0.8, "slow": 1.5},
    "small numbers": {"white": 1e-6, "fast": 1e-6, "slow": 2e-6},
}


@pytest.mark.parametrize("name", MIXTURES)
@pytest.mark.parametrize("gaps", [False, True])
def test_innovations_are_white_and_of_size_one(name, gaps):
    residuals = _noise(3, **MIXTURES[name])
    if gaps:
        residuals[300:380] = np.nan
        residuals[::17] = np.nan
    # a signal that neither moves nor grows gives timing and size nothing to weigh on
    simulated = np.full(ROWS, 10.0 * np.nanstd(residuals))
    noise = fit_noise(residuals, simulated, np.ones(ROWS))
    white = noise.whiten(residuals)
    seen = np.isfinite(residuals)
    np.testing.assert_array_equal(white[~seen], 0.0)
    assert np.std(white[seen]) == pytest.approx(1.0, abs=0.1)
    # four standard errors of an autocorrelation of white noise
    for lag in (1, 2, 5, 10, 50):
        assert abs(_autocorrelation(white[seen], lag)) < 4.0 / np.sqrt(seen.sum())


def test_taken_for_white_the_same_noise_is_not():
    residuals = _noise(3, **MIXTURES["all"])
    assert _autocorrelation(residuals, 1) > 0.4


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 10_000),
    st.floats(0.1, 3.0),
    st.floats(0.0, 3.0),
    st.floats(0.5, 30.0),
    st.floats(0.0, 3.0),
    st.floats(40.0, 400.0),
)
def test_the_true_filter_whitens(seed, white, fast, fast_time, slow, slow_time):
    residuals = _noise(seed, white=white, fast=fast, fast_time=fast_time, slow=slow, slow_time=slow_time)
    step = np.ones(ROWS)
    noise = NoiseModel(np.full(ROWS, white**2), step, fast_time, fast**2, slow_time, slow**2)
    out = noise.whiten(residuals)
    # five standard errors, for there are many examples
    assert np.std(out) == pytest.approx(1.0, abs=5.0 / np.sqrt(2.0 * ROWS))
    for lag in (1, 3, 10):
        assert abs(_autocorrelation(out, lag)) < 5.0 / np.sqrt(ROWS)
    assert noise.total == pytest.approx(np.sqrt(white**2 + fast**2 + slow**2), rel=1e-12)
    # wander is nothing that no simulation could follow
    assert noise.floor == pytest.approx(np.sqrt(white**2 + fast**2), rel=1e-12)


def test_correlated_parts_are_no_larger_than_allowed():
    residuals = _noise(5, white=0.1, slow=5.0)
    noise = fit_noise(residuals, np.full(ROWS, 100.0), np.ones(ROWS), largest=0.5)
    assert np.sqrt(noise.fast_size) <= 0.5 * (1.0 + 1e-9)
    assert np.sqrt(noise.slow_size) <= 0.5 * (1.0 + 1e-9)


def test_cautious_noise_does_not_take_up_a_step():
    residuals = _noise(6, white=0.1)
    residuals[1000:] += 2.0
    simulated, step = np.full(ROWS, 10.0), np.ones(ROWS)
    free = fit_noise(residuals, simulated, step)
    held = fit_noise(residuals, simulated, step, cautious=True)
    assert held.total < 0.3
    assert np.sum(held.whiten(residuals) ** 2) > np.sum(free.whiten(residuals) ** 2)


def test_resolution_and_inadequacy_are_floors():
    flat = fit_noise(np.zeros(ROWS), np.full(ROWS, 5.0), np.ones(ROWS), quantum=0.6, inadequacy=0.1)
    assert flat.total >= np.sqrt(0.6**2 / 12.0 + 0.1**2)
    # the resolution is the sensor's, the inadequacy the simulation's
    assert 0.6 / np.sqrt(12.0) <= flat.floor < 0.6 / np.sqrt(12.0) + 0.01


def test_floor_is_the_sensors_and_not_the_simulations():
    residuals = 0.1 * np.random.default_rng(8).standard_normal(ROWS)
    noise = fit_noise(residuals, np.full(ROWS, 5.0), np.ones(ROWS), inadequacy=0.5)
    assert noise.total >= 0.5
    # an error of the simulation that is allowed for is not out of any simulation's reach
    assert noise.floor < 0.15
    late = NoiseModel(np.full(ROWS, 4.0), np.ones(ROWS), 4.0, 0.09, 200.0, 1.0, sensor=0.16)
    assert (late.floor, late.total) == pytest.approx((0.5, np.sqrt(5.09)), rel=1e-12)


def test_spreads_of_gaps_do_not_count():
    white = np.full(ROWS, 4.0)
    white[::10] = np.inf
    noise = NoiseModel(white, np.ones(ROWS), 4.0, 0.0, 200.0, 0.0)
    assert noise.log_spread == pytest.approx(0.9 * ROWS * np.log(2.0), rel=1e-12)


def test_movement_is_forgotten_at_its_pace():
    signal = np.r_[np.zeros(10), np.ones(30)]
    moved = movement(signal, np.ones(40), memory=4.5)
    assert moved[10] == 1.0
    assert moved[9] == 0.5
    np.testing.assert_allclose(moved[11:20], np.exp(-np.arange(1, 10) / 4.5), rtol=1e-12)
    np.testing.assert_array_equal(moved[:9], 0.0)


@pytest.mark.parametrize("cautious", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_a_fit_is_no_worse_than_what_made_the_noise(seed, cautious):
    made = {"fast": (0.0, 0.6)[seed % 2], "slow": (0.0, 0.4, 0.8)[seed % 3], "fast_time": 6.0}
    residuals = _noise(seed, **made)
    noise = fit_noise(residuals, np.ones(ROWS), np.ones(ROWS), cautious=cautious)
    true = NoiseModel(
        np.ones(ROWS), np.ones(ROWS), 6.0, max(made["fast"] ** 2, 1e-9), 200.0, max(made["slow"] ** 2, 1e-9)
    )
    loss = [robust_cost(m.whiten(residuals)) + m.log_spread for m in (noise, true)]
    # the weak priors of its seven numbers may keep it from the very least
    assert loss[0] < loss[1] + 4.0


def test_what_no_noise_may_exceed_may_lie_far_below_the_quick_noise():
    noise = fit_noise(_noise(1), np.ones(ROWS), np.ones(ROWS), largest=1e-6)
    assert np.isfinite(noise.whiten(_noise(2))).all()
    assert noise.fast_size <= 1e-12 * 1.001


@pytest.mark.parametrize("largest", [0.3, 0.1])
def test_white_noise_may_be_larger_than_what_is_correlated(largest):
    # shut for half of the time: what grows with the signal is no white noise then
    signal = np.maximum(np.sin(np.arange(ROWS) / 100.0), 0.0)
    residuals = _noise(4)
    noise = fit_noise(residuals, signal, np.ones(ROWS), largest=largest)
    assert np.std(noise.whiten(residuals)) == pytest.approx(1.07, abs=0.05)


def test_what_is_louder_from_row_to_row_is_white_and_no_wander():
    parts = NoiseParts(
        base=1.0, share=0.5, peak=1.0, timing=0.1, fast_time=3.0, fast=1.0, slow_time=200.0, slow=1.0,
        size=1.0, inadequacy=0.0,
    )  # fmt: skip
    louder = parts.louder(10.0, 1.0)
    assert (louder.base, louder.share, louder.timing, louder.size) == (100.0, 50.0, 0.1, 10.0)
    # of a wander differences from row to row tell as much as it changes from row to row
    assert 1.0 < louder.slow < 2.0 < louder.fast < 40.0
    assert parts.louder(1.0, 1.0) == parts


@pytest.mark.parametrize("size", [0.1, 0.001])
def test_white_noise_below_the_inadequacy_gets_louder_as_far_as_differences_show(size):
    # the fit told next to none of it from what the simulation gets wrong
    parts = NoiseParts(1e-9, 0.0, 1.0, 0.0, 3.0, 1e-9, 200.0, 1e-9, size=size, inadequacy=0.1)
    rows = np.ones(ROWS, dtype=bool), np.ones(ROWS), np.ones(ROWS)
    as_loud, thrice = parts.model(*rows), parts.louder(3.0, 1.0).model(*rows)
    assert np.sqrt(as_loud.white[0]) == pytest.approx(0.1, rel=1e-3)
    assert np.sqrt(thrice.white[0]) == pytest.approx(np.hypot(0.1, np.sqrt(8.0) * size), rel=1e-3)


def test_noise_learnt_far_down_is_not_told_further_up():
    # of a valve that is shut nothing tells whether noise grows with the flow
    noise = 0.1 * np.random.default_rng(8).standard_normal(ROWS)
    shut = fit_noise(noise, np.full(ROWS, 1e-3), np.ones(ROWS))
    up = shut.parts.model(np.ones(ROWS, dtype=bool), np.ones(ROWS), np.ones(ROWS))
    assert np.std(up.whiten(noise)) == pytest.approx(np.std(shut.whiten(noise)), rel=1e-6)
    assert fit_noise(noise, np.zeros(ROWS), np.ones(ROWS)).parts.share < 1.0


@pytest.mark.parametrize("inadequacy", [0.0, 0.5])
def test_the_parts_of_a_noise_are_the_same_wherever_the_signal_is(inadequacy):
    # noise that grows with the signal, learnt high up and then found at a third of it
    signal = 3.0 + np.sin(np.arange(ROWS) / 100.0)
    noise = 0.1 * signal * np.random.default_rng(6).standard_normal(ROWS)
    step = np.ones(ROWS)
    high = fit_noise(noise, signal, step, inadequacy=inadequacy)
    low = high.parts.model(np.ones(ROWS, dtype=bool), signal / 3.0, step)
    # where the simulation may be wrong by more than the noise, that goes along
    assert np.std(low.whiten(noise / 3.0)) < (1.1 if inadequacy == 0.0 else 0.5)
    assert np.std(high.parts.model(np.ones(ROWS, dtype=bool), signal, step).whiten(noise)) == pytest.approx(
        np.std(high.whiten(noise)), rel=1e-12
    )


def test_the_instant_of_a_row_is_left_open():
    # strokes that came out perfectly say nothing of the next one
    signal = np.repeat([0.2, 0.8], ROWS // 2)
    residuals = 0.002 * _noise(11)
    step = np.ones(ROWS)
    perfect, open_to_it = (fit_noise(residuals, signal, step, timing=t) for t in (0.0, TIMING))
    row = ROWS // 2
    assert perfect.parts.timing < TIMING == open_to_it.parts.timing
    # a tenth of a stroke of 60 % within a row
    assert np.sqrt(open_to_it.white[row]) == pytest.approx(0.06, rel=0.02)
    assert open_to_it.white[row - 100] == pytest.approx(perfect.white[row - 100], rel=0.1)


# a logarithm of zero to begin with is that of three times a third of a second
@pytest.mark.parametrize("step", [1.0, 1.0 / 3.0])
@pytest.mark.parametrize("mixture", MIXTURES)
def test_the_compiled_simplex_makes_the_steps_of_scipys(mixture, step, monkeypatch):
    residuals, shown = _noise(3, **MIXTURES[mixture]), np.sin(np.arange(ROWS) / 90.0)
    asked = []

    def watched(problem, _simplex=noise_fit._by_simplex):
        asked.append((problem, _simplex(problem)))
        return asked[-1][1]

    monkeypatch.setattr(noise_fit, "_by_simplex", watched)
    fit_noise(residuals, shown, np.full(ROWS, step), cautious=step == 1.0, timing=TIMING)
    ((problem, found),) = asked
    expected = minimize(
        lambda z: noise_fit._cost(z, problem),
        problem[0],
        method="Nelder-Mead",
        options={"maxfev": 500, "xatol": 0.03, "fatol": 0.2, "adaptive": True},
    )
    np.testing.assert_array_equal(found, expected.x)


def test_of_very_many_rows_blocks_tell_the_same_noise(monkeypatch):
    rng = np.random.default_rng(8)
    rows = 40_000
    residuals = 0.7 * rng.standard_normal(rows)
    for size, time in ((0.8, 4.0), (1.0, 60.0)):
        keep = np.exp(-1.0 / time)
        residuals += lfilter([1.0], [1.0, -keep], size * np.sqrt(1.0 - keep**2) * rng.standard_normal(rows))
    simulated, step = np.full(rows, 10.0), np.ones(rows)
    whole = fit_noise(residuals, simulated, step)
    monkeypatch.setattr(noise_fit, "_MOST_ROWS", 10_240)
    monkeypatch.setattr(noise_fit, "_BLOCK", 1_024)
    residuals[5_000:20_000] = np.nan
    seen = np.flatnonzero(np.isfinite(residuals))
    kept = noise_fit._spread_rows(seen)
    assert (len(np.unique(kept)), kept[0], kept[-1]) == (10_240, 0, rows - 1)
    assert np.isfinite(residuals[kept]).all()
    asked, fitted = [], noise_fit._by_simplex
    monkeypatch.setattr(noise_fit, "_by_simplex", lambda problem: asked.append(problem) or fitted(problem))
    some = fit_noise(residuals, simulated, step)
    np.testing.assert_array_equal(asked[0][3], residuals[kept])
    # what is left out is a gap in time
    np.testing.assert_array_equal(np.cumsum(asked[0][4]), kept + 1.0)
    assert some.total == pytest.approx(whole.total, rel=0.1)
    assert np.std(some.whiten(residuals)[seen]) == pytest.approx(1.0, abs=0.1)
    # few rows with a value all serve, however long it is
    residuals[10_000:-100] = np.nan
    fit_noise(residuals, simulated, step)
    assert asked[-1][3] is residuals
