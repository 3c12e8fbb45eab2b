# SPDX-License-Identifier: BSD-3-Clause
"""What a history keeps of the diagnosis of its own recordings."""

import copy
from dataclasses import replace

import pytest

from sklvalve.history import ByItself, ValveHistory
from sklvalve.history.state import require_sound_history

SOUND = ByItself("no_mismatch", "Nothing relevant is missing.")
LEAKS = ByItself("named", "Likely fault: seat leakage.", held=True)
NEVER_CHECKED = ByItself("named", "Likely fault: a worn gear.", held=True, checked=False)
UNEXPLAINED = ByItself("none_of_these", "Something is missing.")
OPEN = ByItself("cannot_tell", "Something is missing.", "It is short.")


def test_nothing_is_said_of_a_sound_history():
    assert SOUND.clean
    assert SOUND.sentence == ""


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (LEAKS, "not sound: Likely fault: seat leakage. What is told here is what changed since."),
        (ByItself("named", "Likely fault: drift."), "may pass for a change, or hide one."),
        (ByItself("none_of_these", "Something is missing."), "may pass for a change, or hide one."),
        (OPEN, "The history was not found sound: Something is missing. This history does not hold that"),
    ],
)
def test_one_sentence_on_a_history_that_is_not(found, words):
    assert not found.clean
    assert words in found.sentence


def test_it_is_not_known_unless_it_was_asked(learnt):
    assert learnt.by_itself_ is None
    assert learnt.to_state()["clean"] == {}


RIVALS = ByItself("named", "Likely fault: drift.", rivals={"flow_meter_drift": ["clogging", "erosion"]})


@pytest.mark.parametrize("found", [SOUND, replace(NEVER_CHECKED, held=False), OPEN, RIVALS])
def test_it_comes_back(learnt, found):
    history = copy.deepcopy(learnt)
    history.by_itself_ = found
    state = history.to_state()
    require_sound_history(state, ())
    assert ValveHistory.from_state(history.valve_, state).by_itself_ == found


@pytest.mark.parametrize(
    ("one", "other", "both"),
    [
        (None, None, None),
        (SOUND, None, SOUND),
        (None, OPEN, OPEN),
        (SOUND, OPEN, OPEN),
        (OPEN, SOUND, OPEN),
        (LEAKS, OPEN, OPEN),
        (LEAKS, NEVER_CHECKED, NEVER_CHECKED),
        (NEVER_CHECKED, SOUND, NEVER_CHECKED),
        (UNEXPLAINED, LEAKS, UNEXPLAINED),
        (UNEXPLAINED, OPEN, OPEN),
        (NEVER_CHECKED, UNEXPLAINED, NEVER_CHECKED),
        (UNEXPLAINED, NEVER_CHECKED, NEVER_CHECKED),
        (replace(LEAKS, held=False), replace(NEVER_CHECKED, held=False), replace(NEVER_CHECKED, held=False)),
    ],
)
def test_of_two_histories_the_one_that_leaves_more_open_is_told(learnt, learnt_after, one, other, both):
    first, second = copy.deepcopy(learnt), copy.deepcopy(learnt_after)
    first.by_itself_, second.by_itself_ = one, other
    assert first.merge(second).by_itself_ == both


def test_of_two_histories_each_effect_has_the_rivals_of_both(learnt, learnt_after):
    first, second = copy.deepcopy(learnt), copy.deepcopy(learnt_after)
    first.by_itself_ = replace(RIVALS, rivals={"flow_meter_drift": ["clogging", "erosion"]})
    second.by_itself_ = replace(OPEN, rivals={"flow_meter_drift": ["erosion", "bypass_open"]})
    both = first.merge(second).by_itself_.rivals
    assert both == {"flow_meter_drift": ["clogging", "erosion", "bypass_open"]}


@pytest.mark.parametrize(("key", "without"), [("checked", False), ("rivals", {})])
def test_a_file_that_does_not_say_so_much_is_read(learnt, key, without):
    history = copy.deepcopy(learnt)
    history.by_itself_ = replace(LEAKS, held=False)
    state = history.to_state()
    del state["clean"][key]
    require_sound_history(state, ())
    assert getattr(ValveHistory.from_state(history.valve_, state).by_itself_, key) == without


LIES = {
    "another verdict": {"verdict": "fine"},
    "a key more": {"more": 1},
    "held by nothing": {"verdict": "named", "held": True},
    "held, and no truth value": {"held": 1},
    "checked, and no truth value": {"checked": "yes"},
    "no classes": {"rivals": ["clogging"]},
    "a class that is none": {"rivals": {"clogging": "erosion"}},
    "a class without end": {"rivals": {"clogging": ["erosion"] * 1_000}},
    "a name of control": {"rivals": {"clogging": ["\x1b[2J"]}},
    "no words": {"finding": 3},
    "words of control": {"finding": "\x1b[2J"},
    "a book": {"reason": "x" * 3_000},
}


@pytest.mark.parametrize("lie", LIES.values(), ids=LIES)
def test_a_lie_is_refused(learnt, lie):
    state = copy.deepcopy(learnt.to_state())
    state["clean"] = {"verdict": "no_mismatch", "finding": "", "reason": "", "held": False} | lie
    with pytest.raises(ValueError, match="what it holds by itself is"):
        require_sound_history(state, ())
