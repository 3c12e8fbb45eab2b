# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of one valve, joined: their order, their clock, and what cannot be joined."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.data_defects import box_car
from sklvalve.recording import InputError, Recording, Valve, join_recordings, screen_recording
from tests.recording.planted import healthy, planted


def _recording(n=60, *, start=0.0, valve=None, **signals):
    time = start + np.arange(float(n))
    columns = {"command": 0.5 + 0.2 * np.sin(time / 7), "flow": 0.01 + 0.001 * np.sin(time / 7)} | signals
    return replace(Recording.from_frame({"time": time, **columns}, valve), source=f"{start:.0f}.csv")


def _dated(first, n=10):
    stamps = np.datetime64(first, "s") + np.arange(n)
    return replace(Recording.from_frame({"time": stamps, "command": np.linspace(0, 1, n)}), source=first)


def test_one_recording_stays_as_it_is():
    one = _recording()
    assert join_recordings([one]) is one
    assert one.spans == [(0, 60)]


def test_times_that_follow_each_other_keep_their_distance_and_are_put_in_order():
    late, early = _recording(start=500.0), _recording(start=100.0)
    joined = join_recordings([late, early])
    assert [piece.source for piece in joined.pieces] == ["100.csv", "500.csv"]
    assert [piece.begins for piece in joined.pieces] == [0.0, 400.0]
    np.testing.assert_array_equal(joined.time[[0, 59, 60, 119]], [0.0, 59.0, 400.0, 459.0])
    np.testing.assert_array_equal(joined["flow"][60:], late["flow"])
    assert joined.spans == [(0, 60), (60, 120)]


def test_clocks_that_begin_anew_are_put_an_hour_apart_in_the_order_given():
    one, other = _recording(), _recording(40, flow=np.linspace(0.01, 0.02, 40))
    joined = join_recordings([one, other])
    np.testing.assert_allclose(np.diff(joined.time)[59], 3600.0)
    assert joined.spans == [(0, 60), (60, 100)]
    # a time is one of the last recording
    assert joined.index_until(9.0) == 70
    assert joined.slice(70, None).spans == [(0, 30)]


def test_dates_tell_the_distance():
    joined = join_recordings([_dated("2024-05-02T00:00:00"), _dated("2024-05-01T00:00:00")])
    assert joined.pieces[1].begins == 86_400.0
    assert joined.index_until("2024-05-02T00:00:03") == 14
    assert joined.index_until("2024-05-01T00:00:03") == 4


@pytest.mark.parametrize(
    ("several", "words"),
    [
        ([], "no recording was given"),
        ([_recording(), _recording(opening=np.linspace(0, 1, 60))], "there is no opening, which 0.csv holds"),
        ([_recording(), _recording(valve=Valve(kv_rated=4.0))], "gives kv_rated as 4.0"),
        (
            [_dated("2024-05-01T00:00:00"), _dated("2024-05-01T00:00:05")],
            "leave out the rows that are double",
        ),
        ([_dated("2024-05-01T00:00:00"), _recording()], "no command|there is no|give all in one form"),
        ([replace(_recording(), sha256="a"), replace(_recording(), sha256="a")], "is given twice"),
    ],
)
def test_what_does_not_belong_together_is_refused(several, words):
    with pytest.raises(InputError, match=words):
        join_recordings(several)


def test_seconds_and_dates_do_not_join():
    dated = _dated("2024-05-01T00:00:00")
    counted = Recording.from_frame({"time": np.arange(10.0), "command": np.linspace(0, 1, 10)})
    with pytest.raises(InputError, match="give all in one form"):
        join_recordings([dated, counted])


def test_findings_about_the_data_name_the_recording_and_its_rows():
    noise = 1e-4 * np.random.default_rng(0).normal(size=600)
    sound = _recording(600, flow=0.01 + noise)
    gap = 0.012 + noise
    gap[100:110] = np.nan
    found = screen_recording(join_recordings([sound, replace(_recording(600, flow=gap), source="b.csv")]))
    told = [each for each in found if each["finding"] == "gap"]
    assert [each["rows"] for each in told] == [[[700, 710]]]
    assert told[0]["detail"].startswith("in b.csv: ")


def test_a_sensor_that_never_moves_in_any_recording_is_told_once():
    rng = np.random.default_rng(0)
    several = [
        _recording(400, flow=0.01 + 1e-4 * rng.normal(size=400), temperature=np.full(400, 313.15))
        for _ in "ab"
    ]
    found = [each for each in screen_recording(join_recordings(several)) if each["role"] == "temperature"]
    assert [(each["finding"], each["rows"]) for each in found] == [("frozen", None)]


def test_a_short_recording_does_not_make_steps_coarse():
    time = np.arange(900.0)
    flow = np.round(0.01 + 0.005 * np.sin(time / 90.0), 5)
    whole = _recording(900, flow=flow)
    pieces = [whole.slice(0, 860), whole.slice(860, 900)]
    told = [each for each in screen_recording(join_recordings(pieces)) if each["finding"] == "quantised"]
    assert all(each["size"] < 0.005 for each in told)


def test_a_recording_of_little_flow_does_not_make_steps_coarse():
    time = np.arange(900.0)
    flow = np.where(time < 600.0, 0.01, 0.0005) * (1.0 + 0.5 * np.sin(time / 30.0))
    whole = _recording(900, flow=np.round(flow, 5))
    pieces = [whole.slice(0, 600), whole.slice(600, 900)]
    for recording, reach in ((pieces[1], 0.00075), (join_recordings(pieces), 0.015)):
        told = [each for each in screen_recording(recording) if each["finding"] == "quantised"]
        sizes = [each["size"] for each in told if each["role"] == "flow"]
        assert max(sizes) == pytest.approx(1e-5 / reach, rel=0.02)


def test_hours_that_are_given_twice_are_refused():
    rng = np.random.default_rng(0)
    whole = _recording(300, flow=0.01 + 1e-4 * rng.normal(size=300))
    with pytest.raises(InputError, match="hold 100 rows that are equal"):
        join_recordings([whole.slice(0, 200), whole.slice(100, 300)])


def test_parts_of_one_file_may_be_joined():
    whole = replace(_recording(200), sha256="a")
    joined = join_recordings([whole.slice(0, 90), whole.slice(100, 200)])
    assert [piece.begins for piece in joined.pieces] == [0.0, 100.0]
    assert not any(piece.assumed for piece in joined.pieces)


def test_clocks_that_begin_anew_are_said_to_be_assumed():
    rng = np.random.default_rng(0)
    one, other = (_recording(flow=0.01 + 1e-4 * rng.normal(size=60)) for _ in "ab")
    assert all(piece.assumed for piece in join_recordings([one, other]).pieces)


@pytest.mark.parametrize("order", [(0.3, 2.0), (2.0, 0.3)])
def test_of_two_dead_bands_the_wider_one_is_told(order):
    frames = []
    for k, band in enumerate(order):
        columns = healthy()
        columns["X"] = np.round(box_car(columns["X"], band, hold=True), 2)
        frames.append(planted(columns | {"time": columns["time"] + 5000.0 * k}))
    (told,) = [d for d in screen_recording(join_recordings(frames)) if d["finding"] == "compressed"]
    assert told["size"] == pytest.approx(0.02, rel=0.1)


def test_a_dead_band_and_a_slower_scan_are_told_of_the_pieces_that_have_them():
    held, scanned, sound = healthy(), healthy(), healthy()
    n = len(held["time"])
    held["X"] = np.round(box_car(held["X"], 0.3, hold=True), 2)
    scanned["X"] = scanned["X"][5 * (np.arange(n) // 5)]
    frames = [planted(c | {"time": c["time"] + 5000.0 * k}) for k, c in enumerate((held, scanned, sound))]
    told = {
        len(pieces): [d for d in screen_recording(join_recordings(pieces)) if d["finding"] == "compressed"]
        for pieces in (frames[:2], frames)
    }
    for found in told.values():
        assert [d["rows"] for d in found] == [[[0, n]], [[n, 2 * n]]]
        assert found[0]["size"] == pytest.approx(0.003, rel=0.1)
        assert found[1].get("size") is None
