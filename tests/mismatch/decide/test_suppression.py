# SPDX-License-Identifier: BSD-3-Clause
"""What the data may have made is not called missing physics."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.decide.suppression import suppressed
from sklvalve.recording import Recording, Valve

# a drop of 2 bar, 72 m3/h
HELD = {"p1": np.full(9, 5e5), "p2": np.full(9, 3e5), "flow": np.full(9, 0.02)}
FEW = ["seat_leakage", "clogging", "capacity_error"]


def judged(verdict, channel=None):
    rest = None if channel is None else SimpleNamespace(channel=channel)
    found = ["what was found"] if verdict == "named" else []
    tried = None if rest is None else "blocks"
    return Judgement("problem", verdict, 1e-6, found, rest, "nominal", "model", tried, rest is not None)


def finding(name, role, **more):
    return {"finding": name, "role": role, "detail": "", "rows": None, **more}


@pytest.mark.parametrize(
    ("verdict", "channel", "data"),
    [
        ("none_of_these", "flow", [finding("compressed", "flow")]),
        ("none_of_these", "flow", [finding("compressed", "p1")]),
        ("none_of_these", "flow", [finding("compressed", "p1", size=5000.0)]),
        ("none_of_these", "flow", [finding("compressed", "flow", size=3e-4)]),
        ("none_of_these", "flow", [finding("compressed", "opening", size=0.006)]),
        ("none_of_these", "opening", [finding("compressed", "opening")]),
        ("cannot_tell", None, [finding("compressed", "opening")]),
        ("cannot_tell", None, [finding("quantised", "opening", size=0.01)]),
    ],
)
def test_nothing_is_claimed(verdict, channel, data):
    silent, reason = suppressed(judged(verdict, channel), data, HELD)
    assert (silent.verdict, silent.p_value, silent.detected) == ("cannot_tell", None, False)
    assert (silent.unknown, silent.correction, silent.findings, silent.model) == (None, None, [], "nominal")
    assert data[0]["role"] in reason


@pytest.mark.parametrize(
    ("verdict", "channel", "data"),
    [
        ("none_of_these", "flow", []),
        ("none_of_these", "opening", [finding("compressed", "flow")]),
        ("none_of_these", "opening", [finding("compressed", "opening", size=0.003)]),
        ("none_of_these", "flow", [finding("compressed", "flow", size=1e-4)]),
        ("none_of_these", "flow", [finding("compressed", "p1", size=3000.0)]),
        ("none_of_these", "flow", [finding("compressed", "opening", size=0.003)]),
        ("cannot_tell", None, [finding("compressed", "flow", size=1e-4)]),
        ("none_of_these", "opening", [finding("quantised", "opening", size=0.01)]),
        ("cannot_tell", None, [finding("quantised", "opening", size=0.001)]),
        ("cannot_tell", None, [finding("compressed", "temperature")]),
        ("no_mismatch", None, [finding("compressed", "flow")]),
        ("named", None, [finding("compressed", "flow")]),
        ("named", "opening", [finding("compressed", "flow")]),
    ],
)
def test_what_the_data_cannot_have_made_stays(verdict, channel, data):
    judgement = judged(verdict, channel)
    assert suppressed(judgement, data, HELD) == (judgement, None)


def test_name_stays_where_the_rest_goes():
    kept, reason = suppressed(judged("named", "flow"), [finding("compressed", "flow")], HELD)
    assert (kept.verdict, kept.findings, kept.unknown, kept.tried, reason) == (
        "named",
        ["what was found"],
        None,
        None,
        None,
    )


@pytest.mark.parametrize("channel", ["flow", "opening"])
def test_what_differs_beside_a_name_goes_where_a_historian_may_have_made_it(channel):
    named = replace(judged("named"), also=SimpleNamespace(channel=channel))
    kept, _ = suppressed(named, [finding("compressed", "flow")], HELD)
    assert kept.verdict == "named"
    assert (kept.also is None) is (channel == "flow")


@pytest.mark.slow
def test_flow_redrawn_by_lines_is_no_unknown_effect():
    made = make_valve_recording(random_state=71057, loop="closed", n_samples=2880, n_later=0)
    frame = made.frame.copy()
    flow, kept = frame["F"].to_numpy(), [0]
    for row in range(1, len(flow)):
        if abs(flow[row] - flow[kept[-1]]) > 0.03 * made.valve["valve"]["kv_rated"]:
            kept.append(row)
    frame["F"] = np.round(np.interp(np.arange(len(flow)), kept, flow[kept]), 3)
    recording = Recording.from_frame(frame, Valve.from_dict(made.valve))
    content = MissingPhysicsFinder(effects=FEW).fit(recording).diagnosis_.content
    assert ("compressed", "flow") in {(d["finding"], d["role"]) for d in content["data"]}
    assert content["verdict"] == "cannot_tell"
    assert content["mismatch"] == {"detected": False, "p_value": None, "alpha": 0.01}
    assert content["next_test"].startswith("The recording differs from the simulation, but the historian's")
    assert content["effects"] == []
    assert "unknown" not in content


def test_a_band_of_a_pressure_is_not_known_where_nothing_tells_the_drop():
    data = [finding("compressed", "p1", size=3000.0)]
    silent, reason = suppressed(judged("none_of_these", "flow"), data, {"p1": HELD["p1"]})
    assert silent.verdict == "cannot_tell"
    assert "p1" in reason


@pytest.mark.parametrize(
    ("data", "stays"),
    [
        (finding("quantised", "flow", size=1e-3), True),
        (finding("compressed", "opening", size=0.003), True),
        (finding("compressed", "flow", size=3e-4), False),
    ],
)
def test_pulses_stay_unless_a_historian_may_have_made_them(data, stays):
    told = replace(judged("none_of_these"), pulses=SimpleNamespace(channel="flow"))
    kept, reason = suppressed(told, [data], HELD)
    assert (kept.pulses is not None, kept.verdict == "none_of_these", reason is None) == (stays, stays, stays)
