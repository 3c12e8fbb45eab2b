# SPDX-License-Identifier: BSD-3-Clause
"""Wrong uses of a history, each refused with one plain sentence."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from sklvalve.history import Allowance, ValveHistory
from sklvalve.history.compatible import require_compatible
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import InputError
from sklvalve.simulation import Tolerance
from tests.history.plant import changed, dated, held, made, named, of_sheet, without

LOOP = ("opening", "p1", "p2", "temperature")


def sentence(work):
    """What is said of a wrong use: one sentence that can be printed."""
    with pytest.raises(InputError) as caught:
        work()
    words = str(caught.value)
    assert words.isprintable()
    assert not words.endswith(".")
    return words


BEFORE, AFTER = (named(each, name) for each, name in zip(made(), ("before", "after"), strict=True))

# what a history is told to learn from, with which settings
LEARNT_FROM = {
    "nothing": ([], {}, "the list is empty"),
    "a number": (5, {}, "got 5"),
    "a path": ("before.csv", {}, "read the file with read_recording first"),
    "a path in a list": ([BEFORE, "x.csv"], {}, "got 'x.csv'"),
    "another history": ([ValveHistory()], {}, "got ValveHistory()"),
    "too few rows": ([BEFORE.slice(0, 599)], {}, "of 599 rows is too short"),
    "too few rows in all": ([BEFORE.slice(0, 250), AFTER.slice(0, 250)], {}, "of 500 rows is too short"),
    "a recording twice": ([BEFORE, BEFORE], {}, "1200 rows that are equal"),
    "two valves": ([BEFORE, of_sheet(AFTER, kv_rated=25.0)], {}, "gives kv_rated as 25.0"),
    "two sets of signals": ([BEFORE, without(AFTER, "p1")], {}, "there is no p1, which"),
    "two kinds of flow": ([BEFORE, replace(AFTER, mass_flow=True)], {}, "a flow by mass"),
    "a loop": ([without(BEFORE, *LOOP)], {}, "a command and a value without pressures"),
    "a command that stands still": ([held(BEFORE, "command")], {}, "(command) holds one value"),
    "a flow that stands still": ([held(BEFORE, "flow")], {}, "(flow) holds one value"),
    "all gaps": ([changed(BEFORE, flow=np.full(1200, np.nan))], {}, "(flow) holds no value"),
    "no drop": ([changed(BEFORE, p1=BEFORE["p2"])], {}, "p1 is nowhere above p2"),
    "start of NaN": ([BEFORE], {"start": {"actuator_gain": np.nan}}, "actuator_gain of the start"),
    "start of a number": ([BEFORE], {"start": 3.0}, "start of a history must be a dict"),
    "NaN tolerance": ([BEFORE], {"tolerance": Tolerance(capacity=np.nan)}, "capacity of the tolerance"),
    "text as tolerance": ([BEFORE], {"tolerance": "wide"}, "of type Tolerance, got 'wide'"),
    "negative allowance": ([BEFORE], {"allowance": Allowance(trim=-0.1)}, "trim of the allowance"),
    "no allowance": ([BEFORE], {"allowance": Allowance(recovery=0.0)}, "must be a number above 0, got 0.0"),
    "allowance of another kind": ([BEFORE], {"allowance": Tolerance()}, "of type Allowance, got Tol"),
}


@pytest.mark.parametrize(("recordings", "settings", "words"), LEARNT_FROM.values(), ids=LEARNT_FROM)
def test_what_nothing_can_be_learnt_from(recordings, settings, words):
    history = ValveHistory(**settings)
    assert words in sentence(lambda: history.fit(recordings))
    assert not hasattr(history, "values_")


UPDATED_WITH = {
    "nothing": ([], "the list is empty"),
    "itself": (BEFORE, "the history holds these rows already"),
    "a part of itself": (BEFORE.slice(300, 900), "the history holds these rows already"),
    "a recording twice": ([AFTER, AFTER], "after.csv: the history holds these rows already"),
    "too few rows": (AFTER.slice(0, 100), "100 rows are too few to add to a history"),
    "another valve": (of_sheet(AFTER, rangeability=30.0), "gives rangeability as 30.0"),
    "another tag": (of_sheet(AFTER, tag="FV-102"), "gives tag as 'FV-102'"),
    "fewer signals": (without(AFTER, "temperature"), "there is no temperature, which the history holds"),
    "more signals": (changed(AFTER, supply_pressure=np.ones(1200)), "holds supply_pressure, which"),
    "another kind of flow": (replace(AFTER, mass_flow=True), "a flow by mass"),
}


@pytest.mark.parametrize(("recordings", "words"), UPDATED_WITH.values(), ids=UPDATED_WITH)
def test_what_a_history_is_not_updated_with(learnt, recordings, words):
    history = copy.deepcopy(learnt)
    assert words in sentence(lambda: history.update(recordings))
    assert (history.rows, len(history.recordings_)) == (1200, 1)


HELD_AGAINST = {
    "another valve": (of_sheet(AFTER, kv_rated=25.0), "kv_rated as 25.0, and that of the history as 40.0"),
    "another fluid": (of_sheet(AFTER, fluid={"name": "oil"}), "gives fluid as {'name': 'oil'}"),
    "another tag": (of_sheet(AFTER, tag="FV-102"), "tag as 'FV-102', and that of the history as 'FV-101'"),
    "no opening": (without(AFTER, "opening"), "there is no opening, which the history holds"),
    "no pressures": (without(AFTER, "p1", "p2"), "there is no p1, which the history holds"),
    "more signals": (
        changed(AFTER, simulated_flow=AFTER["flow"]),
        "holds simulated_flow, which the history lacks",
    ),
    "another kind of flow": (replace(AFTER, mass_flow=True), "holds a flow by mass and the history one by v"),
    "a loop": (without(AFTER, *LOOP), "or diagnose it without a history"),
    "its own rows": (BEFORE, "the history holds rows of this recording, by data frame"),
    "a part of its rows": (BEFORE.slice(100, 700), "the history holds rows of this recording"),
    "another range": (
        changed(
            AFTER,
            command=AFTER["command"] * 0.05 + 1.2,
            opening=AFTER["opening"] * 0.05 + 1.2,
            flow=AFTER["flow"] * 0.05 + 3.0 * AFTER["flow"].max(),
        ),
        "the opening is nowhere where the history has been",
    ),
}


@pytest.mark.parametrize(("recording", "words"), HELD_AGAINST.values(), ids=HELD_AGAINST)
def test_a_recording_that_a_history_does_not_belong_to(learnt, recording, words):
    assert words in sentence(lambda: require_compatible(learnt, recording))


def test_a_stem_elsewhere_at_a_flow_that_was_met_is_no_wrong_use(learnt):
    # a trim that has worn, in a closed loop: against the history's flow the sheet's trim says what is wrong
    moved = changed(AFTER, command=AFTER["command"] * 0.05 + 1.2, opening=AFTER["opening"] * 0.05 + 1.2)
    require_compatible(learnt, moved)


def test_a_history_of_fewer_signals(before):
    history = ValveHistory().fit(without(before, "opening"))
    words = sentence(lambda: require_compatible(history, AFTER))
    assert words == (
        "plant/after.csv holds opening, which the history lacks; learn the history with it, or leave it out "
        "of the recording"
    )


def test_a_history_of_the_future(learnt):
    of_may = copy.deepcopy(learnt)
    (own,) = of_may.recordings_
    of_may.recordings_ = [replace(own, first="2026-05-01T00:00:00", last="2026-05-01T00:19:59")]
    require_compatible(of_may, dated(AFTER, "2026-05-02"))
    words = sentence(lambda: require_compatible(of_may, dated(AFTER, "2026-04-01")))
    assert "begins at 2026-04-01T00:00:00, before data frame of the history ends at 2026-05-01" in words
    # and of the same hours, recorded otherwise
    assert "must be older" in sentence(lambda: require_compatible(of_may, dated(AFTER, "2026-05-01")))
    # a clock without an offset cannot be compared with one that has it
    require_compatible(of_may, dated(AFTER, "2026-04-01", "+00:00"))


def test_one_that_has_learnt_nothing():
    words = sentence(lambda: require_compatible(ValveHistory(), AFTER))
    assert (
        words == "the history given has learnt nothing yet; call its fit with recordings of the valve first"
    )


def test_what_belongs_to_it_is_let_through(learnt):
    require_compatible(learnt, AFTER)
    # units, columns and what no stage asks for may differ; so may a flow, which a fault may change altogether
    require_compatible(learnt, replace(AFTER, valve=replace(AFTER.valve, roles={}, time="t")))
    require_compatible(learnt, changed(AFTER, setpoint=np.ones(1200)))
    require_compatible(learnt, changed(AFTER, flow=AFTER["flow"] + 1.0))
    require_compatible(learnt, changed(AFTER, opening=np.full(1200, 1.3)))


@pytest.mark.parametrize(
    ("history", "recording", "words"),
    [
        ([], AFTER, "the list is empty"),
        (ValveHistory(), AFTER, "the history given has learnt nothing yet"),
        (ValveHistory(), without(AFTER, *LOOP), "or diagnose it without a history"),
        ([BEFORE.slice(0, 300)], AFTER, "of 300 rows is too short"),
        ([AFTER], AFTER, "the history holds rows of this recording"),
        ([BEFORE], of_sheet(AFTER, travel=0.05), "gives travel as 0.05"),
    ],
    ids=["nothing", "not fitted", "a loop", "too short", "itself", "another valve"],
)
def test_the_finder_refuses_them_too(history, recording, words):
    finder = MissingPhysicsFinder(max_effects=0, history=history)
    assert words in sentence(lambda: finder.fit(recording))
    assert not hasattr(finder, "diagnosis_")


@pytest.mark.parametrize("history", ["before.history.skops", 3, {"a": 1}])
def test_what_is_no_history_is_no_parameter(history):
    with pytest.raises(ValueError, match="'history' parameter of MissingPhysicsFinder must be"):
        MissingPhysicsFinder(history=history).fit(AFTER)
