# SPDX-License-Identifier: BSD-3-Clause
"""Several recordings of one valve: one physics, and to each its own noise."""

import json

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import MissingPhysicsFinder, load_model, save_model
from sklvalve.mismatch.data.gathering import settled
from sklvalve.recording import InputError, Recording, Valve, join_recordings
from sklvalve.report import summary_sentence
from sklvalve.report.html import render
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces, noise_of

EFFECTS = ["clogging", "seat_leakage", "piping_reducers", "flow_meter_gain"]


@pytest.fixture(scope="module")
def two():
    """Two recordings of one valve, cut from one: a blockage comes with the second, timed anew."""
    made = make_valve_recording(
        "clogging", 0.5, onset=1300.0, loop="wide", n_samples=2600, n_later=0, random_state=3
    )
    columns = {name: made.frame[name].to_numpy() for name in made.frame}
    cut = [
        {name: values[rows] for name, values in columns.items()} for rows in (slice(1300), slice(1300, None))
    ]
    cut[1]["time"] = cut[1]["time"] - cut[1]["time"][0]
    return [Recording.from_frame(each, Valve.from_dict(made.valve)) for each in cut]


def test_a_simulation_settles_unseen_after_each_beginning(two):
    joined = settled(join_recordings(two))
    for role in ("opening", "flow"):
        np.testing.assert_array_equal(np.flatnonzero(np.isnan(joined[role])), np.arange(1300, 1340))
    assert np.isfinite(joined["command"]).all()
    assert settled(two[0]) is two[0]


def test_each_recording_has_its_own_noise(two):
    rng = np.random.default_rng(0)
    joined = join_recordings(two)
    sizes = np.repeat([1e-4, 4e-4], 1300)
    residuals = sizes * rng.normal(size=2600)
    step = np.ones(2600)
    noise = noise_of(joined, residuals, joined["flow"], step, "flow")
    assert isinstance(noise, NoiseOfPieces)
    assert [m.floor for m in noise.models] == pytest.approx([1e-4, 4e-4], rel=0.15)
    assert noise.floor == pytest.approx(np.sqrt(np.mean(sizes**2)), rel=0.1)
    white = noise.whiten(residuals)
    assert [white[:1300].std(), white[1300:].std()] == pytest.approx([1.0, 1.0], rel=0.1)
    assert noise.log_spread == pytest.approx(sum(m.log_spread for m in noise.models))


def test_the_time_between_two_recordings_is_no_time_to_wander_in(two):
    rng = np.random.default_rng(0)
    joined = join_recordings(two)
    residuals = 1e-4 * rng.normal(size=2600) + np.tile(np.linspace(-1e-3, 1e-3, 1300), 2)
    found = []
    for gap in (1.0, 3600.0, 6e5):
        step = np.ones(2600)
        step[1300] = gap
        found.append(noise_of(joined, residuals, joined["flow"], step, "flow").models[1].slow_time)
    assert found == pytest.approx([found[0]] * 3)


def test_a_recording_without_a_value_of_a_channel_says_nothing_of_its_noise(two):
    residuals = np.full(2600, np.nan)
    residuals[:1300] = 1e-4 * np.random.default_rng(0).normal(size=1300)
    joined = join_recordings(two)
    noise = noise_of(joined, residuals, joined["flow"], np.ones(2600), "flow")
    assert noise.floor == pytest.approx(1e-4, rel=0.15)
    assert np.all(noise.whiten(residuals)[1300:] == 0.0)


@pytest.mark.slow
def test_what_came_between_two_recordings_is_dated_by_the_second(two):
    finder = MissingPhysicsFinder(effects=EFFECTS).fit(two)
    content = finder.diagnosis_.content
    assert content["verdict"] == "named"
    assert finder.diagnosis_.effects[0][0] == "clogging"
    begins = two[0].time[-1] + 3600.0
    # a blockage shows when the stem opens that far for the first time
    assert begins <= content["location"]["onset"] < begins + 400.0
    assert [each["rows"] for each in content["provenance"]["recordings"]] == [1300, 1300]
    sentence = summary_sentence(content)
    assert "of data frame" in sentence
    assert json.dumps(content)
    assert "of data frame" in render(finder.diagnosis_)


def test_a_loop_without_a_simulation_is_diagnosed_alone():
    time = np.arange(400.0)
    loops = [
        Recording.from_frame({"time": time, "command": 0.5 + 0.1 * np.sin(time), "process_value": value})
        for value in (1.0 + np.cos(time), 1.0 - np.cos(time))
    ]
    with pytest.raises(InputError, match="one recording at a time"):
        MissingPhysicsFinder().fit(loops)


def test_no_target_beside_several(two):
    with pytest.raises(InputError, match="give no y"):
        MissingPhysicsFinder().fit(two, np.zeros(2600))


@pytest.mark.slow
def test_a_model_found_on_clocks_that_begin_anew_holds_what_has_begun(two, tmp_path):
    pytest.importorskip("skops", reason='needs pip install "sklvalve[skops]"')
    finder = MissingPhysicsFinder(effects=["clogging"]).fit(two)
    save_model(tmp_path / "model.skops", finder)
    corrected = load_model(tmp_path / "model.skops")["corrected"]
    recorded = two[1]["flow"]
    errors = [
        np.sqrt(np.nanmean((recorded - s.predict(two[1])) ** 2))
        for s in (corrected, finder.nominal_simulation_)
    ]
    assert errors[0] < 0.5 * errors[1]
