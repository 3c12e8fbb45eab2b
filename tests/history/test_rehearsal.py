# SPDX-License-Identifier: BSD-3-Clause
"""How far parts of a history lie from each other: kept, merged, and refused where it is none."""

import copy

import pytest

from sklvalve.history import ValveHistory
from sklvalve.history.rehearsal import Rehearsal
from sklvalve.history.state import require_sound_history

MANY = [Rehearsal(1.5, 0.2, 0.7), Rehearsal(13.0, 0.0)]


@pytest.fixture
def rehearsed(learnt):
    history = copy.deepcopy(learnt)
    history.rehearsals_ = MANY
    return history


def test_a_fit_alone_rehearses_nothing(learnt):
    assert learnt.rehearsals_ == []


def test_they_come_back(rehearsed):
    state = rehearsed.to_state()
    require_sound_history(state, ())
    assert ValveHistory.from_state(rehearsed.valve_, state).rehearsals_ == MANY


def test_those_of_an_older_file_come_back(rehearsed):
    state = rehearsed.to_state()
    for looks in state["rehearsals"]["each"]:
        looks["rest"] = looks.pop("residual")
    require_sound_history(state, ())
    assert ValveHistory.from_state(rehearsed.valve_, state).rehearsals_ == MANY


def test_both_histories_keep_theirs(rehearsed, learnt_after):
    other = copy.deepcopy(learnt_after)
    other.rehearsals_ = [Rehearsal(2.0, 0.5, 1.0)]
    assert rehearsed.merge(other).rehearsals_ == [*MANY, Rehearsal(2.0, 0.5, 1.0)]


@pytest.mark.parametrize(
    "each",
    [
        None,
        [{"throughout": 1.0, "within": 1.0}],
        [{"effects": 1.0, "residual": None}],
        [{"throughout": -1.0, "within": 1.0, "residual": None}],
        [{"throughout": 1.0, "within": -1.0, "residual": None}],
        [{"throughout": float("nan"), "within": 1.0, "residual": None}],
        [{"throughout": 1.0, "within": 1.0, "residual": "much"}],
        ["far"],
    ],
)
def test_what_is_none_is_refused(rehearsed, each):
    state = rehearsed.to_state()
    state["rehearsals"]["each"] = each
    with pytest.raises(ValueError, match="rehears"):
        require_sound_history(state, ())
