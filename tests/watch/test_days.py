# SPDX-License-Identifier: BSD-3-Clause
"""Which files are a day's, and what of them is."""

import datetime as dt

import pytest

from sklvalve.recording import InputError, Valve
from sklvalve.watch.days import days_of, read_day
from sklvalve.watch.plant import Commissioning, Watched

VALVE = Valve.from_dict(
    {
        "recording": {
            "time": "t",
            "command": {"column": "C", "unit": "%"},
            "flow": {"column": "F", "unit": "m3/h"},
        }
    }
)
WATCHED = Watched("FV-1", VALVE, "FV-1", Commissioning())


def rows(day, hours=range(24), many=30):
    stamps = [f"{day}T{hour:02d}:{minute:02d}:00" for hour in hours for minute in range(many)]
    return "t,C,F\n" + "".join(f"{stamp},{50 + k % 7},{30 + k % 5}\n" for k, stamp in enumerate(stamps))


@pytest.fixture
def data(tmp_path):
    def write(name, text):
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    write.root = tmp_path
    return write


@pytest.mark.parametrize(
    "name",
    [
        "FV-1/2026-01-03.csv",
        "FV-1/export 2026-01-03 final.csv",
        "FV-1/day=2026-01-03/part-0.csv",
        "valve=FV-1/day=2026-01-03/part-0.csv",
        "FV-1/2026/2026-01-03.csv",
    ],
)
def test_a_day_is_known_by_its_path(data, name):
    data(name, rows("2026-01-03"))
    found = days_of(data.root, WATCHED)
    assert [each.day for each in found.days] == [dt.date(2026, 1, 3)]
    recording = read_day(found.days[0], WATCHED)
    assert len(recording) == 720
    assert recording.source == "FV-1 2026-01-03"


def test_parts_of_a_day_are_one_recording(data):
    data("FV-1/day=2026-01-03/b.csv", rows("2026-01-03", range(12, 24)))
    data("FV-1/day=2026-01-03/a.csv", rows("2026-01-03", range(12)))
    (day,) = days_of(data.root, WATCHED).days
    assert len(read_day(day, WATCHED)) == 720


def test_rows_of_other_days_are_left_out(data):
    text = rows("2026-01-03") + rows("2026-01-04", range(2)).split("\n", 1)[1]
    data("FV-1/2026-01-03.csv", text)
    (day,) = days_of(data.root, WATCHED).days
    assert len(read_day(day, WATCHED)) == 720
    data("FV-1/2026-01-09.csv", rows("2026-01-03"))
    with pytest.raises(InputError, match="no row is stamped by that day"):
        read_day(days_of(data.root, WATCHED).days[1], WATCHED)


def test_files_that_name_no_day_are_told(data):
    data("FV-1/all.csv", rows("2026-01-03"))
    data("FV-1/2026-13-45.csv", rows("2026-01-03"))
    data("FV-1/.2026-01-03.csv", rows("2026-01-03"))
    found = days_of(data.root, WATCHED)
    assert not found.days
    assert [file.name for file in found.unplaced] == ["2026-13-45.csv", "all.csv"]


def test_a_changed_file_has_another_checksum_and_stamp(data):
    data("FV-1/2026-01-03.csv", rows("2026-01-03"))
    (before,) = days_of(data.root, WATCHED).days
    told = before.checksum(), before.stamp()
    assert told == (before.checksum(), before.stamp())
    data("FV-1/2026-01-03.csv", rows("2026-01-03", range(20)))
    assert before.checksum() != told[0]
    assert before.stamp() != told[1]


def test_a_valve_without_a_folder_has_no_days(tmp_path):
    assert days_of(tmp_path, WATCHED).days == ()
