# SPDX-License-Identifier: BSD-3-Clause
"""Each effect changes what it should and leaves the rest alone."""

import subprocess
import sys

import numpy as np
import pytest

from sklvalve.datasets import CONCEALABLE, make_valve_recording
from sklvalve.datasets._plant_effects import EFFECTS

pytest.importorskip("pandas")
WIDE = {"loop": "wide", "noise": 0.0, "random_state": 21}
FLOW_SIDE = [name for name in CONCEALABLE if EFFECTS[name].moves == "flow"]
OPENING_SIDE = [name for name in CONCEALABLE if EFFECTS[name].moves == "opening"]
NO_CATALOGUE = [name for name in CONCEALABLE if EFFECTS[name].told is None]


@pytest.fixture(scope="module")
def healthy():
    return make_valve_recording(**WIDE, concealed=False)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("name", FLOW_SIDE)
def test_flow_side_effects_leave_the_stem_alone(name, healthy):
    made = make_valve_recording(name, **WIDE)
    # on the seat a biased sensor reads its bias
    off_the_stops = healthy.frame["CV"].between(8.0, 92.0)
    assert rms((made.frame["X"] - healthy.frame["X"])[off_the_stops]) < 0.3
    assert rms(made.frame["F"] - healthy.frame["F"]) > 0.004 * healthy.frame["F"].max()
    assert made.truth["rms_where_acting"]["flow"] > 0.5
    assert made.truth["blocks"] == ([] if name in NO_CATALOGUE else [EFFECTS[name].block])
    assert made.truth["verdict"] == ("none_of_these" if name in NO_CATALOGUE else "named")


@pytest.mark.parametrize("name", OPENING_SIDE)
def test_actuator_effects_move_the_stem_and_keep_the_trim(name, healthy):
    made = make_valve_recording(name, **WIDE, concealed=False)
    assert rms(made.frame["X"] - healthy.frame["X"]) > 0.5
    assert made.truth["rms_where_acting"]["opening"] > 0.5
    assert made.truth["blocks"] == ["actuator"]
    # flow over the root of the drop is the same function of the plug's position, at rest and away from
    # choking
    curves = []
    for frame, slow in ((healthy.frame, 1.0), (made.frame, 0.2)):
        drop = frame["P1"] - frame["P2"]
        rest = (frame["true_opening"].diff().abs().rolling(12).max() < slow) & (drop < 500.0)
        rest &= frame["true_opening"] > 5.0
        kv = (frame["F"] / np.sqrt(drop / 100.0))[rest]
        order = np.argsort(frame["true_opening"][rest].to_numpy())
        curves.append((frame["true_opening"][rest].to_numpy()[order], kv.to_numpy()[order]))
    (x_healthy, kv_healthy), (x, kv) = curves
    inside = (x > x_healthy[0]) & (x < x_healthy[-1])
    assert inside.sum() > 100
    difference = kv[inside] - np.interp(x[inside], x_healthy, kv_healthy)
    assert np.median(np.abs(difference)) < 0.01 * kv_healthy.max()


@pytest.mark.parametrize("name", ["position_sensor_bias", "flow_meter_gain", "supply_pressure_drop"])
def test_nothing_happens_before_the_onset(name, healthy):
    made = make_valve_recording(name, onset=2500.0, **WIDE)
    assert made.frame.iloc[:2500].equals(
        healthy.frame.drop(columns=["true_opening", "flow_without_noise"]).iloc[:2500]
    )
    assert rms((made.frame["F"] - healthy.frame["F"]).iloc[2500:]) > 0.003 * healthy.frame["F"].max()
    assert made.truth["onset"] == 2500.0


def test_position_sensor_bias_moves_the_plug_against_the_reading(healthy):
    made = make_valve_recording("position_sensor_bias", 0.05, **WIDE, concealed=False)
    inside = healthy.frame["true_opening"].between(10.0, 90.0) & (healthy.frame["CV"].diff().abs() < 0.5)
    moved = (made.frame["true_opening"] - healthy.frame["true_opening"])[inside]
    assert np.median(moved) == pytest.approx(-5.0, abs=0.15)
    assert abs(np.median((made.frame["X"] - healthy.frame["X"])[inside])) < 0.1


def test_backlash_leaves_the_plug_half_the_play_behind(healthy):
    made = make_valve_recording("backlash", 0.06, **WIDE, concealed=False)
    lag = made.frame["X"] - made.frame["true_opening"] - (healthy.frame["X"] - healthy.frame["true_opening"])
    still = made.frame["CV"].diff().abs().rolling(8).max() < 0.5
    assert lag[still].abs().max() < 3.3
    assert lag[still].quantile(0.95) == pytest.approx(3.0, abs=0.2)
    assert lag[still].quantile(0.05) == pytest.approx(-3.0, abs=0.2)


def test_dead_band_leaves_the_stem_behind_but_never_further(healthy):
    made = make_valve_recording("positioner_deadband", 0.03, **WIDE)
    error = (made.frame["X"] - made.frame["CV"])[made.frame["CV"].diff().abs().rolling(8).max() < 0.05]
    assert 2.5 < error.abs().quantile(0.95) < 3.8


def test_supply_drop_and_clogging_cap_what_they_should(healthy):
    # 340 kPa less 80 % are 68 kPa; the spring needs 20 + 80 x kPa
    starved = make_valve_recording("supply_pressure_drop", 0.8, **WIDE)
    assert starved.frame["X"].max() == pytest.approx(60.0, abs=3.0)
    clogged = make_valve_recording("clogging", 0.4, **WIDE, concealed=False)
    wide_open = clogged.frame["true_opening"] > 62.0
    conductance = (clogged.frame["F"] / np.sqrt(clogged.frame["P1"] - clogged.frame["P2"]))[
        wide_open & (clogged.frame["CV"].diff().abs().rolling(12).max() < 0.7)
    ]
    assert conductance.std() < 0.04 * conductance.mean()
    assert clogged.frame["X"].max() > 90.0


def test_leak_flows_through_a_shut_valve(healthy):
    shut = (healthy.frame["CV"].rolling(20).max() == 0.0) & (healthy.frame["F"] < 0.3)
    # at larger drops the jet nears choking
    shut &= healthy.frame["P1"] - healthy.frame["P2"] < 420.0
    assert shut.sum() > 20
    for name in ("seat_leakage", "bypass_open"):
        made = make_valve_recording(name, 0.05, **WIDE)
        kv = 0.05 * made.valve["valve"]["kv_rated"]
        drop = (made.frame["P1"] - made.frame["P2"])[shut] / 100.0
        extra = (made.frame["F"] - healthy.frame["F"])[shut]
        np.testing.assert_allclose(extra, kv * np.sqrt(drop), rtol=0.03)


def test_choking_makes_flow_insensitive_to_outlet_pressure():
    made = make_valve_recording("choked_flow", 0.2, **WIDE)
    healthy = make_valve_recording(**WIDE)
    ratio = made.frame["F"] / healthy.frame["F"]
    drop = healthy.frame["P1"] - healthy.frame["P2"]
    open_wide = healthy.frame["X"] > 15.0
    assert ratio[open_wide & (drop < 280.0)].mean() > 0.97
    assert ratio[open_wide & (drop > 500.0)].mean() < 0.93


def test_choking_left_out_of_the_sheet_is_told_where_it_occurs():
    truth = make_valve_recording("choked_flow", 0.3, sheet_physics=(), **WIDE).truth
    assert truth["effects"] == ["choked_flow"]
    assert truth["physics"] == []
    alone = make_valve_recording("stiction", 500.0, sheet_physics=(), loop="wide", random_state=2).truth
    assert alone["effects"][0] == "stiction"
    assert set(alone["effects"]) <= {"stiction", "choked_flow"}


def test_two_effects_act_together(healthy):
    made = make_valve_recording(["stiction", "flow_meter_bias"], [600.0, 0.05], **WIDE)
    assert made.truth["effects"] == ["stiction", "flow_meter_bias"]
    assert made.truth["blocks"] == ["actuator", "measurement"]
    assert made.truth["strengths"] == {"stiction": 600.0, "flow_meter_bias": 0.05}
    shift = np.median(made.frame["F"] - healthy.frame["F"])
    assert shift == pytest.approx(0.05 * 1.5 * made.valve["valve"]["kv_rated"], rel=0.15)


@pytest.mark.parametrize("name", ["backlash", "seat_leakage", "trim_rotation", "positioner_deadband"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_drawn_sizes_matter_but_do_not_shout(name, seed):
    truth = make_valve_recording(name, random_state=seed, loop="wide").truth
    assert 1.0 < truth["rms_where_acting"][EFFECTS[name].moves] < 7.0


def test_plant_imports_nothing_of_what_diagnoses_it():
    code = (
        "import sys; import sklvalve.datasets.plant; "
        "names = [n for n in sys.modules if n.startswith('sklvalve.')]; "
        "print([n for n in names if not n.startswith('sklvalve.datasets')])"
    )
    seen = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert seen.strip() == "[]"
