# SPDX-License-Identifier: BSD-3-Clause
"""What a recording's data hide, and what they do not."""

import pytest

from sklvalve import Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.data.preparation import candidates, prepared_problem


@pytest.fixture(scope="module")
def bench():
    made = make_valve_recording(None, loop="wide", n_samples=600, n_later=0, random_state=5)
    return prepared_problem(Recording.from_frame(made.frame, Valve.from_dict(made.valve)))


def _plays(bench, *data):
    found, lacking = candidates(bench, ["backlash"], list(data))
    return {e.key for e in found}, lacking


def _found(name, role, size):
    return {"finding": name, "role": role, "detail": "", "rows": None, "size": size}


@pytest.mark.parametrize(("name", "size"), [("compressed", 1e-4), ("quantised", 0.02)])
def test_a_flow_drawn_anew_hides_no_play_that_the_opening_shows(bench, name, size):
    assert _plays(bench) == ({"backlash", "backlash_linkage"}, [])
    assert _plays(bench, _found(name, "flow", size)) == ({"backlash_linkage"}, [])


@pytest.mark.parametrize(
    "data",
    [_found("quantised", "opening", 0.02), _found("clock_shift", "flow", 3.0), _found("swapped", None, 1.0)],
)
def test_what_hides_play_everywhere_hides_it_in_the_opening(bench, data):
    keys, (lacking,) = _plays(bench, data)
    assert keys == set()
    assert lacking["name"] == "backlash"


def _lacking(sheet=None, fluid=None):
    made = make_valve_recording(None, loop="wide", n_samples=600, n_later=0, random_state=5)
    valve = {**made.valve, "fluid": fluid or made.valve["fluid"], **(sheet or {})}
    bench = prepared_problem(Recording.from_frame(made.frame, Valve.from_dict(valve)))
    found, lacking = candidates(bench, "all", [])
    return {e.name for e in found}, {each["name"]: each for each in lacking}


def test_what_a_fluid_cannot_have_does_not_apply(bench):
    _, lacking = _lacking()
    assert lacking["gas_expansion"] == {"name": "gas_expansion", "needs": "a gas", "applies": False}
    assert [name for name, each in lacking.items() if not each.get("applies", True)] == ["gas_expansion"]
    air = {"name": "air", "density": 6.0, "molar_mass": 0.029, "heat_capacity_ratio": 1.4}
    found, lacking = _lacking(fluid=air)
    assert "gas_expansion" in found
    for name in ("choked_flow", "cavitation", "flashing"):
        assert lacking[name] == {"name": name, "needs": "a liquid", "applies": False}


def test_what_a_motor_cannot_have_does_not_apply():
    found, lacking = _lacking({"actuator": {"kind": "electric"}})
    never = {name for name, each in lacking.items() if not each.get("applies", True)}
    assert {"spring_fault", "actuator_leak", "supply_pressure_drop"} <= never
    assert not never & found
    assert "slew_limit" in found
    assert not [name for name, each in lacking.items() if "air" in each["needs"] and name not in never]
