# SPDX-License-Identifier: BSD-3-Clause
"""The plant's own distances: what is detectable, and what cannot be told apart."""

import numpy as np
import pytest

from benchmarks.concealed.distances import between, detectable
from benchmarks.concealed.distances.between import APART
from benchmarks.concealed.distances.calibration import nuisance_of
from benchmarks.concealed.distances.detectable import DISTANCE, SHARE, of_times, scene_of, standing_out
from benchmarks.concealed.plant import Course, Plant
from benchmarks.concealed.plant.march import A_SECOND


@pytest.fixture(scope="module")
def plant():
    return Plant(11, "wide", 1200, 60)


@pytest.mark.slow
def test_a_sound_plant_stands_out_by_nothing(plant):
    assert standing_out(scene_of(plant, {}, Course())) == (0.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["seat_leakage", "meter_lag"])
def test_the_detectable_size_is_just_told(plant, name):
    found = detectable(plant, name, Course())
    assert found.distance >= DISTANCE
    assert found.share >= SHARE
    smaller = standing_out(scene_of(plant, {name: 0.85 * found.size}, Course()))
    assert smaller[0] < DISTANCE or smaller[1] < SHARE


@pytest.mark.slow
def test_what_a_sheet_leaves_open_is_no_effect(plant):
    # a capacity 8 % off from the start is calibration, but for what the plant has used of it
    used = plant.trim[-1] / plant.sheet["kv_rated"] - 1.0
    within = standing_out(scene_of(plant, {"capacity_error": 0.08 - used}, Course()))[0]
    assert within < 5.0
    assert standing_out(scene_of(plant, {"capacity_error": 0.3}, Course()))[0] > 100.0


def test_how_recovery_falls_with_travel_is_no_effect():
    # a plant that chokes, and where a fall of F_L that nobody wrote down would stand out
    choking = Plant(21, "wide", 1200, 60)
    scene = scene_of(choking, {}, Course())
    nuisance = nuisance_of(scene, "flow")
    falling = choking.fl * (1.0 + 0.08 * (0.5 - np.linspace(0.0, 1.0, choking.fl.size)))
    change = (scene.flow(scene.sound, fl=falling)[::A_SECOND] - scene.seen("flow", scene.sound))[
        scene.recorded
    ]
    white = nuisance.law(change[:, None])[:, 0]
    assert white @ white > DISTANCE
    assert nuisance.distance(white) < 1.0
    assert 0.0 < nuisance.multiples(white)[-1] <= 1.0


def test_a_change_within_the_record_is_no_calibration(plant):
    course = Course("within", 600.0)
    assert standing_out(scene_of(plant, {"capacity_error": 0.05}, course))[0] > 100.0


@pytest.mark.slow
def test_times_of_the_detectable_size(plant):
    size, found = of_times(plant, "seat_leakage", Course(), 2.0)
    assert size == pytest.approx(2.0 * found.size)
    size, _ = of_times(plant, "seat_leakage", Course(), 1e4)
    assert size is None


@pytest.mark.slow
def test_a_leak_and_a_bypass_are_one_and_play_is_another(plant):
    size, _ = of_times(plant, "seat_leakage", Course(), 2.0)
    scene = scene_of(plant, {"seat_leakage": size}, Course())
    found = between(scene, Course(), ["seat_leakage"])
    assert "seat_leakage" not in found
    assert found["nothing"] > 50.0
    assert found["bypass_open"] < APART
    assert found["backlash"] > 50.0
    assert all(0.0 <= d <= found["nothing"] + 0.1 for d in found.values())


def test_without_an_opening_there_is_one_channel(plant):
    scene = scene_of(plant, {"link_backlash": 0.05}, Course(), ("opening",))
    assert scene.channels() == ("flow",)
    assert standing_out(scene)[0] > DISTANCE


def test_calibration_takes_no_more_than_its_bounds(plant):
    nuisance = nuisance_of(scene_of(plant, {}, Course()), "flow")
    rng = np.random.default_rng(0)
    white = 100.0 * rng.standard_normal(plant.rows)
    taken = nuisance.multiples(white)
    assert (taken >= nuisance.low - 1e-9).all()
    assert (taken <= nuisance.high + 1e-9).all()
    assert nuisance.distance(white) <= white @ white


def test_without_an_outlet_pressure_what_lies_behind_is_open(plant):
    # a capacity beyond the sheet's tolerance is told with both pressures, and is the tank's without
    strengths = {"capacity_error": 0.18}
    seen = standing_out(scene_of(plant, strengths, Course()))[0]
    unseen = standing_out(scene_of(plant, strengths, Course(), ("p2",)))[0]
    assert seen > 10.0 * APART
    assert unseen < APART
    within = standing_out(scene_of(plant, strengths, Course("within", 600.0), ("p2",)))[0]
    assert within > 10.0 * APART
