# SPDX-License-Identifier: BSD-3-Clause
"""What a recording's data hide, and what they do not."""

import pytest

from sklvalve import Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.preparation import candidates, prepared_workbench


@pytest.fixture(scope="module")
def bench():
    made = make_valve_recording(None, loop="wide", n_samples=600, n_later=0, random_state=5)
    return prepared_workbench(Recording.from_frame(made.frame, Valve.from_dict(made.valve)))


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
