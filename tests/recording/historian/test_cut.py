# SPDX-License-Identifier: BSD-3-Clause
"""Times that an import keeps."""

import numpy as np
import pytest

from sklvalve.recording import InputError
from sklvalve.recording.historian import ImportSettings, import_export, import_runs
from sklvalve.recording.historian.summary import summary
from tests.recording.historian.exports import course, local, moments, wide_text

# three days, a row each ten minutes
TIMES = moments("2024-06-27 22:00:00", 432, 600)
VALUES = course(432)


@pytest.fixture
def export(tmp_path):
    def written(stamps, name="export.csv"):
        path = tmp_path / name
        path.write_text(wide_text(["FIC1.PV"], stamps, [VALUES]))
        return path

    return written


def _made(path, **settings):
    return import_export([path], ImportSettings(**settings))


def test_days_are_kept_whole_in_local_time(export):
    path = export(local(TIMES))
    made = _made(path, zone="Europe/Warsaw", begin="2024-06-29", end="2024-06-29")
    assert made.stamps[0] == "2024-06-29T00:00:00+02:00"
    assert made.stamps[-1] == "2024-06-29T23:50:00+02:00"
    np.testing.assert_allclose(made.columns["FIC1.PV"], VALUES[144:288])
    assert made.account["base"]["rows"] == 144
    assert made.account["base"]["rows_without_any_value"] == 0
    assert made.account["base"]["cut"] == {"from": "2024-06-29", "until": "2024-06-29"}
    assert "Rows outside of the times asked for are left out;" in summary(made.account)


def test_a_time_of_day_with_its_offset_and_one_end_alone(export):
    path = export([t.isoformat() for t in TIMES])
    made = _made(path, begin="2024-06-30T20:00:00+00:00")
    assert len(made.stamps) == 12
    made = _made(path, end="2024-06-27T23:00:00+00:00")
    assert len(made.stamps) == 7
    assert _made(path).account["base"]["cut"] is None
    # the offset of the export is that of times without one
    made = _made(path, begin=" 2024-06-29 ", end="20240629")
    assert (made.stamps[0], made.stamps[-1]) == ("2024-06-29T00:00:00Z", "2024-06-29T23:50:00Z")


@pytest.mark.parametrize("day", ["2024-06-29", " 2024-06-29", "20240629"])
def test_a_day_is_whole_however_it_is_written_and_in_no_zone(export, day):
    made = _made(export([stamp.isoformat()[:19] for stamp in TIMES]), begin=day, end=day)
    assert (made.stamps[0], made.stamps[-1]) == ("2024-06-29T00:00:00", "2024-06-29T23:50:00")


def test_counted_seconds(export):
    path = export([f"{100.0 + 5.0 * k:g}" for k in range(432)])
    made = _made(path, begin="200", end="300")
    assert made.stamps.tolist() == np.arange(200.0, 301.0, 5.0).tolist()


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"begin": "2024-07-02"}, "no row stands between '2024-07-02' and its end; give a time between"),
        (
            {"begin": "2024-06-30", "end": "2024-06-29"},
            "'2024-06-30' is after '2024-06-29'; give the earlier",
        ),
        ({"begin": "2024-06-29T05:00", "end": "2024-06-29T05:00"}, "one row alone lies between --from and"),
        ({"end": "yesterday"}, "'yesterday' is no time of this recording; give one like '2024-06-28T00"),
    ],
)
def test_times_that_keep_nothing(export, settings, match):
    with pytest.raises(InputError, match=match):
        _made(export(local(TIMES)), zone="Europe/Warsaw", **settings)


def test_an_export_of_several_runs_is_not_cut(tmp_path):
    path = tmp_path / "runs.csv"
    stamps = [f"{k % 216}" for k in range(432)]
    path.write_text(wide_text(["FIC1.PV"], stamps, [VALUES]))
    assert len(import_runs([path]).runs) == 2
    with pytest.raises(InputError, match="the clock starts again, so --from and --until could mean any of 2"):
        import_runs([path], ImportSettings(begin="10"))


@pytest.mark.parametrize(
    ("start", "day", "rows", "last"),
    [
        ("2026-10-24 20:00:00", "2026-10-25", 150, "2026-10-25T23:50:00+01:00"),
        ("2026-03-28 20:00:00", "2026-03-29", 138, "2026-03-29T23:50:00+02:00"),
    ],
)
def test_a_day_on_which_the_clock_is_set_is_kept_whole(tmp_path, start, day, rows, last):
    path = tmp_path / "export.csv"
    path.write_text(wide_text(["FIC1.PV"], local(moments(start, 432, 600)), [VALUES]))
    made = _made(path, zone="Europe/Warsaw", begin=day, end=day)
    assert (len(made.stamps), made.stamps[-1]) == (rows, last)


def test_of_an_hour_that_is_there_twice_both_are_kept(tmp_path):
    path = tmp_path / "export.csv"
    path.write_text(wide_text(["FIC1.PV"], local(moments("2026-10-24 20:00:00", 432, 600)), [VALUES]))
    made = _made(path, zone="Europe/Warsaw", begin="2026-10-25T02:30", end="2026-10-25T02:40")
    assert made.stamps[0] == "2026-10-25T02:30:00+02:00"
    assert made.stamps[-1] == "2026-10-25T02:40:00+01:00"


def test_a_tag_without_a_value_between_the_times_is_left_out(tmp_path):
    path = tmp_path / "export.csv"
    late = [f"{value:.2f}" if k < 100 else "" for k, value in enumerate(VALUES)]
    path.write_text(wide_text(["FIC1.PV", "FIC1.OP"], local(TIMES), [VALUES, late]))
    made = _made(path, zone="Europe/Warsaw", begin="2024-06-30")
    assert list(made.columns) == ["FIC1.PV"]
    assert made.account["left_out"] == {"FIC1.OP": "holds no value between the times asked for"}
