# SPDX-License-Identifier: BSD-3-Clause
"""A clock that is off is told, and what is slow, or late in one part only, is not taken for one."""

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.recording import Recording, Valve, screen_recording
from tests.recording.planted import N, healthy, names, screened


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
    # it answers the flow's noise before that is there, and the stem is late by as much; in a mixed recording
    # a controller is at work in one part only
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
