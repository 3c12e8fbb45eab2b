# SPDX-License-Identifier: BSD-3-Clause
"""Each screen finds what was done to a healthy recording, and says nothing of the healthy one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.data_defects import swinging_door
from sklvalve.recording import Recording, screen_recording
from tests.recording.planted import ROLES, N, healthy, names, screened


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


@pytest.mark.parametrize(("column", "step", "size"), [("X", 0.25, 0.0025), ("F", 0.5, None)])
@pytest.mark.parametrize("travel", [1.0, 0.2])
def test_steps_are_held_against_what_an_effect_must_be_of_to_count(column, step, size, travel):
    # the whole travel, of a flow what it reaches, however little of it a recording goes through
    columns = healthy()
    kept = columns[column]
    columns[column] = step * np.round((kept.mean() + travel * (kept - kept.mean())) / step)
    (found,) = [each for each in screened(columns) if each["finding"] == "quantised"]
    assert found["size"] == pytest.approx(size or step / np.quantile(columns[column], 0.995), rel=1e-3)


def test_coarse_steps_redrawn_between():
    columns = healthy()
    coarse = 10.0 * np.round(columns["P1"] / 10.0)
    moving = np.flatnonzero(np.diff(coarse) != 0.0)
    coarse[moving] += np.random.default_rng(1).uniform(-4.0, 4.0, len(moving))
    columns["P1"] = coarse
    (found,) = screened(columns)
    assert (found["finding"], found["role"]) == ("quantised", "p1")
    assert "steps of 10 kPa, redrawn between them" in found["detail"]


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
    columns["P1"] = _held(columns["P1"], 3.0)
    found = screened(columns)
    assert ("compressed", "p1") in names(found)
    assert "changes of less than 3" in found[0]["detail"]


def _held(values, band):
    kept = values.copy()
    for row in range(1, N):
        if abs(kept[row] - kept[row - 1]) < band:
            kept[row] = kept[row - 1]
    return kept


@pytest.mark.parametrize("others", [("P1", "P2", "F"), ("P1",), ()])
def test_coarse_steps_that_were_held_are_known_by_the_other_signals(others):
    # three steps of a converter at once: a stem that sticks moves so, but it sticks alone
    step = 100.0 / 326.3291
    columns = healthy()
    columns["X"] = _held(step * np.round(columns["X"] / step), 0.7)
    for name in others:
        columns[name] = _held(columns[name], 0.01 * columns[name].max())
    found = {each["role"]: each for each in screened(columns) if each["finding"] == "compressed"}
    assert ("opening" in found) == (len(others) >= 2)
    if len(others) >= 2:
        assert found["opening"]["size"] == pytest.approx(0.03 / 3.263291)
        assert "changes of less than 0.919 %" in found["opening"]["detail"]


def test_coarse_steps_beside_held_signals_are_no_dead_band():
    columns = healthy()
    columns["X"] = 0.306 * np.round(columns["X"] / 0.306)
    for name in ("P1", "P2", "F"):
        columns[name] = _held(columns[name], 0.01 * columns[name].max())
    assert ("compressed", "opening") not in names(screened(columns))


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
