# SPDX-License-Identifier: BSD-3-Clause
import os
from pathlib import Path

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.signals.stick_slip import find_slips

TIME = np.arange(600)
COMMAND = 0.5 + 0.02 * np.sin(TIME / 8.0)


def stuck(command, band=0.04, jump=0.06):
    """Stem by hand: it rests until the error sums up to `band`, then jumps towards the command."""
    x, summed, out = command[0], 0.0, []
    for u in command:
        summed += 0.5 * (u - x)
        if abs(summed) > band:
            x += jump * np.sign(summed)
            summed = 0.0
        out.append(x)
    return np.array(out)


def noisy(x, size=0.0007, seed=0):
    return x + np.random.default_rng(seed).normal(0.0, size, len(x))


def test_a_hunting_stem_shows_slips_both_ways_of_the_right_size():
    slips = find_slips(COMMAND, noisy(stuck(COMMAND)))
    assert slips.evident
    np.testing.assert_allclose(np.abs(slips.sizes), 0.06, atol=0.004)
    assert (slips.past >= 0.25 * np.abs(slips.sizes)).all()


def test_rows_are_the_last_before_each_slip():
    opening = np.full(100, 0.5)
    opening[40:] = 0.56
    slips = find_slips(np.full(100, 0.52), opening)
    assert slips.rows.tolist() == [39]
    assert not slips.evident


@pytest.mark.parametrize(
    "opening",
    [
        COMMAND,
        np.r_[np.full(3, 0.5), COMMAND[:-3]],
        np.clip(COMMAND, 0.49, 0.51),
        np.full(600, 0.5),
    ],
    ids=["follows", "late", "play", "rests"],
)
def test_no_slips_where_nothing_jumps(opening):
    assert len(find_slips(COMMAND, noisy(opening)).rows) == 0


def test_steps_that_the_command_asked_for_are_no_slips():
    command = np.repeat(np.random.default_rng(1).uniform(0.2, 0.8, 20), 30)
    late = np.r_[np.full(8, command[0]), command[:-8]]
    assert len(find_slips(command, noisy(late)).rows) == 0


def test_spikes_of_the_sensor_are_no_slips():
    opening = noisy(COMMAND)
    opening[50::40] += 0.2
    opening[70::40] -= 0.2
    assert not find_slips(COMMAND, opening).evident


def test_slips_all_one_way_are_not_evident():
    opening = np.repeat(np.linspace(0.5, 0.9, 11), 60)
    slips = find_slips(np.full(len(opening), 0.45), opening)
    assert len(slips.rows) >= 6
    assert not slips.evident


def test_noise_as_large_as_the_slips_hides_them():
    assert not find_slips(COMMAND, noisy(stuck(COMMAND), size=0.02)).evident


def test_gaps_are_left_out():
    opening = noisy(stuck(COMMAND))
    opening[np.isin(TIME % 50, (1, 2, 3))] = np.nan
    command = np.where(TIME % 97 == 0, np.nan, COMMAND)
    every, some = find_slips(COMMAND, noisy(stuck(COMMAND))), find_slips(command, opening)
    assert set(some.rows) < set(every.rows)


def test_short_records_have_none():
    assert len(find_slips([0.5] * 4, [0.5, 0.5, 0.9, 0.9]).rows) == 0


def test_series_of_two_lengths_are_refused():
    with pytest.raises(ValueError, match="one length"):
        find_slips(COMMAND, COMMAND[:-1])


@pytest.mark.parametrize(
    ("effect", "evident"),
    [("stiction", True), (None, False), ("backlash", False), ("friction", False), ("dead_time", False)],
)
def test_the_plant(effect, evident):
    pytest.importorskip("pandas")
    made = make_valve_recording(effect, loop="closed", n_samples=3000, n_later=0, random_state=9102)
    assert find_slips(made.frame["CV"] / 100.0, made.frame["X"] / 100.0).evident is evident


def test_the_concealed_recordings():
    pandas = pytest.importorskip("pandas")
    folder = os.environ.get("SKLVALVE_DATA")
    if not folder or not (Path(folder) / "concealed").is_dir():
        pytest.skip("SKLVALVE_DATA names no folder with concealed recordings")
    evident = set()
    for path in sorted((Path(folder) / "concealed").glob("*/recording.csv.gz")):
        table = pandas.read_csv(path)
        if find_slips(table["CV"] / 100.0, table["X"] / 100.0).evident:
            evident.add(path.parent.name)
    assert evident == {"stiction"}
