# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from benchmarks.concealed.methods import METHODS, method, public
from benchmarks.concealed.methods.rows import overlap, spans_of, told_rows
from sklvalve.recording import InputError, Recording


def recording():
    opening = np.concatenate([np.linspace(0.1, 0.9, 50), np.linspace(0.9, 0.1, 50)])
    frame = {
        "time": np.arange(100.0),
        "command": opening,
        "opening": opening,
        "p1": np.full(100, 6e5),
        "p2": np.linspace(5e5, 1e5, 100),
        "flow": 1e-3 * opening,
    }
    return Recording.from_frame(frame)


def content(regions=(), intervals=((0.0, 99.0),)):
    return {"location": {"regions": list(regions), "intervals": [list(i) for i in intervals]}}


def region(signal, low, high, direction=None, **more):
    return {"signal": signal, "low": low, "high": high, "direction": direction, **more}


def test_without_regions_all_rows_of_the_intervals_are_told():
    rows = told_rows(content(intervals=((10.0, 19.0), (50.0, 50.0))), recording(), np.arange(100.0))
    assert spans_of(rows) == [[10, 20], [50, 51]]


def test_a_region_is_a_box_within_the_intervals():
    made = recording()
    box = region("opening", 0.5, 1.0, **{"and": region("dp", 2e5, 4e5)})
    rows = told_rows(content([box]), made, np.arange(100.0))
    dp = made["p1"] - made["p2"]
    expected = (made["opening"] >= 0.5) & (dp >= 2e5) & (dp <= 4e5)
    assert np.array_equal(rows, expected)
    assert 0 < expected.sum() < 100


def test_a_direction_keeps_its_half_of_a_triangle():
    rows = told_rows(content([region("opening", 0.0, 1.0, "closing")]), recording(), np.arange(100.0))
    assert rows[52:].all()
    assert not rows[:50].any()


def test_a_flow_region_needs_no_opening():
    made = recording()
    signals = {role: made[role] for role in ("flow",)}
    bare = Recording.from_frame({"time": np.arange(100.0), **signals})
    rows = told_rows(content([region("flow", 0.5e-3, 1e-3)]), bare, np.arange(100.0))
    assert np.array_equal(rows, made["flow"] >= 0.5e-3)


def test_spans_and_overlap():
    rows = np.array([True, False, True, True])
    assert spans_of(rows) == [[0, 1], [2, 4]]
    assert spans_of(np.zeros(3, dtype=bool)) == []
    assert overlap(rows, np.array([False, False, True, False])) == pytest.approx(1.0 / 3.0, abs=1e-12)
    assert overlap(~rows & rows, ~rows & rows) == 0.0


def test_methods_are_found_by_name():
    assert all(callable(method(name)) for name in METHODS)
    with pytest.raises(ValueError, match="expected one of the methods"):
        method("guess")


def test_what_is_public_is_plain_data():
    found = {"verdict": "named", "simulate": len, "flagged": np.zeros(2), "boxes": np.zeros(2)}
    assert public(found) == {"verdict": "named"}


def test_baselines_refuse_what_no_simulation_is_judged_by():
    bare = Recording.from_frame({"time": np.arange(300.0), "flow": np.ones(300)})
    for name in ("stepwise_bic", "sparse_regression"):
        with pytest.raises(InputError):
            method(name)(bare)
