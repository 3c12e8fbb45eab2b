# SPDX-License-Identifier: BSD-3-Clause
"""Each screen finds what was done to a healthy recording, and says nothing of the healthy one."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.datasets import make_valve_recording
from sklvalve.recording import Recording, Valve, screen_recording

N = 3000


def smooth(values, rows):
    """First-order lag of so many rows."""
    out = np.empty_like(values)
    state = values[0]
    for row, value in enumerate(values):
        state += (value - state) / rows
        out[row] = state
    return out


def healthy(seed=0):
    """Percent, kPa, degC and m3/h of a valve that is moved about, with noise and two to three decimals."""
    rng = np.random.default_rng(seed)
    targets = np.repeat(rng.uniform(20.0, 80.0, N // 60), 60)
    command = np.round(smooth(targets, 3.0), 2)
    stem = smooth(command, 4.0)
    p1 = 800.0 + smooth(rng.normal(0.0, 60.0, N), 50.0)
    p2 = 300.0 + smooth(rng.normal(0.0, 60.0, N), 50.0)
    flow = smooth(0.4 * stem * np.sqrt((p1 - p2) / 100.0), 2.0)
    return {
        "time": np.arange(float(N)),
        "CV": command,
        "X": np.round(stem + rng.normal(0.0, 0.15, N), 2),
        "P1": np.round(p1 + rng.normal(0.0, 1.0, N), 1),
        "P2": np.round(p2 + rng.normal(0.0, 1.0, N), 1),
        "T": np.round(40.0 + smooth(rng.normal(0.0, 3.0, N), 100.0) + rng.normal(0.0, 0.1, N), 2),
        "F": np.round(flow + rng.normal(0.0, 0.2, N), 3),
    }


ROLES = {
    "command": {"column": "CV", "unit": "%"},
    "opening": {"column": "X", "unit": "%"},
    "p1": {"column": "P1", "unit": "kPa"},
    "p2": {"column": "P2", "unit": "kPa"},
    "temperature": {"column": "T", "unit": "degC"},
    "flow": {"column": "F", "unit": "m3/h"},
}


def screened(columns, sheet=None, **roles):
    valve = Valve.from_dict({"valve": sheet or {"kv_rated": 40.0}, "recording": {**ROLES, **roles}})
    found = screen_recording(Recording.from_frame(columns, valve))
    assert json.loads(json.dumps(found)) == found
    return found


def names(found):
    return {(each["finding"], each["role"]) for each in found}


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=25)
def test_healthy_recording_has_no_finding(seed):
    assert screened(healthy(seed)) == []


@pytest.mark.parametrize("step", [0.25, 2.0])
def test_coarse_steps_are_stated(step):
    columns = healthy()
    columns["X"] = step * np.round(columns["X"] / step)
    (found,) = screened(columns)
    assert (found["finding"], found["role"], found["rows"]) == ("quantised", "opening", None)
    assert f"steps of {step:g} %" in found["detail"]


def test_coarse_steps_redrawn_between():
    columns = healthy()
    coarse = 10.0 * np.round(columns["P1"] / 10.0)
    moving = np.flatnonzero(np.diff(coarse) != 0.0)
    coarse[moving] += np.random.default_rng(1).uniform(-4.0, 4.0, len(moving))
    columns["P1"] = coarse
    (found,) = screened(columns)
    assert (found["finding"], found["role"]) == ("quantised", "p1")
    assert "steps of 10 kPa, redrawn between them" in found["detail"]


def swinging_door(values, band):
    """Points that a historian's swinging door keeps, and the straight lines drawn between them."""
    kept, start = [0], 0
    low, high = -np.inf, np.inf
    for row in range(1, len(values)):
        low = max(low, (values[row] - band - values[start]) / (row - start))
        high = min(high, (values[row] + band - values[start]) / (row - start))
        if low > high:
            start = row - 1
            kept.append(start)
            low, high = values[row] - band - values[start], values[row] + band - values[start]
    kept.append(len(values) - 1)
    return np.interp(np.arange(len(values)), kept, values[kept])


@pytest.mark.parametrize(
    ("column", "role", "band"), [("P1", "p1", 4.0), ("F", "flow", 1.0), ("X", "opening", 1.0)]
)
@pytest.mark.parametrize("decimals", [3, 9])
def test_swinging_door_is_compression(column, role, band, decimals):
    columns = healthy()
    columns[column] = np.round(swinging_door(columns[column], band), decimals)
    found = screened(columns)
    assert names(found) == {("compressed", role)}
    assert "straight lines" in found[0]["detail"]


def test_rate_limit_is_no_compression():
    columns = healthy()
    target, position = columns["CV"], np.empty(N)
    state = target[0]
    for row in range(N):
        state += np.clip(target[row] - state, -0.8, 0.8)
        position[row] = state
    columns["X"] = np.round(position, 2)
    assert ("compressed", "opening") not in names(screened(columns))


def test_dead_band_of_a_historian_is_compression():
    columns = healthy()
    kept = columns["P1"].copy()
    for row in range(1, N):
        if abs(kept[row] - kept[row - 1]) < 3.0:
            kept[row] = kept[row - 1]
    columns["P1"] = kept
    found = screened(columns)
    assert ("compressed", "p1") in names(found)
    assert "changes of less than 3" in found[0]["detail"]


def test_slow_scan_is_compression():
    columns = healthy()
    columns["F"] = np.repeat(columns["F"][::5], 5)
    found = screened(columns)
    assert names(found) == {("compressed", "flow")}
    assert "held for 5 rows" in found[0]["detail"]


def test_clipped_flow_is_saturated():
    columns = healthy()
    limit = float(np.quantile(columns["F"], 0.9))
    columns["F"] = np.minimum(columns["F"], limit)
    found = screened(columns)
    assert names(found) == {("saturated", "flow")}
    for start, stop in found[0]["rows"]:
        assert (columns["F"][start:stop] == limit).all()


def test_shut_valve_is_neither_frozen_nor_saturated():
    columns = healthy()
    for name in ("CV", "X", "F"):
        columns[name][1000:1300] = 0.0
        columns[name][2000:2200] = 0.0
    assert screened(columns) == []


def test_frozen_sensor():
    columns = healthy()
    columns["P2"][700:800] = columns["P2"][700]
    (found,) = screened(columns)
    assert (found["finding"], found["role"], found["rows"]) == ("frozen", "p2", [[700, 800]])
    assert "100 s" in found["detail"]


def test_frozen_throughout():
    columns = healthy()
    columns["T"][:] = 40.0
    (found,) = screened(columns)
    assert (found["finding"], found["role"], found["rows"]) == ("frozen", "temperature", None)


def test_gaps_in_rows_and_values():
    columns = healthy()
    columns["F"][10:15] = np.nan
    columns["F"][40] = np.nan
    keep = np.ones(N, dtype=bool)
    keep[500:530] = False
    found = screened({name: values[keep] for name, values in columns.items()})
    assert names(found) == {("gap", None), ("gap", "flow")}
    times, values = found
    assert times["rows"] == [[499, 501]]
    assert "longest: 31 s" in times["detail"]
    assert values["rows"] == [[10, 15], [40, 41]]
    assert "6 of 2970 values" in values["detail"]


@pytest.mark.parametrize(
    ("late", "role", "cause"), [(("X", "F"), "opening", "command"), (("F",), "flow", "opening")]
)
def test_consequence_before_its_cause(late, role, cause):
    columns = healthy()
    shift = 12
    length = N - shift
    moved = {name: values[shift:] if name in late else values[:length] for name, values in columns.items()}
    (found,) = screened(moved)
    assert (found["finding"], found["role"]) == ("clock_shift", role)
    assert cause in found["detail"]


def test_late_stem_is_no_clock_shift():
    columns = healthy()
    columns["CV"] = np.concatenate([columns["CV"][12:], np.full(12, columns["CV"][-1])])
    assert screened(columns) == []


@pytest.mark.parametrize("shift", [6, -6])
@pytest.mark.parametrize(("column", "role"), [("F", "flow"), ("X", "opening")])
def test_clock_of_one_channel(column, role, shift):
    columns = healthy()
    columns[column] = np.roll(columns[column], shift)
    found = screened({name: values[10:-10] for name, values in columns.items()})
    assert names(found) == {("clock_shift", role)}
    assert f"{'late' if shift > 0 else 'early'}" in found[0]["detail"]


@pytest.mark.parametrize("column", ["F", "X"])
def test_what_comes_late_in_one_part_only_is_no_clock(column):
    # a stem that is slow, or a meter that is damped, until it is mended; a clock is off all the time
    columns = healthy()
    columns[column][:2000] = np.roll(columns[column], 12)[:2000]
    assert "clock_shift" not in {each["finding"] for each in screened(columns)}


@pytest.mark.parametrize(("loop", "seed"), [("closed", 140008), ("mixed", 140003)])
def test_early_command_of_a_controller(loop, seed):
    # it answers the flow's noise before that is there, and the stem is late by as much; in a mixed recording a
    # controller is at work in one part only
    made = make_valve_recording(loop=loop, random_state=seed, n_later=0)
    columns, early = made.frame.copy(), 10
    columns["CV"] = np.append(columns["CV"].to_numpy()[early:], [columns["CV"].iloc[-1]] * early)
    (found,) = screen_recording(Recording.from_frame(columns, Valve.from_dict(made.valve)))
    assert (found["finding"], found["role"]) == ("clock_shift", "command")
    assert found["size"] == pytest.approx(-early, abs=1.0)


def test_flow_and_stem_late_behind_the_pressures():
    columns = healthy()
    moved = {name: values[:-12] if name in ("X", "F") else values[12:] for name, values in columns.items()}
    moved["time"] = columns["time"][12:]
    assert names(screened(moved)) == {("clock_shift", "flow")}


def test_partly_swapped_pressures():
    columns = healthy()
    columns["P1"][1000:2000], columns["P2"][1000:2000] = (
        columns["P2"][1000:2000],
        columns["P1"][1000:2000].copy(),
    )
    found = screened(columns)
    assert names(found) == {("swapped", "p2")}
    assert "33 %" in found[0]["detail"]
    assert found[0]["rows"] == [[1000, 2000]]


def test_fraction_read_as_percent():
    columns = healthy()
    columns["X"] = np.round(columns["X"] / 100.0, 4)
    found = screened(columns)
    assert names(found) == {("unit_suspect", "opening")}
    assert "is its unit '1'" in found[0]["detail"]


def test_sense_against_the_command():
    columns = healthy()
    columns["X"] = np.round(100.0 - columns["X"], 2)
    found = screened(columns)
    assert ("unit_suspect", "opening") in names(found)
    assert screened(columns, opening={**ROLES["opening"], "sense": "closing"}) == []


def test_units_that_no_plant_can_have():
    assert names(screened(healthy(), temperature={"column": "T", "unit": "K"})) == {
        ("unit_suspect", "temperature")
    }
    in_bar = {role: {**ROLES[role], "unit": "bar"} for role in ("p1", "p2")}
    assert ("unit_suspect", "p1") in names(screened(healthy(), {"tag": "FV without kv_rated"}, **in_bar))


def test_vacuum_from_a_forgotten_gauge():
    columns = healthy()
    columns["P2"] = np.round(columns["P2"] - 300.0, 1)
    found = screened(columns, p2={"column": "P2", "unit": "kPa", "gauge": False})
    assert ("unit_suspect", "p2") in names(found)
    assert screened(columns, p2={"column": "P2", "unit": "kPa", "gauge": True}) == []
    constant = screened(healthy(), p2={"constant": 0.0, "unit": "kPa"})
    assert names(constant) == {("unit_suspect", "p2")}


@pytest.mark.parametrize(
    ("unit", "words"), [("m3/s", "times the rated capacity"), ("l/min", "never takes more than")]
)
def test_flow_in_a_wrong_unit(unit, words):
    columns = healthy()
    columns["CV"][-300:] = columns["X"][-300:] = 90.0
    columns["X"][-300:] += np.round(np.random.default_rng(2).normal(0.0, 0.15, 300), 2)
    sheet = {"kv_rated": 500.0} if unit == "l/min" else {"kv_rated": 40.0}
    found = screened(columns, sheet, flow={"column": "F", "unit": unit})
    assert names(found) == {("unit_suspect", "flow")}
    assert words in found[0]["detail"]


def test_constant_and_short_recordings_are_no_trouble():
    frame = {"time": np.arange(3.0), "command": np.full(3, 0.5), "flow": np.array([np.nan, 1.0, 1.0])}
    assert names(screen_recording(Recording.from_frame(frame))) == {("gap", "flow")}
    one = {"time": np.array([0.0]), "flow": np.array([1.0])}
    assert screen_recording(Recording.from_frame(one)) == []
