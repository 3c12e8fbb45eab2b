# SPDX-License-Identifier: BSD-3-Clause
"""Effects that a valve may have, and that what is wrong with the data keeps from being found."""

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.data.preparation import candidates, hidden_by_data, prepared_problem
from sklvalve.recording import Recording, Valve

COMPRESSED = {"finding": "compressed", "role": "opening", "size": 0.02, "rows": None, "detail": ""}


def test_effects_hidden_by_the_data_are_those_that_sound_data_would_let_be_found():
    made = make_valve_recording(n_samples=1200, n_later=0, random_state=0)
    problem = prepared_problem(Recording.from_frame(made.frame, Valve.from_dict(made.valve)))
    assert hidden_by_data(problem, "all", candidates(problem, "all", [])[0]) == []
    able, _ = candidates(problem, "all", [COMPRESSED])
    hidden = hidden_by_data(problem, "all", able)
    assert "positioner_deadband" in {effect.name for effect in hidden}
    assert {e.key for e in able} | {e.key for e in hidden} == {
        e.key for e in candidates(problem, "all", [])[0]
    }
    # what was not asked for is no explanation either
    assert {e.name for e in hidden_by_data(problem, ["stiction"], able)} == {"stiction"}
