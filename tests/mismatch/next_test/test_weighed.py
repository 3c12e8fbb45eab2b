# SPDX-License-Identifier: BSD-3-Clause
"""Which effects a planned test is to tell apart: those of the diagnosis, hidden and own ones among them."""

import copy
from types import SimpleNamespace

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.advice import _effects_to_weigh
from sklvalve.mismatch.data.preparation import candidates, prepared_problem
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording import Recording, Valve

COMPRESSED = {"finding": "compressed", "role": "opening", "size": 0.02, "rows": None, "detail": ""}


def weighed(named, *, effects="all", data=()):
    made = make_valve_recording(n_samples=1200, n_later=0, random_state=0)
    problem = prepared_problem(Recording.from_frame(made.frame, Valve.from_dict(made.valve)))
    entries = [{"members": [{"name": name} for name in named]}]
    finder = SimpleNamespace(effects=effects, diagnosis_=SimpleNamespace(content={"effects": entries}))
    return problem, {e.name for e in _effects_to_weigh(finder, problem, list(data), ())}


def test_what_the_data_hide_and_the_class_holds_is_weighed():
    problem, found = weighed(["backlash", "positioner_deadband"], data=[COMPRESSED])
    assert "positioner_deadband" not in {e.name for e in candidates(problem, "all", [COMPRESSED])[0]}
    assert found == {"backlash", "positioner_deadband"}


def test_an_effect_of_ones_own_is_weighed():
    own = copy.copy(next(e for e in CATALOGUE if e.key == "clogging"))
    own.key = own.name = "worn_groove"
    _, found = weighed(["worn_groove", "stiction"], effects=["stiction", own])
    assert found == {"worn_groove", "stiction"}
