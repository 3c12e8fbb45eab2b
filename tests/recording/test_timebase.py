# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pandas as pd
import pytest

from sklvalve.recording import InputError, Recording
from sklvalve.recording.timebase import read_time


def recording_at(times):
    return Recording.from_frame({"time": times, "flow": np.linspace(1.0, 2.0, len(times))})


def test_seconds_count_from_the_first_sample_and_missing_rows_stay_missing():
    base = read_time([10.0, 11.0, 15.0], "t")
    np.testing.assert_array_equal(base.seconds, [0.0, 1.0, 5.0])
    np.testing.assert_array_equal(base.stamps, [10.0, 11.0, 15.0])


@pytest.mark.parametrize(
    "stamps",
    [
        ["2024-06-28 14:35:00", "2024-06-28 14:35:01.5", "2024-06-28T14:36"],
        ["2024-06-28T14:35:00Z", "2024-06-28T14:35:01.500000Z", "2024-06-28T14:36:00Z"],
        ["2024-06-28T14:35:00+02:00", "2024-06-28T12:35:01.5Z", "2024-06-28T13:36:00+01:00"],
    ],
)
def test_iso_stamps(stamps):
    base = read_time(stamps, "t")
    np.testing.assert_allclose(base.seconds, [0.0, 1.5, 60.0], rtol=0, atol=1e-9)
    assert list(base.stamps) == stamps


@pytest.mark.parametrize("zone", [None, "Europe/Berlin"])
def test_dates_of_a_data_frame(zone):
    index = pd.date_range("2024-03-31", periods=5, freq="h", tz=zone)  # the clocks change in this night
    frame = pd.DataFrame({"flow": np.arange(5.0)}, index=index)
    recording = Recording.from_frame(frame)
    np.testing.assert_array_equal(recording.time, 3600.0 * np.arange(5))
    assert recording.index_until(str(recording.stamps[2])) == 3


def test_numbers_as_text_are_seconds():
    np.testing.assert_array_equal(read_time(["3", "4", "6.5"], "t").seconds, [0.0, 1.0, 3.5])


@pytest.mark.parametrize(
    ("stamps", "words"),
    [
        (
            ["2024-01-01T00:00", "2024-01-01T00:01Z"],
            ["t, row 2", "'2024-01-01T00:01Z' has an offset", "unlike row 1"],
        ),
        (["2024-01-01T00:00Z", "2024-01-01T00:01"], ["t, row 2", "has no offset"]),
        (["2024-01-01T00:00", "01.02.2024 00:01"], ["t, row 2", "ISO 8601", "day and month"]),
        (["2024-01-01T00:00", "soon"], ["t, row 2", "'soon' is no time"]),
        (["2024-01-01T00:00", None], ["t, row 2", "missing"]),
        (["2024-01-01T02:59", "2024-01-01T02:00"], ["t, row 2", "comes after", "clocks"]),
        (["2024-01-01T02:00", "2024-01-01T02:00"], ["t, row 2", "stands twice"]),
        ([1.0, "two"], ["t, row 2", "'two' is no number; correct the time or drop the row"]),
        ([1.0, np.inf], ["t, row 2", "infinite"]),
        ([1.0, 1.0], ["t, row 2", "stands twice"]),
        ([2.0, 1.0], ["t, row 2", "time 1 comes after 2"]),
    ],
)
def test_bad_times(stamps, words):
    with pytest.raises(InputError) as caught:
        read_time(np.array(stamps, dtype=object), "t")
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_until_and_after_in_the_files_own_seconds():
    recording = recording_at(np.arange(101.0, 111.0))
    assert recording.index_until(105) == 5
    assert recording.index_until("105.5") == 5
    assert recording.index_until(3.0) == 0
    early, late = recording.until(105), recording.after(105)
    assert (len(early), len(late)) == (5, 5)
    assert late.stamps[0] == 106.0
    assert late.time[0] == 5.0, "the clock of the whole recording goes on"
    assert late.index_until(108) == 3
    np.testing.assert_array_equal(np.concatenate([early["flow"], late["flow"]]), recording["flow"])


def test_until_includes_the_row_of_a_printed_stamp():
    recording = recording_at(np.arange(30) * 0.1)
    for row, stamp in enumerate(recording.stamps):
        assert recording.index_until(f"{stamp:.10g}") == row + 1


def test_until_in_iso():
    stamps = [f"2024-06-28T14:35:{second:02d}" for second in range(10)]
    recording = recording_at(np.array(stamps, dtype=object))
    assert recording.index_until("2024-06-28 14:35:03") == 4
    for value in (3.0, "3", "tomorrow"):
        with pytest.raises(InputError, match="give one like '2024-06-28T14:35:00'"):
            recording.index_until(value)
    with pytest.raises(InputError, match="offset"):
        recording.index_until("2024-06-28T14:35:03Z")


@pytest.mark.parametrize("value", ["noon", None, np.nan])
def test_no_time_of_a_recording_in_seconds(value):
    with pytest.raises(InputError, match=r"a number of seconds like 0$"):
        recording_at(np.arange(5.0)).index_until(value)


@pytest.mark.parametrize("value", [True, np.False_, b"2024"])
@pytest.mark.parametrize("times", [[0.0, 1.0], ["2024-06-28T00:00Z", "2024-06-28T00:01Z"]])
def test_truths_and_bytes_are_no_times(times, value):
    with pytest.raises(InputError, match="is no time; give one like"):
        recording_at(times).until(value)


def test_nothing_left():
    recording = recording_at(np.arange(5.0))
    with pytest.raises(InputError, match="no row stands at or before time -1; give a time between"):
        recording.until(-1)
    with pytest.raises(InputError, match="no row stands after time 4; give a time between"):
        recording.after(4)
