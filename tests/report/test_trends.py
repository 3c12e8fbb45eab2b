# SPDX-License-Identifier: BSD-3-Clause
"""What the page's script is given: exact enough, small, and no peak lost."""

import json
from base64 import b64decode

import numpy as np
import pytest

from sklvalve.report.trends import trends
from tests.report import examples


def _times(told):
    return np.frombuffer(b64decode(told["time"]), dtype="<f4")


def _values(course):
    codes = np.frombuffer(b64decode(course["codes"]), dtype="<u2")
    values = course["low"] + (course["high"] - course["low"]) * codes / 65534.0
    return np.where(codes == 65535, np.nan, values)


def test_a_short_recording_keeps_every_row():
    traces = examples.traces(3000)
    told = json.loads(json.dumps(trends(traces), allow_nan=False))
    np.testing.assert_array_equal(_times(told), np.arange(3000.0))
    assert [[course["name"] for course in panel] for panel in told["charts"]["recording"]] == [
        ["opening", "command"],
        ["flow"],
        ["outlet pressure", "inlet pressure"],
    ]
    flow = _values(told["charts"]["recording"][1][0])
    recorded = traces["recorded"]["flow"]
    step = np.ptp(recorded[np.isfinite(recorded)]) / 65534.0
    np.testing.assert_array_equal(np.isnan(flow), np.isnan(recorded))
    assert np.nanmax(np.abs(flow - recorded)) <= 0.51 * step
    constant = told["charts"]["recording"][2][0]
    np.testing.assert_allclose(_values(constant), 200.0)
    before, after = (_values(course) for course in told["charts"]["residual"][1])
    assert np.nanstd(after) < 0.5 * np.nanstd(before)


def test_a_long_recording_keeps_the_peaks_of_each_bucket():
    traces = examples.traces(86_400)
    traces["recorded"]["flow"][50_001] = 900.0
    told = trends(traces)
    times, flow = _times(told), _values(told["charts"]["recording"][1][0]).reshape(-1, 2)
    assert len(times) == len(flow) == 4000
    assert (flow[:, 1] >= flow[:, 0])[~np.isnan(flow[:, 0])].all()
    peak = np.nanargmax(flow[:, 1])
    assert flow[peak, 1] == pytest.approx(900.0)
    assert times[peak] <= 50_001 / 3600.0 < times[peak + 1], "told in hours"
    assert told["end"] == pytest.approx(86_399 / 3600.0)
    assert len(json.dumps(told)) < 600_000


def test_flagged_times_recordings_and_rows_used_are_told_in_the_unit_of_the_clock():
    traces = examples.traces(3000) | {"begins": [0, 1000]}
    told = trends(traces)
    assert told["unit"] == "s"
    assert told["until"] == 2400.0
    assert told["begins"] == [1000.0]
    shaded = np.any([(_times(told) >= low) & (_times(told) <= high) for low, high in told["flagged"]], axis=0)
    assert shaded[traces["flagged"]].all()
    assert trends(traces | {"until": None, "flagged": np.zeros(3000, dtype=bool)})["flagged"] == []


def test_nothing_simulated_leaves_no_residual():
    traces = examples.traces(300) | {"nominal": {}, "corrected": {}}
    assert set(trends(traces)["charts"]) == {"recording"}


def test_a_signal_of_gaps_only_is_no_error():
    traces = examples.traces(300)
    traces["recorded"]["flow"] = np.full(300, np.nan)
    assert np.isnan(_values(trends(traces)["charts"]["recording"][1][0])).all()
