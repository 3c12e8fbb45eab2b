# SPDX-License-Identifier: BSD-3-Clause
"""What one record can tell: by the plant, its noise and the tolerances of a sheet, each checked alone."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from sklvalve.datasets import CONCEALABLE, make_valve_recording, write_concealed
from sklvalve.datasets import _plant_detectable as told
from sklvalve.datasets import _plant_noise as noises
from sklvalve.datasets import _plant_tolerance as tolerances
from sklvalve.datasets._plant_draw import WARM_UP, draw_noise
from sklvalve.datasets._plant_effects import EFFECTS
from sklvalve.datasets._plant_parameters import catalogue_parameters
from sklvalve.datasets._plant_rig import Plant
from sklvalve.datasets.concealed import UnreachableSize
from sklvalve.datasets.plant import draw_plant

pytest.importorskip("pandas")
ROWS = 1200
MAKE = Path(__file__).parents[2] / "benchmarks" / "trial" / "make.py"


def plant(loop="wide", names=(), rows=ROWS, seed=5):
    return Plant(np.random.default_rng(seed), list(names), loop, 1.0, rows)


def seen(name, size, onset=0.0, loop="wide", level=1.0, rows=ROWS):
    return told.seen_change(plant(loop), name, size, onset, 1, level, rows)


def test_whitening_leaves_what_the_plant_draws_white_and_of_unit_variance():
    n = 20_000
    noise, _ = draw_noise(np.random.default_rng(3), n, 40.0, 1.0)
    some = plant()
    some.kv = 40.0
    still = np.zeros(n)
    flow = noises.whitened_flow(noise["F"][:, None], 1.0, some, still, still, still + 500.0)[:, 0]
    opening = noises.whitened_opening(1e-2 * noise["X"][:, None], 1.0)[:, 0]
    for white in (flow, opening):
        assert np.var(white) == pytest.approx(1.0, abs=0.06)
        for lag in (1, 5, 30):
            assert abs(np.mean(white[lag:] * white[:-lag])) < 0.04


def test_a_flow_computed_from_recorded_signals_errs_by_the_noise_it_is_held_against():
    """The noise of the sensors goes through the healthy valve: whitened, unit variance is left."""
    rows = 4000
    made = make_valve_recording(loop="wide", n_samples=rows, n_later=0, random_state=1).frame
    some, _, _, _ = draw_plant([], 0.0, rows, 0, "wide", 1.0, 1)
    out, _ = some.run({}, 0.0, 0)
    opening, p1, p2, flow = (out[:, i] for i in (told.READING, told.P1, told.P2, told.FLOW))
    after = slice(WARM_UP, None)
    water = (some.rho[after], some.floor[after])
    noisy = [
        made["X"] / 100.0,
        *(1e3 * (made[n] - (made[n] - 1e-3 * p).mean()) for n, p in (("P1", p1), ("P2", p2))),
    ]
    at = lambda *s: tolerances.healthy_flow(some, *(np.asarray(v, dtype=float) for v in s), *water)  # noqa: E731
    pole = np.exp(-1.0 / some.healthy["meter_lag"])
    error = lfilter([1.0 - pole], [1.0, -pole], at(*noisy) - at(opening, p1, p2))
    by_opening, _ = tolerances.slopes(some, opening, p1, p2, *water)
    wrong = made["F"].to_numpy() - flow - error
    white = noises.whitened_flow(wrong[:, None], 1.0, some, flow, by_opening, 1e-3 * (p1 - p2))[50:, 0]
    assert np.var(white) == pytest.approx(1.0, abs=0.12)
    assert abs(np.mean(white[1:] * white[:-1])) < 0.1


@pytest.mark.parametrize("name", CONCEALABLE)
def test_no_size_no_change(name):
    assert seen(name, 0.0) == (0.0, 0.0)


def test_each_effect_acts_on_one_side_or_the_other():
    """What lies between recorded opening and recorded flow leaves the comparison of opening out."""
    for name, effect in EFFECTS.items():
        p = plant()
        size = 0.5 * (effect.low + effect.high) if not effect.limit else 0.9 * told.MOST[name]
        changed = np.flatnonzero(np.any(p.schedule({name: size}, 0.0, 1) != p.schedule({}, 0.0, 1), axis=0))
        sides = {told.COLUMNS[i] in told.FLOW_SIDE for i in changed}
        assert sides == ({effect.moves == "flow"} if name != "position_sensor_bias" else {False})


def test_a_meter_that_begins_to_read_off_is_seen_as_much_as_it_is():
    rated = plant().kv
    distance, share = seen("flow_meter_bias", 0.03, onset=400.0)
    again, _ = seen("flow_meter_bias", 0.06, onset=400.0)
    largest = plant().run({"flow_meter_bias": 0.03}, 400.0, 1)[0][:, told.FLOW].max()
    # calibration takes some of it: a zero of half a percent of span, and what trim and position may do
    assert 0.3 * 0.03 * 1.5 * rated / largest < share < 1.01 * 0.03 * 1.5 * rated / largest
    assert 3.5 < again / distance < 5.0


def test_what_a_sheet_leaves_open_is_nothing_from_the_start_and_something_later():
    for name, size in (("flow_meter_gain", 0.02), ("flow_meter_bias", 0.001)):
        assert seen(name, size)[0] < 1.0
        assert seen(name, 5.0 * size, onset=500.0)[0] > 25.0
    # on the seat a biased sensor shows at once, and is within its tolerance nonetheless
    early = told.detectable(plant(), "position_sensor_bias", 0.0, 1, 1.0, ROWS)
    assert early.size >= tolerances.POSITION_ZERO


def test_a_controller_hides_nothing():
    """The loop keeps its flow; what is compared is the flow at the opening with which it does so."""
    p = plant("closed")
    onset, size = 400.0, -0.3
    loop, _ = p.run({"capacity_error": size}, onset, 1)
    healthy, _ = p.run({}, onset, 1)
    behind = slice(600, None)
    kept = np.median(np.abs(loop[behind, told.FLOW] / healthy[behind, told.FLOW] - 1.0))
    assert kept < 0.05
    _, share = seen("capacity_error", size, onset, "closed")
    assert share > max(0.05, 3.0 * kept)


def test_more_noise_tells_less_and_more_rows_tell_more():
    quiet, loud = (seen("seat_leakage", 0.03, 300.0, level=level)[0] for level in (1.0, 3.0))
    assert 5.0 < quiet / loud < 12.0
    short = seen("flow_meter_bias", 0.03, 100.0, rows=600)[0]
    assert seen("flow_meter_bias", 0.03, 100.0)[0] > short


@pytest.mark.parametrize("name", ["backlash", "friction", "choked_flow", "flow_meter_drift", "dead_time"])
def test_detectable_is_the_smallest_size_that_does(name):
    p = plant()
    found = told.detectable(p, name, 0.0, 1, 1.0, ROWS)
    enough = [
        s[0] >= told.DISTANCE and s[1] >= told.SHARE
        for s in (told.seen_change(p, name, f * found.size, 0.0, 1, 1.0, ROWS) for f in (0.94, 1.0))
    ]
    assert enough[1]
    # below it too little, or a tolerance of the sheet
    assert not enough[0] or found.size == tolerances.within(p, name)
    assert found.distance >= told.DISTANCE
    assert found.share >= told.SHARE


def test_a_limit_of_travel_is_as_many_times_larger_as_its_change():
    p = plant()
    size, factor, found = told.beyond(p, "clogging", 0.0, 3, 1.0, ROWS, (2.0, 4.0))
    assert 2.0 <= factor <= 4.0
    share = told.seen_change(p, "clogging", size, 0.0, 3, 1.0, ROWS)[1]
    assert share == pytest.approx(factor * found.share, rel=0.3)
    assert share >= 2.0 * told.SHARE


def test_sizes_in_a_record_are_told_and_drawn_by_the_seed(tmp_path):
    given = {"times": (2.0, 4.0), "onset": None, "n_samples": 900, "n_later": 60, "random_state": 4}
    truth = write_concealed(tmp_path / "a", "seat_leakage", name="same", **given)
    assert write_concealed(tmp_path / "b", "seat_leakage", name="same", **given) == truth
    entry = truth["detectable"]["seat_leakage"]
    assert 2.0 <= entry["times"] <= 4.0
    assert truth["strengths"]["seat_leakage"] == pytest.approx(entry["times"] * entry["size"], rel=1e-2)
    assert entry["distance"] >= 25.0
    assert json.loads((tmp_path / "a" / "truth.json").read_text()) == truth
    with pytest.raises(UnreachableSize, match="seat_leakage of 900 times"):
        write_concealed(tmp_path / "c", "seat_leakage", **(given | {"times": (900.0, 1800.0)}))
    assert not (tmp_path / "c").exists()
    with pytest.raises(ValueError, match="not both"):
        write_concealed(tmp_path / "c", "seat_leakage", 0.1, **given)


def test_records_that_cannot_be_are_drawn_anew_and_counted(tmp_path, monkeypatch):
    make = runpy.run_path(str(MAKE))["main"]
    tries = []

    def only_every_third(folder, effects, *, times, random_state, **settings):
        tries.append(random_state)
        if len(tries) % 3:
            raise UnreachableSize("not here")
        folder.mkdir(parents=True)
        (folder / "truth.json").write_text("{}")

    monkeypatch.setitem(make.__globals__, "write_concealed", only_every_third)
    make([str(tmp_path), "--healthy", "0", "--each", "2", "--times", "2", "--effects", "backlash"])
    assert len(set(tries)) == 6
    drawn = json.loads((tmp_path / "drawn.json").read_text())
    assert drawn["drawn anew"] == {"backlash": 4}
    assert drawn["left out"] == {}


def test_concealed_sizes_as_parameters_of_the_catalogue():
    p = plant()
    own = p.healthy
    sizes = {"backlash": 0.03, "sedimentation": 0.2, "capacity_error": 0.3, "wrong_characteristic": 0.3}
    found = catalogue_parameters(p, sizes, 0.0)
    assert found["backlash"] == {"parameter": "width", "value": own["plug_play"] + 0.03, "unit": "1"}
    # the plant reaches the size on its last row
    table = p.schedule({"sedimentation": 0.2}, 0.0, 1)[:, 0]
    slope = -3600.0 * (table[-1] - table[-601]) / 600.0
    assert found["sedimentation"]["value"] == pytest.approx(slope, rel=1e-6)
    assert set(found) == {"backlash", "sedimentation"}
    later = catalogue_parameters(p, sizes, 200.0)
    assert later["capacity_error"]["value"] == 0.3
    slope = -3600.0 * np.diff(p.schedule({"sedimentation": 0.2}, 200.0, 1)[:, 0])[-1]
    assert later["sedimentation"]["value"] == pytest.approx(slope, rel=1e-6)
