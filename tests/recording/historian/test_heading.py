# SPDX-License-Identifier: BSD-3-Clause
"""Titles, blank lines and units above a table; columns of times by any name; what is asked for instead."""

import numpy as np
import pytest

from sklvalve.recording import InputError
from sklvalve.recording.historian import ImportSettings, import_export
from tests.recording.historian.exports import course, iso, moments, wide_text

TIMES = moments("2024-09-04 21:55:00", 60, 10)
VALUES = course(60)
NAMES = "Timestamp,FIC40102.OP,FIC40102.PV,FIC40102.MODE\n"
ROWS = "".join(
    f"{stamp},{value + 30.0:.2f},{value:.2f},AUTO\n" for stamp, value in zip(iso(TIMES), VALUES, strict=True)
)
PLAIN, UNITED = ["FIC40102.OP", "FIC40102.PV"], ["FIC40102.OP [%]", "FIC40102.PV [m3/h]"]
PREAMBLES = {
    "none": (NAMES, PLAIN),
    "title and blank line": ("Unit 2111\n\n" + NAMES, PLAIN),
    "title after the names of the times": ("Date and time: all in UTC\n" + NAMES, PLAIN),
    "when and for what": (
        "Refinery, Unit 2111\nReport generated,2024-11-12 08:15:00\nStart time,2024-09-04 21:55:00\n"
        "End time,2024-09-05 00:00:00\nInterval,10,s\n\n" + NAMES + ",%,m3/h,\n",
        UNITED,
    ),
    "padded by a spreadsheet": (
        "Unit 2111,,,\nDate,2024-11-12 08:15:00,,\nTime,08:15,,\nFrom,2024-09-04 21:55:00,,\n,,,\n"
        + NAMES
        + "dd/mm/yyyy hh:mm:ss,%,m3/h,\n\n",
        UNITED,
    ),
    "descriptions, units and a line": (
        "Plant A\n\n" + NAMES + "Date and time,output,flow,mode\n-,%,m3/h,-\n----,----,----,----\n",
        UNITED,
    ),
    "comments": ("# exported by hand\n# rows: 60\n#\n" + NAMES, PLAIN),
    "thirty lines": ("".join(f"Note {k}: all is well, said the shift\n" for k in range(30)) + NAMES, PLAIN),
    "an unknown name of the times": (
        "Unit 2111,,,\nFrom,2024-11-12 08:15:00,,\n\n" + NAMES.replace("Timestamp", "Sample"),
        PLAIN,
    ),
}


@pytest.fixture
def made(tmp_path):
    """Import a text."""

    def run(text, **settings):
        path = tmp_path / "export.csv"
        path.write_text(text)
        return import_export([path], ImportSettings(**settings))

    return run


def _is_the_course(imported, name):
    np.testing.assert_allclose(imported.columns[name], VALUES, atol=1e-9)


@pytest.mark.parametrize(("preamble", "names"), PREAMBLES.values(), ids=PREAMBLES)
def test_what_stands_above_a_table(made, preamble, names):
    imported = made(preamble + ROWS)
    assert list(imported.columns) == names
    _is_the_course(imported, names[1])


@pytest.mark.parametrize(
    ("name", "scale"),
    [
        ("time_s", 1.0),
        ("Time (s)", 1.0),
        ("t_s", 1.0),
        ("elapsed_sec", 1.0),
        ("time_ms", 1e-3),
        ("time_min", 60.0),
        ("Elapsed time [h]", 3600.0),
    ],
)
def test_counted_times_by_their_names(made, name, scale):
    rows = "".join(f"{value:.2f},{5 * k}\n" for k, value in enumerate(VALUES))
    imported = made(f"FIC1.PV,{name}\n" + rows)
    _is_the_course(imported, "FIC1.PV")
    assert imported.account["base"]["period"] == pytest.approx(5.0 * scale)


def test_a_flow_in_tons_an_hour_is_no_time():
    from sklvalve.recording.tags import read_time_name

    assert read_time_name("t/h") is None
    assert read_time_name("setpoint") is None
    assert read_time_name("T") == ""


def test_column_of_the_times_as_asked(made):
    text = wide_text(["stamp [s]", "FIC1.PV"], iso(TIMES), [5.0 * np.arange(60), VALUES])
    for name in ("stamp", "Stamp [s]"):
        imported = made(text, time_column=name)
        _is_the_course(imported, "FIC1.PV")
        assert imported.stamps[:2].tolist() == [0.0, 5.0]
    with pytest.raises(InputError, match=r"--time-column stmp: .*export.csv has no such column"):
        made(text, time_column="stmp")


def test_lines_left_out_as_asked(made):
    # a table of another kind above, which is found first
    above = wide_text(["A", "B"], iso(TIMES)[:20], [VALUES[:20], VALUES[:20]])
    imported = made(above + NAMES + ROWS, skip_rows=21)
    _is_the_course(imported, "FIC40102.PV")
    assert imported.account["files"][0]["lines_above"] == 0


def test_a_lone_quote_in_a_line_left_out_swallows_nothing(made):
    imported = made('12" valve\n' + NAMES + ROWS, skip_rows=1)
    _is_the_course(imported, "FIC40102.PV")


def test_line_of_the_names_as_asked(made):
    doubled = "Sample,A,B,C\nMoment,FIC1.OP,FIC1.PV,FIC1.MODE\n"
    assert "A" in made(doubled + ROWS).columns
    imported = made(doubled + ROWS, header=2)
    assert list(imported.columns) == ["FIC1.OP", "FIC1.PV"]
    _is_the_course(imported, "FIC1.PV")


def test_no_line_of_names_as_asked(made):
    rows = "".join(f"{stamp},FIC1.PV,{value:.2f}\n" for stamp, value in zip(iso(TIMES), VALUES, strict=True))
    _is_the_course(made("Day,Tag,Number\n" + rows, skip_rows=1, header=0), "FIC1.PV")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"skip_rows": 1000}, "--skip-rows 1000: .*export.csv has 61 lines; leave out fewer"),
        ({"header": 99}, "--header 99: line 99 of .*export.csv is blank, skipped or not there"),
        ({"header": 2, "skip_rows": 5}, "--header 2: the names must stand below the 5 lines"),
        ({"header": 61}, "there is a header but no row with a time and a value under it"),
    ],
)
def test_lines_that_are_not_there(made, settings, words):
    with pytest.raises(InputError, match=words):
        made(NAMES + ROWS, **settings)


STATES = {
    "a pump's flag": ("PUMP7.Status", ["1", "0", "0"]),
    "a pump's words": ("PUMP7 Status", ["Running", "Stopped", "Tripped"]),
    "words that a quality has": ("PUMP7_Status", ["Good", "Bad", "Good"]),
    "the loop's": ("FIC1.Status", ["Bad", "Bad", "Good"]),
    "of the tag, and a flag": ("FIC1.PV.Status", ["1", "0", "1"]),
    "of the tag, and a state": ("FIC1.PV Status", ["AUTO", "MAN", "AUTO"]),
    "alone, and a flag": ("Status", ["1", "1", "0"]),
    "alone, and a state": ("State", ["AUTO", "MAN", "AUTO"]),
    "a number of a state": ("Status", ["3", "4", "3"]),
}


@pytest.mark.parametrize(("name", "cells"), STATES.values(), ids=STATES)
def test_a_status_deletes_nothing(made, name, cells):
    imported = made(wide_text(["FIC1.PV", name], iso(TIMES), [VALUES, cells * 20]))
    _is_the_course(imported, "FIC1.PV")
    assert imported.account["tags"]["FIC1.PV"]["bad"] == {}
    assert name in {*imported.columns, *imported.account["left_out"]}


@pytest.mark.parametrize(
    "name", ["Status", "Quality", "FIC1.PV Status", "FIC1.PV.Quality", "FIC1 Quality", "FIC1.PV_Quality"]
)
@pytest.mark.parametrize("cells", [["Good", "Bad", "Good"], ["192", "0", "192"]])
def test_a_quality_of_the_tag_is_one(made, name, cells):
    imported = made(wide_text(["FIC1.PV", name], iso(TIMES), [VALUES, cells * 20]))
    assert list(imported.columns) == ["FIC1.PV"]
    assert np.isnan(imported.columns["FIC1.PV"]).sum() == 20


def test_a_column_of_states_in_long_format_deletes_nothing(made):
    rows = [f"FIC1.PV;{stamp};{value:.2f};Running" for stamp, value in zip(iso(TIMES), VALUES, strict=True)]
    _is_the_course(made("\n".join(["Tag;Time;Value;Status", *rows])), "FIC1.PV")


def test_a_unit_behind_every_number_goes_into_the_name(made):
    cells = [f"{value:.2f} degF" for value in VALUES]
    assert list(made(wide_text(["TI7"], iso(TIMES), [cells])).columns) == ["TI7 [degF]"]
