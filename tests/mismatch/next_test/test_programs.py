# SPDX-License-Identifier: BSD-3-Clause
"""Programs stay within what the process allows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.mismatch import TestLimits
from sklvalve.mismatch.next_test.programs import as_now, library
from sklvalve.recording import Recording


@settings(deadline=None, max_examples=40)
@given(
    low=st.floats(0.0, 0.6),
    width=st.floats(0.02, 0.4),
    about=st.floats(-0.1, 1.1),
    rows=st.integers(20, 900),
    step=st.sampled_from([0.5, 1.0, 10.0]),
    rate=st.sampled_from([0.001, 0.01, np.inf]),
)
def test_programs_stay_within_range_rate_and_length(low, width, about, rows, step, rate):
    limits = TestLimits(rate=rate, pressures=("p1", "p2"))
    programs = library(low, low + width, about, rows, step, limits)
    for program in programs:
        assert program.command.shape == (rows,)
        assert program.command.min() >= low - 1e-9
        assert program.command.max() <= low + width + 1e-9
        assert np.abs(np.diff(program.command)).max() <= rate * step * (1.0 + 1e-9)
        assert program.text
        assert all(np.abs(moved).max() <= limits.pressure_share for moved in program.moved.values())
    names = [p.name for p in programs]
    assert len(set(names)) == len(names)
    assert ("near the seat" in names) == (low < 0.05)


def test_programs_move_the_pressures_that_can_be_moved_and_no_others():
    for pressures in ((), ("p1",), ("p2",)):
        programs = library(0.0, 1.0, 0.5, 300, 1.0, TestLimits(pressures=pressures))
        assert {role for p in programs for role in p.moved} == set(pressures)
    both = library(0.0, 1.0, 0.5, 300, 1.0, TestLimits(pressures=("p1", "p2")))
    together = next(p for p in both if len(p.moved) == 2)
    # at some time at a constant drop, at some time not
    drop = together.moved["p1"] - together.moved["p2"]
    lifted = together.moved["p1"] > 0.0
    assert np.any(drop[lifted] == 0.0)
    assert np.any(drop[lifted] > 0.0)


def test_a_shut_valve_stays_shut_while_pressures_move_often_to_either_side():
    made = library(0.0, 1.0, 0.5, 900, 1.0, TestLimits(pressures=("p2",), pressure_share=0.2))
    shut = next(p for p in made if p.name == "p2 moved, shut")
    assert np.all(shut.command[1:] == 0.0)
    assert set(np.unique(shut.moved["p2"])) == {-0.2, 0.0, 0.2}
    # as often up as down, and moved every half a minute
    assert shut.moved["p2"][:840].sum() == pytest.approx(0.0, abs=1e-9)
    assert np.count_nonzero(np.diff(shut.moved["p2"])) == 29
    assert "shut for 900 s" in shut.text
    assert "20 % of the pressure drop, 30 s each time" in shut.text
    # where the command may not shut the valve, no program does
    made = library(0.1, 1.0, 0.5, 900, 1.0, TestLimits(pressures=("p2",)))
    assert [p.name for p in made if p.moved] == ["p2 moved"]


def test_a_slow_triangle_visits_the_whole_range_evenly():
    command = library(0.2, 0.8, 0.5, 900, 1.0, TestLimits())[0].command[1:]
    assert command.min() == pytest.approx(0.2, abs=1e-3)
    assert command.max() == pytest.approx(0.8, abs=2e-3)
    assert np.histogram(command, 6)[0] == pytest.approx(150, abs=3)


def test_a_recording_goes_on_as_it_is_where_it_has_no_gaps():
    frame = {"time": np.arange(200.0), "command": np.linspace(0.2, 0.7, 200), "flow": np.ones(200)}
    assert np.array_equal(as_now(Recording.from_frame(frame), 100).command, frame["command"][-100:])
    assert as_now(Recording.from_frame(frame), 300) is None
    frame["command"][150] = np.nan
    assert as_now(Recording.from_frame(frame), 100) is None


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        ({"opening": (0.7, 0.3)}, "range within 0 and 1"),
        ({"opening": (0.5, 1.2)}, "range within 0 and 1"),
        ({"rate": 0.0}, "above zero"),
        ({"duration": -5.0}, "above zero"),
        ({"pressures": ("flow",)}, "p1 and p2"),
        ({"pressure_share": 1.5}, "between 0 and 1"),
    ],
)
def test_limits_that_leave_nothing_are_refused_in_one_sentence(limits, said):
    with pytest.raises(ValueError, match=said):
        TestLimits(**limits)
