# SPDX-License-Identifier: BSD-3-Clause
"""The stamp of the first sample, where all times are of one clock."""

import numpy as np

from sklvalve.recording import Recording, join_recordings
from sklvalve.recording.calendar_time import begins_of, first_stamp


def _recording(first, n=20, **columns):
    time = np.arange(float(n)) if first is None else np.datetime64(first, "s") + np.arange(n)
    command = {"command": np.linspace(0.1, 0.9, n)} | columns
    return Recording.from_frame({"time": time} | command)


def test_a_recording_with_stamps_has_a_first_one():
    assert first_stamp(_recording("2024-05-01T06:00:00")).startswith("2024-05-01T06:00:00")
    assert begins_of(_recording("2024-05-01T06:00:00"))["begins"].startswith("2024-05-01T06:00:00")


def test_seconds_have_no_calendar():
    assert first_stamp(_recording(None)) is None
    assert begins_of(_recording(None)) == {}


def test_joined_recordings_have_the_calendar_of_the_first_where_they_have_one():
    late, early = _recording("2024-05-02T06:00:00"), _recording("2024-05-01T06:00:00")
    assert first_stamp(join_recordings([late, early])).startswith("2024-05-01T06:00:00")
    other = _recording(None, flow=np.linspace(0.01, 0.02, 20))
    assert first_stamp(join_recordings([_recording(None, flow=np.linspace(0.02, 0.01, 20)), other])) is None
