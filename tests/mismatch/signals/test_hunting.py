# SPDX-License-Identifier: BSD-3-Clause
"""A stem that hunts while its command rests: which windows count, and what they name."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.mismatch.search.events import Events
from sklvalve.mismatch.signals.hunting import find_hunting
from tests.mismatch.conftest import record

ROWS = np.arange(1200)
REST = np.full(1200, 0.4)
HUNT = ["stiction", "positioner_feedback_fault", "friction", "rod_bend"]
SENSOR = 0.0007 * np.random.default_rng(3).standard_normal(1200)


def swings(size, period=8.0):
    return size * np.sin(2.0 * np.pi * ROWS / period)


def test_windows_and_sizes_of_a_stem_that_hunts():
    hunting = find_hunting(REST, REST + swings(0.02) + SENSOR)
    assert hunting.evident
    assert hunting.rows.tolist() == list(range(0, 1200, 20))
    np.testing.assert_allclose(hunting.sizes, 0.02 / np.sqrt(2.0), rtol=0.2)


@pytest.mark.parametrize(
    ("command", "opening"),
    [
        (REST, REST + SENSOR),
        (REST, REST + swings(0.004)),
        (REST, REST + 10.0 * SENSOR),
        (REST + swings(0.02), REST + swings(0.02)),
        (REST, REST - 0.05 * np.exp(-ROWS / 40.0)),
        (REST, np.where(ROWS < 180, REST + swings(0.02), REST)),
        (REST, np.full(1200, np.nan)),
        (REST[:10], REST[:10]),
    ],
    ids=["rests", "small", "noise", "commanded", "settles", "for once", "not recorded", "short"],
)
def test_what_is_no_hunting(command, opening):
    assert not find_hunting(command, opening).evident


def test_many_windows_of_a_long_recording_are_few():
    # ten of three hundred windows are no habit
    opening = np.tile(REST + SENSOR, 5)
    opening[:200] += np.tile(swings(0.02), 5)[:200]
    hunting = find_hunting(np.tile(REST, 5), opening)
    assert len(hunting.rows) == 10
    assert not hunting.evident


def test_a_quick_cycle_does_not_hide_behind_its_own_bends():
    # six rows a cycle in nine windows of ten: bends of the series, and most windows, show no sensor
    hunts = ROWS >= 120
    hunting = find_hunting(REST, REST + np.where(hunts, swings(0.02, period=6.0), 0.0) + SENSOR)
    assert hunting.rows.tolist() == list(range(120, 1200, 20))
    assert hunting.evident
    # white noise of the same size in as many rows is a sensor's
    noisy = 0.02 / np.sqrt(2.0) * np.random.default_rng(5).standard_normal(1200)
    assert not find_hunting(REST, REST + noisy + SENSOR).evident


@pytest.mark.parametrize("noise", [0.006, 0.009])
@pytest.mark.parametrize("value", [0.0, 1.0, 0.2], ids=["shut", "open", "held"])
def test_a_stem_at_a_stop_or_a_held_value_tells_nothing_of_the_sensor(noise, value):
    # two visits of 75 rows; elsewhere white noise, in windows of which one in twenty is quieter by chance
    opening = REST + noise * np.random.default_rng(8).standard_normal(1200)
    for begin in (200, 700):
        opening[begin : begin + 75] = value
    assert not find_hunting(REST, opening).evident


def test_readings_cut_off_at_the_end_of_the_range_tell_nothing_of_the_sensor():
    # a nearly closed valve in a sixth of the rows
    sensor = 0.008 * np.random.default_rng(8).standard_normal(1200)
    opening = np.clip(np.where(ROWS % 600 < 100, -0.012, 0.4) + sensor, 0.0, 1.0)
    assert not find_hunting(REST, opening).evident


def test_without_a_window_that_tells_the_noise_nothing_hunts():
    assert not find_hunting(REST, np.zeros(1200)).evident


def test_windows_with_a_gap_are_left_out():
    opening = REST + swings(0.02)
    opening[45] = np.nan
    assert 40 not in find_hunting(REST, opening).rows


@pytest.fixture(scope="module")
def found():
    sound = record(random_state=4)
    opening, rows = sound["opening"].copy(), np.arange(len(sound))
    opening += np.where(rows > len(rows) // 2, 0.02 * np.sin(2.0 * np.pi * rows / 3.1), 0.0)
    command = np.where(rows > len(rows) // 3, 0.5 + 0.001 * np.sin(rows / 90.0), sound["command"])
    opening = np.where(rows > len(rows) // 3, opening - sound["opening"] + command, opening)
    hunts = replace(sound, signals=sound.signals | {"command": command, "opening": opening})
    return MissingPhysicsFinder(effects=HUNT).fit(hunts)


@pytest.mark.slow
def test_a_hunting_stem_names_what_makes_stems_hunt(found):
    assert found.diagnosis_.verdict == "named"
    assert found.diagnosis_.effects[0] == tuple(HUNT)
    entry = found.diagnosis_.content["effects"][0]
    assert "hunts" in entry["sentence"]
    assert NAMED_FROM <= entry["probability"] < 1.0
    assert entry["grade"]["level"] in ("strong", "moderate")


@pytest.mark.slow
def test_rows_that_hunt_are_flagged(found):
    flagged = found.diagnosis_.traces["flagged"]
    half = len(flagged) // 2
    assert flagged[half + 40 :].mean() > 0.9


@pytest.mark.slow
def test_the_rarer_causes_of_hunting_alone_get_no_name():
    events = Events("hunting", np.full(12, 0.02), np.ones(len(REST), dtype=bool))
    assert events.may_name
    rarer = replace(events, names_wanted=frozenset({"friction", "rod_bend"}))
    assert rarer.names == {"friction", "rod_bend"}
    assert not rarer.may_name
