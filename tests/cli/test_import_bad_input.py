# SPDX-License-Identifier: BSD-3-Clause
"""Exports and arguments that cannot be used: status 2, one sentence with place and mend, nothing written."""

import pytest

from tests.cli.refusal import refused
from tests.recording.historian.exports import course, iso, local, long_text, moments, wide_text

TIMES = moments("2024-06-28 10:00:00", 60, 10)
STAMPS, VALUES = iso(TIMES), course(60)
WIDE = wide_text(["FIC1.PV", "FIC1.OP"], STAMPS, [VALUES, VALUES])
LONG = long_text(["FIC1.PV"], STAMPS, VALUES)
AUTUMN = local(moments("2024-10-26 23:00:00", 480, 30))
WINTER = iso(moments("2024-03-31 01:00:00", 360, 30))


def _changed(text, line, old, new):
    lines = text.splitlines()
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new)
    return "\n".join(lines) + "\n"


# what the export holds, further words on the command line, what the sentence must say
EXPORTS = {
    "empty": ("", [], "export.csv: the file is empty"),
    "blank lines": ("\ufeff\n\n", [], "export.csv: the file is empty"),
    "workbook": (b"PK\x03\x04rest", [], "a workbook or zip archive, not text; export the table as CSV"),
    "old workbook": (b"\xd0\xcf\x11\xe0rest", [], "an old Excel workbook"),
    "binary": (b"abc\x01\x00\x00\x05\x00defghijklmnop\x07", [], "byte 4 shows a binary file"),
    "broken gzip": (b"\x1f\x8b\x08rest", [], "not whole gzip data"),
    "wrong encoding": (b"\xff" + WIDE.encode(), ["--encoding", "utf-8"], "line 1 is no text in utf-8"),
    "unknown encoding": (WIDE, ["--encoding", "polish"], "no such encoding"),
    "no columns": ("Report\nof the shift\nall well\n", [], "no tabs, semicolons, bars or commas divide"),
    "header alone": (WIDE.splitlines()[0] + "\nnone,none,none\n", [], "no row with a time and a value"),
    "wide without names": (WIDE.split("\n", 1)[1], [], "line 1: values begin without names of columns"),
    "no time": ("FIC1.PV,FIC1.OP\n1,2\n3,4\n5,6\n", [], "no column holds times (columns: FIC1.PV, FIC1.OP)"),
    "tags without values": (LONG.replace("Value", "X", 1), [], "none is named value"),
    "column twice": (WIDE.replace("FIC1.OP", "FIC1.PV"), [], "two columns are called 'FIC1.PV'"),
    "tag missing": (_changed(LONG, 9, "FIC1.PV", ""), [], "line 9: the tag is missing"),
    "bad time": (_changed(WIDE, 7, "10:00:50", "10:61:50"), [], "line 7: '2024-06-28 10:61:50' is no time"),
    "no such day": (_changed(WIDE, 7, "06-28", "06-31"), [], "line 7: '2024-06-31 10:00:50' is no time"),
    "time missing": (_changed(WIDE, 7, "2024-06-28 10:00:50", ""), [], "line 7: the value of FIC1.PV"),
    "some offsets": (_changed(WIDE, 7, "10:00:50", "10:00:50Z"), [], ":50Z' has an offset"),
    "both date orders": (
        WIDE.replace("2024-06-28", "28/06/2024", 30).replace("2024-06-28", "06/28/2024"),
        [],
        "in the date 28/6/2024 the day stands first, in 6/28/2024 the month",
    ),
    "unquoted decimal commas": (
        _changed(WIDE, 7, ".", ","),
        [],
        "line 7: 5 cells, but the table has 3 columns; if",
    ),
    "decimal commas throughout": (
        "time,F,X\n" + WIDE.split("\n", 1)[1].replace(".", ","),
        [],
        "line 2: 5 cells, but the table has 3 columns; if decimals are commas too, export with semicolons",
    ),
    "points and commas": (_changed(LONG, 9, ",", "."), [], "decimal points and decimal commas in one file"),
    "no numbers": (long_text(["MODE"], STAMPS, ["AUTO", "MAN"] * 30), [], "(MODE holds"),
    "all bad": (LONG.replace("Good", "Bad"), [], "no tag holds a good number (FIC1.PV holds no good value"),
    "one moment": ("\n".join(WIDE.splitlines()[:2]), [], "no tag has values at two different times"),
    "clocks set back": (wide_text(["F"], AUTUMN, [course(480)]), [], "name the zone of these times, such as"),
    "no daylight saving": (
        wide_text(["F"], WINTER, [course(360)]),
        ["--timezone", "Europe/Warsaw"],
        "line 241: the time 2024-03-31 02:59:30 does not exist in Europe/Warsaw",
    ),
    "unknown zone": (WIDE, ["--timezone", "Europe/Warsawa"], "did you mean 'Europe/Warsaw'?"),
    "zone of seconds": (
        wide_text(["F"], [str(row) for row in range(60)], [VALUES]),
        ["--timezone", "UTC"],
        "are seconds from a start, which no zone changes; leave it out",
    ),
    "unknown tag to hold": (WIDE, ["--hold", "FIC1.PX"], "--hold FIC1.PX: the export has no such tag"),
    "too fine a period": (WIDE, ["--period", "0.0001"], "more than 5000000; give a longer --period"),
    "far too fine a period": (WIDE, ["--period", "1e-9"], "there are 5.9e+11 rows of 1e-09 s, more than"),
    "finer than a time": (
        "time,F\n0,1\n0.0001,2\n",
        ["--period", "1e-7"],
        "expected a --period from 1e-06 to 1e+09 s; got 1e-07 s",
    ),
    "endless period": (WIDE, ["--period", "1e300"], "expected a --period from 1e-06 to 1e+09 s; got 1e+300"),
    "period beyond all": (
        _changed(WIDE, 2, "10:00:00", "10:00:03"),
        ["--period", "86400"],
        "give a shorter --period",
    ),
    "period nought": (WIDE, ["--period", "0"], "expected a number above 0; got '0'"),
    "period of words": (WIDE, ["--period", "10s"], "expected a number above 0; got '10s'"),
    "no time column of that name": (
        WIDE,
        ["--time-column", "tme"],
        "--time-column tme: export.csv has no such column; did you mean 'time'?",
    ),
    "time column without a name": (WIDE, ["--time-column", ""], "expected the name of a column; got ''"),
    "time column of values": (
        WIDE,
        ["--time-column", "FIC1.PV", "--timezone", "UTC"],
        "are seconds from a start, which no zone changes; leave it out",
    ),
    "lines left out below nought": (
        WIDE,
        ["--skip-rows", "-1"],
        "expected a number of lines, 0 or more; got '-1'",
    ),
    "lines left out of words": (WIDE, ["--skip-rows", "two"], "expected a number of lines, 0 or more; got"),
    "all lines left out": (WIDE, ["--skip-rows", "61"], "--skip-rows 61: export.csv has 61 lines; leave out"),
    "all lines left out under a named separator": (
        "sep=,\n" + WIDE,
        ["--skip-rows", "99"],
        "--skip-rows 99: export.csv has 62 lines; leave out",
    ),
    "more lines left out than can be counted": (
        WIDE,
        ["--skip-rows", "1" + 21 * "0"],
        "export.csv has 61 lines; leave out",
    ),
    "names above the first line": (WIDE, ["--header", "0"], "expected the number of a line, 1 or more, or"),
    "names in no line": (WIDE, ["--header", "first"], "expected the number of a line, 1 or more, or none"),
    "names below the end": (WIDE, ["--header", "99"], "--header 99: line 99 of export.csv is blank, skipped"),
    "names in a line left out": (
        WIDE,
        ["--header", "2", "--skip-rows", "3"],
        "--header 2: the names must stand below the 3 lines that are left out",
    ),
    "gap nought": (WIDE, ["--gap", "nan"], "expected a number above 0"),
    "workbook out": (WIDE, ["--out", "recording.xlsx"], "name the recording .csv, .csv.gz or .parquet"),
    "out is the export": (WIDE, ["--out", "./export.csv"], "this is the export itself"),
    "out under a file": (WIDE, ["--out", "export.csv/recording.csv"], "is a file"),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")
    return tmp_path


@pytest.mark.parametrize(("content", "more", "words"), EXPORTS.values(), ids=EXPORTS)
def test_export(folder, capsys, content, more, words):
    (folder / "export.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    out = [] if "--out" in more else ["--out", "recording.csv"]
    refused(["import", "export.csv", *out, *more], words, capsys)


def test_missing_file_and_folder(folder, capsys):
    refused(["import", "absent.csv", "--out", "r.csv"], "absent.csv: no such file", capsys)
    refused(["import", ".", "--out", "r.csv"], "this is a folder; give the files", capsys)
    refused(["import", "absent.csv"], "--out", capsys)


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (WIDE.replace("FIC1.PV", "FIC1.PV [t/h]"), "FIC1.PV is in 't/h', but in 'm3/h' in export.csv"),
        (wide_text(["X"], [str(row) for row in range(60)], [VALUES]), "it holds seconds from a start, but"),
    ],
)
def test_files_that_do_not_belong_together(folder, capsys, other, words):
    (folder / "export.csv").write_text(WIDE.replace("FIC1.PV", "FIC1.PV [m3/h]"))
    (folder / "other.csv").write_text(other)
    refused(["import", "export.csv", "other.csv", "--out", "r.csv"], words, capsys)


def test_runs_whose_files_cannot_be_written(folder, capsys):
    (folder / "export.csv").write_text(wide_text(["F"], [str(row % 30) for row in range(60)], [VALUES]))
    (folder / "r_2.csv").mkdir()
    refused(["import", "export.csv", "--out", "r.csv"], "r_2.csv: this is no plain file", capsys)
    (folder / "r_2.csv").rmdir()
    (folder / "export.csv").rename(folder / "r_1.csv")
    refused(["import", "r_1.csv", "--out", "r.csv"], "--out r_1.csv: this is the export itself", capsys)


def test_runs_in_one_of_two_files(folder, capsys):
    (folder / "a.csv").write_text(wide_text(["F"], [str(row % 30) for row in range(60)], [VALUES]))
    (folder / "b.csv").write_text(wide_text(["G"], [str(row) for row in range(60)], [VALUES]))
    refused(
        ["import", "a.csv", "b.csv", "--out", "r.csv"],
        "a.csv, line 32: the clock starts again, so this file holds 2 runs; import it by itself",
        capsys,
    )


def test_seconds_that_begin_anew(folder, capsys):
    text = wide_text(["F"], [str(row) for row in range(60)], [VALUES])
    for name in ("a.csv", "b.csv"):
        (folder / name).write_text(text)
    refused(["import", "a.csv", "b.csv", "--out", "r.csv"], "its seconds begin anew", capsys)
