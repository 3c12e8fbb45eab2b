# SPDX-License-Identifier: BSD-3-Clause
"""Bands of the mean residual over the operating range, and the boxes that leave them."""

import numpy as np
import pytest
from scipy.signal import lfilter

from sklvalve.mismatch.describe.bands import simultaneous_bands
from sklvalve.mismatch.describe.boxes import boxes_of, covered, rows_in
from sklvalve.mismatch.describe.cells import cells_of_signals, direction_of_travel, rate_of_travel
from sklvalve.mismatch.describe.locate import boxes_in
from sklvalve.simulation.noise import NoiseModel

ROWS = 3000
SIZE = 0.01


def wandering(rng, size, seconds):
    keep = np.exp(-1.0 / seconds)
    return size * lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(ROWS))


def scene(seed):
    """Signals, correlated noise and the model of it."""
    rng = np.random.default_rng(seed)
    opening = np.clip(0.5 + wandering(rng, 0.25, 100.0), 0.0, 1.0)
    signals = {"opening": opening, "pressure_ratio": 0.4 + wandering(rng, 0.1, 150.0)}
    signals["rate"] = rate_of_travel(opening, np.arange(float(ROWS)))
    left = SIZE * (rng.standard_normal(ROWS) + wandering(rng, 0.7, 10.0) + wandering(rng, 0.6, 333.0))
    parts = (10.0, 0.49 * SIZE**2, 333.0, 0.36 * SIZE**2)
    return signals, left, NoiseModel(np.full(ROWS, SIZE**2), np.ones(ROWS), *parts)


def bands_of(signals, rest, before, noise, alpha=0.01):
    cells = cells_of_signals(signals, "flow")
    ((bands,),) = simultaneous_bands([(noise, rest, [before], cells)], alpha=alpha)
    return bands


def boxes_of_change(seed, change):
    signals, left, noise = scene(seed)
    return boxes_in(bands_of(signals, left, left + change(signals), noise), ROWS), signals


def test_correlated_noise_seldom_leaves_the_bands():
    out = 0
    for seed in range(40):
        signals, left, noise = scene(seed)
        out += any(b.beyond.any() for b in bands_of(signals, left, left, noise, alpha=0.05))
    # two are expected; more than six in one of 200 such trials
    assert out <= 6


def test_bands_taken_for_white_noise_would_be_left():
    # the same residuals: that the bands hold is the noise model's doing, and not their width
    out = 0
    for seed in range(20):
        signals, left, _ = scene(seed)
        white = NoiseModel(np.full(ROWS, left.var()), np.ones(ROWS), 10.0, 1e-12, 333.0, 1e-12)
        fits = bands_of(signals, left, left, white, alpha=0.05)
        plain = [np.abs(b.mean) > 3.5 * left.std() / np.sqrt(np.bincount(b.cells.cell)) for b in fits[:1]]
        out += any(p.any() for p in plain)
    assert out > 10


def test_means_are_found_within_their_bands():
    signals, left, noise = scene(3)
    high = signals["opening"] > 0.6
    (band,) = (
        b for b in bands_of(signals, left, left + 5.0 * SIZE * high, noise) if b.cells.signals == ("opening",)
    )
    edges = band.cells.edges[0]
    above, below = edges[:-1] >= 0.6, edges[1:] <= 0.6
    np.testing.assert_array_less(np.abs(band.mean[above] - 5.0 * SIZE), band.half[above])
    np.testing.assert_array_less(np.abs(band.mean[below]), band.half[below])
    assert np.all(band.beyond[above] > 0.0)


@pytest.mark.parametrize("signal", ["opening", "pressure_ratio"])
def test_box_is_the_range_in_which_something_acts(signal):
    (box,), signals = boxes_of_change(5, lambda s: 6.0 * SIZE * (s[signal] > np.quantile(s[signal], 0.7)))
    assert box.cells.signals == (signal,)
    region = box.region()
    assert region["signal"] == signal
    assert region["direction"] is None
    assert region["share"] == pytest.approx(0.3, abs=0.08)
    assert region["low"] == pytest.approx(np.quantile(signals[signal], 0.7), abs=0.05)
    assert region["high"] == pytest.approx(signals[signal].max(), abs=1e-9)


def test_box_of_two_signals():
    def change(s):
        return 8.0 * SIZE * ((s["opening"] > 0.5) & (s["pressure_ratio"] > 0.4))

    boxes, signals = boxes_of_change(6, change)
    assert boxes[0].cells.signals == ("opening", "pressure_ratio")
    true = change(signals) > 0.0
    told = rows_in(boxes, ROWS)
    assert np.sum(told & true) > 0.6 * np.sum(told | true)
    assert boxes[0].region()["and"]["signal"] == "pressure_ratio"


def test_box_of_one_direction():
    def change(s):
        return 6.0 * SIZE * ((direction_of_travel(s["opening"]) > 0.0) & (s["opening"] > 0.45))

    boxes, _ = boxes_of_change(7, change)
    region = boxes[0].region()
    assert (region["signal"], region["direction"]) == ("opening", "opening")
    assert region["low"] == pytest.approx(0.45, abs=0.08)


def test_what_acts_everywhere_fills_every_box():
    boxes, _ = boxes_of_change(8, lambda s: np.full(ROWS, 8.0 * SIZE))
    assert covered(boxes) > 0.95


def test_noise_alone_has_no_box():
    boxes, _ = boxes_of_change(9, lambda s: np.zeros(ROWS))
    assert boxes == []


def test_gaps_belong_to_no_cell():
    signals, left, noise = scene(10)
    signals["opening"][:500] = np.nan
    left[800:900] = np.nan
    white = noise.white.copy()
    white[800:900] = np.inf
    noise = NoiseModel(white, noise.step, noise.fast_time, noise.fast_size, noise.slow_time, noise.slow_size)
    for band in bands_of(signals, left, left + 5.0 * SIZE * (signals["pressure_ratio"] > 0.45), noise):
        assert np.isfinite(band.mean).all()
        assert np.isfinite(band.half).all()
        for box in boxes_of(band):
            if "opening" in box.cells.signals:
                assert not box.rows[:500].any()


def test_direction_changes_only_where_the_stem_turns():
    opening = np.concatenate([np.linspace(0.2, 0.6, 200), np.linspace(0.6, 0.3, 150), np.full(50, 0.3)])
    opening += 1e-3 * np.random.default_rng(0).standard_normal(len(opening))
    way = direction_of_travel(opening)
    assert np.all(way[10:200] > 0.0)
    assert np.all(way[210:] < 0.0)


def test_boxes_are_those_that_describe_where_an_effect_acts():
    signals, left, noise = scene(5)
    high = signals["opening"] > 0.6
    bands = bands_of(signals, left, left + 5.0 * SIZE * high, noise)
    always = np.ones(ROWS, dtype=bool)
    boxes = boxes_in(bands, ROWS, (high, always))
    inside = rows_in(boxes, ROWS)
    assert {box.cells.signals[0] for box in boxes} == {"opening"}
    assert np.sum(inside & high) > 0.8 * np.sum(inside | high)


def test_no_box_is_named_where_none_describes_better_than_all_rows():
    signals, left, noise = scene(5)
    high = signals["opening"] > 0.6
    bands = bands_of(signals, left, left + 5.0 * SIZE * high, noise)
    assert boxes_in(bands, ROWS)
    # it acts after every stroke, say, and not where the mean residual stands out
    always = np.ones(ROWS, dtype=bool)
    assert boxes_in(bands, ROWS, (~high, always)) == []
    assert boxes_in(bands, ROWS, (always, always)) == []
    # nor where it makes a difference all the while that it acts
    assert boxes_in(bands, ROWS, (high, high)) == []
