# SPDX-License-Identifier: BSD-3-Clause
"""A history as plain data: everything comes back, and what no history has is refused."""

import copy
import re

import numpy as np
import pytest

from sklvalve.history import Allowance, ValveHistory
from sklvalve.history.state import PARTS, require_sound_history
from sklvalve.simulation import Tolerance
from tests.history.plant import without


def assert_alike(one, other):
    np.testing.assert_array_equal(one.prior_.mean, other.prior_.mean)
    np.testing.assert_array_equal(one.prior_.covariance, other.prior_.covariance)
    assert one.prior_.names == other.prior_.names
    assert one.values_ == other.values_
    assert one.spans_ == other.spans_
    assert (one.roles_, one.mass_flow_) == (other.roles_, other.mass_flow_)
    assert [g.channels for g in one._groups_] == [g.channels for g in other._groups_]
    assert [g.parameters for g in one._groups_] == [g.parameters for g in other._groups_]
    assert (one.rows, one.days, len(one.windows_)) == (other.rows, other.days, len(other.windows_))
    assert [w.begins for w in one.windows_] == [w.begins for w in other.windows_]
    for channel in one.windows_[0].noise:
        assert one.noise_parts(channel) == other.noise_parts(channel)
    for mine, theirs in zip(one.recordings_, other.recordings_, strict=True):
        assert (mine.name, mine.sha256, mine.rows) == (theirs.name, theirs.sha256, theirs.rows)
        np.testing.assert_array_equal(mine.marks, theirs.marks)
    assert one.range_.limits() == other.range_.limits()


def test_everything_comes_back(learnt, after):
    history = copy.deepcopy(learnt).update(after)
    state = history.to_state()
    require_sound_history(state, ())
    assert set(state) == set(PARTS)
    back = ValveHistory.from_state(history.valve_, state)
    assert_alike(history, back)
    # and it goes on as the first would
    np.testing.assert_array_equal(back.trim_.table(back.values_), history.trim_.table(history.values_))


def test_settings_come_back(before):
    tolerance, allowance = Tolerance(capacity=0.07), Allowance(flow_zero=0.002)
    history = ValveHistory(tolerance=tolerance, allowance=allowance).fit(before)
    back = ValveHistory.from_state(history.valve_, history.to_state())
    assert (back.tolerance, back.allowance) == (tolerance, allowance)
    # the trim's own parameters are within the tolerance that the history was given
    assert back.trim_.capacity == history.trim_.capacity
    assert_alike(history, back)


def test_a_trim_that_was_learnt_comes_back(before):
    history = ValveHistory().fit(without(before, "p1", "p2", "temperature"))
    state = history.to_state()
    require_sound_history(state, ())
    back = ValveHistory.from_state(history.valve_, state)
    np.testing.assert_array_equal(back.trim_.knots, history.trim_.knots)
    assert_alike(history, back)


def test_a_history_that_was_read_back_learns_on(learnt, after):
    back = ValveHistory.from_state(learnt.valve_, learnt.to_state()).update(after)
    assert_alike(back, copy.deepcopy(learnt).update(after))


def _put(*keys):
    *inner, last, value = keys

    def change(state):
        node = state
        for key in inner:
            node = node[key]
        node[last] = value(node[last]) if callable(value) else value

    return change


def _first_bent(hessians):
    bent = hessians.copy()
    bent[0] -= 1e9 * np.eye(len(bent[0]))
    return bent


def _uneven(hessians):
    uneven = hessians.copy()
    uneven[0, 0, 1] += 1e6
    return uneven


FIRST = ("calibration", "groups", 0, "parameters", 0)
LIES = {
    "a part is gone": (_put("windows", None), "windows is missing"),
    "NaN tolerance": (_put("settings", "tolerance", {"capacity": np.nan}), "capacity of the tolerance"),
    "negative allowance": (_put("settings", "allowance", {"trim": -1.0}), "trim of the allowance"),
    "unknown setting": (_put("settings", "allowance", {"x": 1.0}), "the allowance holds what is none"),
    "effects that were not given": (_put("settings", "effects", ["stiction"]), "effects are others"),
    "onset of nothing": (_put("settings", "onsets", {"stiction": 3.0}), "belongs to no effect"),
    "NaN value": (_put("calibration", "values", "capacity", np.nan), "capacity is out of range"),
    "no signals": (_put("calibration", "roles", []), "signals are none"),
    "unknown signal": (_put("calibration", "roles", ["os.system"]), "signals are none"),
    "no kind of flow": (_put("calibration", "mass_flow", 1), "neither mass nor volume"),
    "negative span": (_put("calibration", "spans", "flow", -1.0), "the span of flow is out of range"),
    "no groups": (_put("calibration", "groups", []), "no groups of signals"),
    "group of a pressure": (_put("calibration", "groups", 0, "channels", ["p1"]), "that it lacks"),
    "one channel twice": (_put("calibration", "groups", 0, "channels", ["flow"] * 2), "that it lacks"),
    "no parameters": (_put("calibration", "groups", 0, "parameters", []), "a group has no parameters"),
    "parameter of more": (_put(*FIRST, lambda p: p | {"joint": 1}), "a parameter is none"),
    "parameter without a name": (_put(*FIRST, "name", "x y"), "a parameter has no name"),
    "infinite bound": (_put(*FIRST, "high", np.inf), "high of capacity is out of range"),
    "bounds exchanged": (_put(*FIRST, "high", 1.0), "the bounds of capacity are none"),
    "no spread": (_put(*FIRST, "spread", 0.0), "the spread of capacity"),
    "parameter twice": (_put(*FIRST, "name", "trim_0"), "stands twice"),
    "no windows": (_put("windows", "begins", []), "no windows"),
    "too few rows": (_put("windows", "rows", np.zeros(2, int)), "rows of the windows has the wrong shape"),
    "empty window": (_put("windows", "rows", np.zeros(1, int)), "a window has no rows"),
    "time runs back": (_put("windows", "seconds", np.array([-1.0])), "a window runs back"),
    "no information": (_put("windows", "information", []), "say nothing of some signals"),
    "Hessian of another size": (
        _put("windows", "information", 0, "hessian", lambda h: h[:, :3, :3]),
        "a Hessian has the wrong shape",
    ),
    "Hessian of texts": (_put("windows", "information", 0, "hessian", [["x"]]), "no array of numbers"),
    "Hessian without symmetry": (_put("windows", "information", 0, "hessian", _uneven), "not symmetric"),
    "Hessian that bends down": (_put("windows", "information", 0, "hessian", _first_bent), "bends down"),
    "infinite pull": (_put("windows", "information", 0, "pull", lambda p: p + np.inf), "a pull holds values"),
    "negative rest": (_put("windows", "left", "flow", np.array([-1.0])), "left of the flow is below 0"),
    "noise without size": (
        _put("windows", "noise", "flow", "size", np.zeros(1)),
        "size of the noise of the flow is out of range",
    ),
    "noise gone": (_put("windows", "noise", "flow", None), "flow is missing"),
    "no recordings": (_put("recordings", "each", []), "names no recordings"),
    "checksum that is none": (
        _put("recordings", "each", 0, "sha256", "../x"),
        "the checksum of a recording is none",
    ),
    "time that is none": (
        _put("recordings", "each", 0, lambda each: each | {"first": "noon", "last": "noon"}),
        "the time of a recording is none",
    ),
    "times of two kinds": (_put("recordings", "each", 0, "first", "2026-01-01"), "are of two kinds"),
    "marks of floats": (_put("recordings", "marks", np.zeros(3)), "marks of its rows are none"),
    "marks miscounted": (_put("recordings", "counts", np.array([7])), "miscounted"),
    "range of nothing": (_put("range", "x", {}), "a range is of no signal"),
    "range in odd bins": (_put("range", "flow", "step", 0.3), "no width that can be joined"),
    "range out of order": (_put("range", "flow", "bins", lambda b: b[::-1]), "do not rise"),
    "range without rows": (_put("range", "flow", "rows", lambda r: r * 0), "do not rise"),
}


@pytest.mark.parametrize(("change", "words"), LIES.values(), ids=LIES)
def test_a_lie_is_refused(learnt, change, words):
    state = copy.deepcopy(learnt.to_state())
    change(state)
    with pytest.raises(ValueError, match=re.escape(words)):
        require_sound_history(state, ())


@pytest.mark.parametrize("state", [None, [], {}, {"settings": 3}])
def test_no_state_at_all(state):
    with pytest.raises(ValueError, match="settings is missing"):
        require_sound_history(state, ())
