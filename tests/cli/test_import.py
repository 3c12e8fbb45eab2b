# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve import``: files written whole or not at all, read again, and the account of them."""

import json
import os

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.recording import read_recording
from tests.recording.historian.exports import course, iso, local, long_text, moments, wide_text

TIMES = moments("2024-06-28 10:00:00", 200, 10)
VALUES = course(200)
VALVE = """
[recording.command]
column = "FIC1.OP [%]"
unit = "%"
[recording.flow]
column = "FIC1.PV [m3/h]"
unit = "m3/h"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with an export."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")  # a fault of the package fails a test as what it is
    columns = [VALUES, 3.0 * VALUES]
    (tmp_path / "export.csv").write_text(wide_text(["FIC1.PV [m3/h]", "FIC1.OP [%]"], iso(TIMES), columns))
    return tmp_path


@pytest.mark.parametrize("name", ["recording.csv", "recording.csv.gz", "recording.parquet"])
def test_each_kind_of_file_is_read_again(folder, name):
    pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')
    pytest.importorskip("pyarrow", reason='needs pip install "sklvalve[io]"')
    assert main(["import", "export.csv", "--out", name, "--timezone", "Europe/Warsaw"]) == 0
    (folder / "valve.toml").write_text(VALVE)
    recording = read_recording(folder / name, folder / "valve.toml")
    assert recording.sample_time == 10.0
    assert recording.stamps[0] == "2024-06-28T10:00:00+02:00"
    np.testing.assert_allclose(recording["flow"], VALUES / 3600.0)
    assert sorted(os.listdir(".")) == sorted(["export.csv", "valve.toml", name, "recording.import.json"])


def test_same_export_gives_the_same_bytes(folder):
    for name in ("one.csv.gz", "two.csv.gz"):
        assert main(["import", "export.csv", "--out", name]) == 0
    assert (folder / "one.csv.gz").read_bytes() == (folder / "two.csv.gz").read_bytes()


def test_text_says_what_was_done_and_what_is_next(folder, capsys):
    cells = [f"{value:.2f}" for value in VALUES]
    cells[5], cells[6], cells[7] = "Bad", "I/O Timeout", "[-11059] No Good Data For Calculation"
    text = long_text(["FIC1.PV"], local(TIMES), cells)
    (folder / "export.csv").write_text(text + text.splitlines()[20] + "\n")
    assert main(["import", "export.csv", "--out", "recording.csv", "--timezone", "Europe/Warsaw"]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    for words in (
        "export.csv: long format, semicolons, decimal commas, utf-8; 201 rows",
        "Local time of Europe/Warsaw.",
        "200 rows from 2024-06-28T12:00:00+02:00 to 2024-06-28T12:33:10+02:00, every 10 s",
        "without a value: Bad 1, I/O Timeout 1, [-11059] No Good Data For Calculation 1.",
        "1 stamps ran back",
        "Next: sklvalve init recording.csv",
    ):
        assert words in shown.out


def test_json_alone_on_standard_output_is_what_lies_beside(folder, capsys):
    assert main(["import", "export.csv", "--out", "recording.csv", "--json"]) == 0
    account = json.loads(capsys.readouterr().out)
    assert account == json.loads((folder / "recording.import.json").read_text())
    assert account["schema"] == "sklvalve.import/1"
    assert account["tags"]["FIC1.PV"]["exact"] == 200


def test_what_is_assumed_is_said(folder, capsys):
    stamps = [f"{time:%d/%m/%Y %H:%M:%S}" for time in moments("2024-04-03 10:00:00", 200, 10)]
    values = [f"{row % 7 + 1},{row % 3}00" for row in range(200)]
    (folder / "export.csv").write_text(wide_text(["F"], stamps, [values], separator=";"))
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 0
    shown = capsys.readouterr().out
    assert "Dates such as 03/04 are taken as day/month" in shown
    assert "commas are taken for decimal commas" in shown
    assert (folder / "recording.csv").read_text().splitlines()[1] == "2024-04-03T10:00:00,1"
    asked = ["--dates", "month-first", "--decimal", "point"]
    assert main(["import", "export.csv", "--out", "recording.csv", *asked]) == 0
    assert (folder / "recording.csv").read_text().splitlines()[1] == "2024-03-04T10:00:00,1000"


def test_uncertain_values_are_kept_when_asked(folder, capsys):
    text = long_text(["FIC1.PV"], iso(TIMES), VALUES).replace("Good", "Uncertain", 4)
    (folder / "export.csv").write_text(text)
    for options, missing in (([], 4), (["--keep-uncertain"], 0)):
        assert main(["import", "export.csv", "--out", "r.csv", "--json", *options]) == 0
        account = json.loads(capsys.readouterr().out)
        assert account["base"]["rows"] == 200 - missing


def test_runs_one_behind_the_other_become_recordings(folder, capsys):
    rows = [[f"{10 * (row % 50)}" for row in range(200)], [VALUES, 3.0 * VALUES]]
    (folder / "export.csv").write_text(wide_text(["FIC1.PV [m3/h]", "FIC1.OP [%]"], *rows))
    (folder / "recording.csv").write_text("of an earlier import")
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 0
    shown = capsys.readouterr().out
    for words in (
        "The clock starts again 3 times: 4 runs, each a recording of its own.",
        "Run 2 (recording_2.csv), from line 52: 50 rows from 0.0 to 490.0, every 10 s",
        "Written: recording_1.csv to recording_4.csv, recording.import.json",
        "Next: sklvalve init recording_1.csv",
    ):
        assert words in shown
    names = [f"recording_{number}.csv" for number in range(1, 5)]
    assert sorted(os.listdir(".")) == sorted(["export.csv", "recording.import.json", *names])
    account = json.loads((folder / "recording.import.json").read_text())
    assert [run["recording"] for run in account["runs"]] == names
    assert main(["init", names[0], "--yes"]) == 0
    for number, name in enumerate(names):
        recording = read_recording(folder / name, folder / "valve.toml")
        np.testing.assert_allclose(recording["flow"], VALUES[50 * number :][:50] / 3600.0)


def test_fewer_runs_leave_none_of_an_earlier_import(folder):
    def export_of(runs):
        rows = [[f"{10 * (row % 50)}" for row in range(50 * runs)], [VALUES[: 50 * runs]]]
        (folder / "export.csv").write_text(wide_text(["FIC1.PV [m3/h]"], *rows))

    (folder / "recording_9.csv").write_text("of nobody's import")
    for runs, left in ((4, [1, 2, 3, 4]), (2, [1, 2]), (1, [])):
        export_of(runs)
        assert main(["import", "export.csv", "--out", "recording.csv"]) == 0
        names = [f"recording_{number}.csv" for number in (*left, 9)]
        single = ["recording.csv"] if not left else []
        assert sorted(os.listdir(".")) == sorted(["export.csv", "recording.import.json", *names, *single])


def test_a_run_that_is_imported_again_is_kept(folder):
    rows = [[f"{10 * (row % 50)}" for row in range(200)], [VALUES]]
    (folder / "export.csv").write_text(wide_text(["FIC1.PV [m3/h]"], *rows))
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 0
    assert main(["import", "recording_1.csv", "--out", "recording.csv"]) == 0
    assert (folder / "recording_1.csv").exists()
    assert not (folder / "recording_2.csv").exists()


def test_what_is_asked_of_the_lines_and_the_times(folder):
    text = wide_text(["stamp", "FIC1.PV"], iso(TIMES), [10.0 * np.arange(200), VALUES])
    (folder / "export.csv").write_text("A title\n\n" + text)
    asked = ["--skip-rows", "2", "--header", "3", "--time-column", "stamp"]
    assert main(["import", "export.csv", "--out", "recording.csv", *asked]) == 0
    assert (folder / "recording.csv").read_text().splitlines()[1] == f"0,{VALUES[0]:g}"


def test_interruption_leaves_nothing(folder, monkeypatch, capsys):
    def interrupted(path, stamps, columns):
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr("sklvalve.recording.historian.write.write_recording", interrupted)
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 130
    assert capsys.readouterr().err == "interrupted; nothing was written\n"
    assert os.listdir(".") == ["export.csv"]


def test_full_disk_leaves_what_was_there(folder, monkeypatch, capsys):
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 0
    before = {name: (folder / name).read_bytes() for name in sorted(os.listdir("."))}

    def full(path, stamps, columns):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("sklvalve.recording.historian.write.write_recording", full)
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 2
    assert "cannot be written (No space left on device)" in capsys.readouterr().err
    assert {name: (folder / name).read_bytes() for name in sorted(os.listdir("."))} == before


def test_csv_needs_no_pandas_parquet_says_so(folder, monkeypatch, capsys):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    assert main(["import", "export.csv", "--out", "recording.csv"]) == 0
    capsys.readouterr()
    assert main(["import", "export.csv", "--out", "recording.parquet"]) == 2
    assert 'pip install "sklvalve[io]"' in capsys.readouterr().err
    assert not os.path.exists("recording.parquet")
