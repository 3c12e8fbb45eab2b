# SPDX-License-Identifier: BSD-3-Clause
import copy
import json
import pickle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.mechanism import fluid_from
from sklvalve.recording import InputError, Valve, read_valve
from sklvalve.recording._layout import FLUIDS
from sklvalve.recording.signal import Signal

FULL = {
    "valve": {
        "tag": "FV-101",
        "kv_rated": 40.0,
        "characteristic": "equal_percentage",
        "rangeability": 40.0,
        "shutoff": 0.02,
        "fl": 0.9,
        "fd": 0.46,
        "xt": 0.7,
        "nominal_size": 50.0,
        "inlet_pipe": 80.0,
        "outlet_pipe": 80.0,
        "travel": 38.1,
    },
    "fluid": {"name": "water", "density": 998.0, "kinematic_viscosity": 1e-6, "vapour_pressure": 2.3},
    "actuator": {
        "fail": "closed",
        "supply_pressure": 340.0,
        "spring_range": [20.0, 100.0],
        "effective_area": 290.0,
        "positioner": True,
    },
    "simulation": {"physics": ["choked_flow"]},
    "recording": {
        "time": "t",
        "command": {"column": "CV", "unit": "%", "sense": "closing"},
        "opening": {"column": "X", "unit": "mm", "sense": "opening"},
        "p1": {"column": "P1", "unit": "kPa", "gauge": False},
        "p2": {"constant": 0.0, "unit": "bar", "gauge": True},
        "flow": {"column": "F", "unit": "t/h"},
        "setpoint": {"column": "SP", "unit": "degC"},
    },
}


def changed(section, **keys):
    """The full description with some keys of one section set, or taken out where None."""
    data = copy.deepcopy(FULL)
    target = data
    for part in section.split("."):
        target = target[part]
    for key, value in keys.items():
        if value is None:
            del target[key]
        else:
            target[key] = value
    return data


def test_everything_is_in_si():
    valve = Valve.from_dict(FULL)
    assert (valve.tag, valve.kv_rated, valve.characteristic, valve.fl) == (
        "FV-101",
        40.0,
        "equal_percentage",
        0.9,
    )
    assert valve.nominal_size == pytest.approx(0.05, rel=1e-12)
    assert valve.travel == pytest.approx(0.0381, rel=1e-12)
    assert valve.fluid == pytest.approx(
        {"name": "water", "density": 998.0, "kinematic_viscosity": 1e-6, "vapour_pressure": 2300.0}
    )
    assert (valve.fail, valve.positioner, valve.physics) == ("closed", True, ("choked_flow",))
    assert valve.supply_pressure == pytest.approx(340e3)
    assert valve.spring_range == pytest.approx((20e3, 100e3))
    assert valve.effective_area == pytest.approx(0.029)
    assert valve.time == "t"
    assert valve.roles["p2"] == Signal(None, 0.0, "bar", gauge=True)
    assert valve.roles["opening"].to_si([19.05]) == pytest.approx([0.5])
    assert valve.roles["flow"].mass_flow


def test_absent_is_none():
    valve = Valve.from_dict({})
    assert all(
        getattr(valve, name) is None
        for name in (
            "kv_rated",
            "characteristic",
            "rangeability",
            "shutoff",
            "fl",
            "travel",
            "fail",
            "positioner",
        )
    )
    assert (valve.fluid, valve.physics, valve.roles, valve.time) == ({}, (), {}, "time")


def test_cv_becomes_kv():
    assert Valve.from_dict({"valve": {"cv_rated": 100.0}}).kv_rated == pytest.approx(86.49777, rel=1e-9)


def test_tables():
    trim = [[0.0, 0.0], [0.5, 0.12], [1.0, 1.0]]
    valve = Valve.from_dict({"valve": {"characteristic": trim, "fl": [[0.1, 0.95], [1, 0.8]]}})
    assert valve.characteristic == ((0.0, 0.0), (0.5, 0.12), (1.0, 1.0))
    assert valve.fl == ((0.1, 0.95), (1.0, 0.8))
    assert Valve.from_dict(valve.to_dict()) == valve


@pytest.mark.parametrize(
    "fluid",
    [
        {"name": "oil", "density": 870.0},
        {"name": "air", "molar_mass": 29.0, "heat_capacity_ratio": 1.4},
        {"name": "water"},
        {"vapour_pressure": 2.3},
        {},
    ],
)
def test_fluids_that_can_be_described(fluid):
    valve = Valve.from_dict({"fluid": fluid})
    assert set(valve.fluid) == set(fluid)


@pytest.mark.parametrize("name", FLUIDS)
def test_fluids_known_by_name_are_known_to_the_mechanism(name):
    assert fluid_from(name).knows("density")


def test_other_trims_do_without_rangeability():
    for name in ("linear", "quick_opening", "parabolic", "unknown"):
        assert Valve.from_dict({"valve": {"characteristic": name}}).rangeability is None


def test_dict_round_trip_is_exact_and_json_able():
    valve = Valve.from_dict(FULL)
    plain = json.loads(json.dumps(valve.to_dict()))
    assert plain["valve"] == FULL["valve"]
    assert plain["fluid"] == FULL["fluid"]
    assert plain["actuator"] == FULL["actuator"]
    again = Valve.from_dict(plain)
    assert again == valve
    assert again.to_dict() == plain
    assert pickle.loads(pickle.dumps(valve)) == valve


@given(size=st.floats(0.1, 5000.0), kv=st.floats(1e-3, 1e5), area=st.floats(1.0, 1e4))
@settings(deadline=None, max_examples=50)
def test_numbers_survive_the_round_trip(size, kv, area):
    data = {"valve": {"kv_rated": kv, "nominal_size": size}, "actuator": {"effective_area": area}}
    back = Valve.from_dict(data).to_dict()
    assert back["valve"] == pytest.approx(data["valve"], rel=1e-11)
    assert back["actuator"] == pytest.approx(data["actuator"], rel=1e-11)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"valves": {}}, ["[valves]", "section", "did you mean 'valve'?"]),
        ({"valve": 3}, ["valve must be a section"]),
        (changed("valve", kv_rate=1.0), ["[valve]", "'kv_rate'", "did you mean 'kv_rated'?"]),
        (changed("valve", cv_rated=1.0), ["kv_rated and cv_rated", "keep one"]),
        (changed("valve", kv_rated=0.0), ["[valve] kv_rated", "above 0", "m3/h"]),
        (changed("valve", kv_rated="40"), ["kv_rated must be a number", "'40'", "without quotes"]),
        (changed("valve", kv_rated=True), ["kv_rated must be a number"]),
        (changed("valve", kv_rated=float("nan")), ["finite"]),
        (changed("valve", rangeability=1.0), ["rangeability must be above 1"]),
        (changed("valve", shutoff=1.0), ["shutoff", "below 1"]),
        (changed("valve", fl=1.2), ["fl must be above 0 and at most 1", "1.2"]),
        (changed("valve", fl=0.0), ["fl"]),
        (changed("valve", fl=[[0.0, 0.9], [1.0, 1.4]]), ["fl, pair 2, value"]),
        (changed("valve", xt=-0.1), ["xt"]),
        (
            changed("valve", characteristic="equal-percentage"),
            ["characteristic", "did you mean 'equal_percentage'?"],
        ),
        (changed("valve", characteristic=[[0, 0], [0.5, 0.4], [0.4, 0.6]]), ["pair 3", "openings must rise"]),
        (changed("valve", characteristic=[[0, 0], [0.5, 0.4], [1, 0.3]]), ["pair 3", "must not fall"]),
        (changed("valve", characteristic=[[0, 0], [100, 1]]), ["pair 2, opening", "at most 1"]),
        (changed("valve", characteristic=[[0, 0]]), ["at least two"]),
        (changed("valve", characteristic=[[0, 0], [1]]), ["pair 2 is [1]"]),
        (
            changed("valve", characteristic=[[0.1, 0], [0.9, 1]]),
            ["from opening 0 to opening 1", "0.1 to 0.9"],
        ),
        (
            changed("valve", characteristic=[[0, 0], [1, 0]]),
            ["characteristic has no capacity at any opening"],
        ),
        (changed("valve", rangeability=None), ["equal_percentage", "needs rangeability", "add it"]),
        (changed("valve", tag=""), ["tag must be a text"]),
        (changed("fluid", densty=1.0), ["[fluid]", "did you mean 'density'?"]),
        (changed("fluid", name="wather", density=None), ["[fluid] name = 'wather'", "density", "(water)"]),
        (changed("actuator", fail="shut"), ["fail must be one of closed, open", "'shut'"]),
        (changed("actuator", kind="electrical"), ["[actuator] kind", "pneumatic, electric", "leave it out"]),
        (changed("actuator", kind="electric"), ['kind = "electric"', "supply_pressure", "driven by air"]),
        (changed("actuator", stroke_time=-20.0), ["[actuator] stroke_time", "above 0", "-20", "correct it"]),
        (changed("actuator", stroke_time=0), ["stroke_time", "above 0"]),
        (changed("actuator", stroke_time="20 s"), ["stroke_time must be a number"]),
        (changed("actuator", dead_time=-1), ["[actuator] dead_time", "at least 0"]),
        (changed("actuator", dead_band=60.0), ["[actuator] dead_band", "% of travel", "60"]),
        (changed("actuator", positioner="yes"), ["positioner must be true or false"]),
        (changed("actuator", spring_range=[100.0, 20.0]), ["spring_range", "lower number first"]),
        (changed("actuator", spring_range=20.0), ["spring_range", "two numbers"]),
        (changed("simulation", physics="choked_flow"), ["physics must be a list"]),
        (changed("simulation", physics=["choked flow"]), ["names of effects", "'choked flow'"]),
        (changed("simulation", physics=["a", "a"]), ["twice"]),
        (changed("recording", openning={"column": "X", "unit": "%"}), ["[recording.openning]", "'opening'"]),
        (changed("recording", p1="P1"), ["[recording.p1] must be a section"]),
        (changed("recording", time=3), ["[recording] time must be a text"]),
        (changed("recording.p1", unit=None), ["[recording.p1] has no unit", "kPa"]),
        (
            changed("recording.p1", unit="kpa"),
            ["[recording.p1]", "'kpa'", "did you mean 'kPa'?", "known are Pa"],
        ),
        (changed("recording.p1", unit="degC"), ["[recording.p1]", "'degC'", "no known unit of this role"]),
        (changed("recording.p1", col="P"), ["[recording.p1] knows no key 'col'"]),
        (changed("recording.p1", column=None), ["either a column or a constant"]),
        (changed("recording.p1", constant=1.0), ["either a column or a constant"]),
        (changed("recording.p1", sense="closing"), ["sense", "leave it out"]),
        (changed("recording.p2", constant="0"), ["[recording.p2] constant must be a number"]),
        (changed("recording.flow", gauge=True), ["[recording.flow] has gauge", "pressures only"]),
        (changed("recording.command", sense="closed"), ["sense must be one of opening, closing"]),
        (changed("valve", travel=None), ["[recording.opening] is recorded in mm", "travel"]),
    ],
)
def test_bad_description_gets_one_sentence(data, words):
    with pytest.raises(InputError) as caught:
        Valve.from_dict(data, source="FV.toml")
    sentence = str(caught.value)
    assert sentence.startswith("FV.toml: ")
    assert "\n" not in sentence
    assert all(word in sentence for word in words), sentence


def test_read_valve(tmp_path):
    file = tmp_path / "valve.toml"
    file.write_bytes("\ufeff[valve]\ntag = 'Büro'\nkv_rated = 40.0\n".encode())
    assert read_valve(file) == Valve(tag="Büro", kv_rated=40.0)
    assert read_valve(str(file)).source == str(file)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"[valve]\nkv_rated 40\n", ["line 2, column 10", "no valid TOML"]),
        (b"[valve]\ntag = 'open", ["line 2, column 12", "no valid TOML"]),
        (b"[valve]\ntag = 'a'\ntag = 'b'\n", ["line 3", "no valid TOML"]),
        (b"[valve]\ntag = '\xff'\n", ["line 2", "UTF-8"]),
        (b"[valve]\nkv_rated = " + b"9" * 5000, ["a number is beyond what can be read"]),
        (b"[valve]\nfl = " + b"[" * 5000, ["brackets are nested beyond what can be read"]),
        (b"[valve]\nkv = 3\n", ["[valve] knows no key 'kv'"]),
    ],
)
def test_bad_file_gets_file_and_place(tmp_path, content, words):
    file = tmp_path / "valve.toml"
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_valve(file)
    sentence = str(caught.value)
    assert sentence.startswith(f"{file}: ")
    assert "\n" not in sentence
    assert all(word in sentence for word in words), sentence


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_valve(tmp_path / "none.toml")
    with pytest.raises(InputError, match="this is a folder; give"):
        read_valve(tmp_path)


def test_an_actuator_declares_its_response():
    declared = {"kind": "electric", "stroke_time": 60.0, "dead_time": 1.5, "dead_band": 0.5}
    valve = Valve.from_dict({"actuator": declared})
    assert (valve.kind, valve.stroke_time, valve.dead_time) == ("electric", 60.0, 1.5)
    assert valve.dead_band == pytest.approx(0.005)
    assert valve.to_dict()["actuator"] == declared
