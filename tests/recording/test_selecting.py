# SPDX-License-Identifier: BSD-3-Clause
"""Rows of a recording by time, as pandas and xarray cut them: both ends belong to the part."""

from datetime import date, datetime, timedelta

import numpy as np
import pandas as pd
import pytest

from sklvalve.recording import InputError, Recording, join_recordings


def counted(start=100.0, n=10):
    return Recording.from_frame({"time": start + np.arange(float(n)), "command": np.linspace(0.0, 1.0, n)})


def dated(zone=""):
    times = [f"2024-06-{day} {hour:02}:00{zone}" for day in (28, 29) for hour in range(0, 24, 6)]
    return Recording.from_frame({"time": times, "command": np.linspace(0.0, 1.0, len(times))})


@pytest.mark.parametrize("start", [None, 102.0, 101.5])
@pytest.mark.parametrize("stop", [None, 105.0, 105.5])
def test_numbers_cut_as_pandas_does(start, stop):
    recording = counted()
    frame = pd.DataFrame({"command": recording["command"]}, index=recording.stamps)
    part = recording[start:stop]
    np.testing.assert_array_equal(part["command"], frame.loc[start:stop, "command"])
    np.testing.assert_array_equal(recording.between(start, stop)["command"], part["command"])
    assert part.time[0] == part.stamps[0] - 100.0


ENDS = [None, "2024-06-28 12:00", "2024-06-28T13", "2024-06-29", "2024-06-28T11:59:59"]


@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", [*ENDS, "2024-06-28T18:00:00"])
def test_dates_cut_as_pandas_does(start, stop):
    recording = dated()
    frame = pd.DataFrame({"command": recording["command"]}, index=pd.to_datetime(recording.stamps))
    # pandas takes an hour as the whole of it, and here only a day is one
    expected = frame.loc[start : stop if stop != "2024-06-28T13" else f"{stop}:00"]
    if not len(expected):
        with pytest.raises(InputError, match=r"no row stands between|is after"):
            recording[start:stop]
        return
    np.testing.assert_array_equal(recording[start:stop]["command"], expected["command"])


def test_a_day_is_whole_and_the_next_midnight_is_none_of_it():
    recording = dated()
    assert len(recording[:"2024-06-28"]) == 4
    assert len(recording["2024-06-29":"2024-06-29"]) == 4
    assert len(recording[: date(2024, 6, 28)]) == 4
    assert len(recording[: datetime(2024, 6, 28)]) == 1


def test_times_as_objects():
    recording = dated("+02:00")
    stamp = pd.Timestamp("2024-06-28 06:00", tz="Europe/Berlin")
    assert len(recording[stamp : stamp + timedelta(hours=6)]) == 2
    assert len(recording["2024-06-28T04:00Z":"2024-06-28T10:00Z"]) == 2
    assert len(dated()[np.datetime64("2024-06-29T00:00") :]) == 4
    differences = Recording.from_frame(
        pd.DataFrame({"command": np.linspace(0.0, 1.0, 5)}, index=pd.to_timedelta(range(5), unit="min"))
    )
    assert len(differences[timedelta(minutes=1) : pd.Timedelta(minutes=2)]) == 2
    assert len(differences[: np.timedelta64(1, "m")]) == 2


def test_parts_of_parts_keep_the_clock():
    part = counted()[102.0:108.0]
    np.testing.assert_array_equal(part[104.0:105.0].stamps, [104.0, 105.0])
    np.testing.assert_array_equal(part[104.0:105.0].time, [4.0, 5.0])


def test_of_joined_recordings_with_one_clock():
    both = join_recordings([counted(), counted(200.0)])
    np.testing.assert_array_equal(both[108.0:201.0].stamps, [108.0, 109.0, 200.0, 201.0])


def test_roles_stay_what_they_were():
    recording = counted()
    assert recording["command"] is recording.signals["command"]
    with pytest.raises(InputError, match="'pressure' is no role"):
        recording["pressure"]


@pytest.mark.parametrize(
    ("cut", "words"),
    [
        (slice(2, 5), r"\[2:5\] could mean rows or seconds; write between"),
        (slice(None, np.int64(5)), "could mean rows or seconds"),
        (slice(2.0, 5.0, 2), "has no step"),
        (slice(300.0, None), "no row stands between 300.0 and its end; give a time between 100.0 and 109.0"),
        (slice(105.0, 103.0), "105.0 is after 103.0; give the earlier time first"),
        (slice(103.2, 103.8), "no row stands between 103.2 and 103.8"),
        (slice("2024-06-28", None), "'2024-06-28' is no time of this recording; give a number of seconds"),
        (slice(float("nan"), None), "nan is no time of this recording"),
        (slice(b"105", None), "b'105' is no time; give one like 100.0"),
    ],
)
def test_what_is_no_part_is_told(cut, words):
    with pytest.raises(InputError, match=words):
        counted()[cut]


def test_a_time_without_the_offset_of_the_recording_is_told():
    with pytest.raises(InputError, match="differ in having an offset from UTC; give one like"):
        dated("+02:00")["2024-06-28 06:00":]


def test_what_is_asked_otherwise_is_told():
    with pytest.raises(InputError, match="asked for one role, such as 'flow', or for times"):
        counted()[["command", "flow"]]
    with pytest.raises(InputError, match=r"has no row \[0\] of its own; write slice\(0, 1\)"):
        counted()[0]
    with pytest.raises(InputError, match=r"write slice\(-1, None\) for that row"):
        counted()[-1]
    with pytest.raises(InputError, match="asked for one role"):
        counted()[True]
    for start, stop in ((0.5, 2), ("a", None), (True, 3)):
        with pytest.raises(InputError, match=r"is no count of rows; give whole numbers, or write between"):
            counted().slice(start, stop)
    with pytest.raises(InputError, match="there are no rows to be cut"):
        counted().slice(3, 1).between(100.0, 105.0)


def test_the_rest_of_a_day_ends_with_that_day():
    part = dated()["2024-06-28 12:00":"2024-06-28"]
    assert [str(stamp)[11:16] for stamp in part.stamps] == ["12:00", "18:00"]
