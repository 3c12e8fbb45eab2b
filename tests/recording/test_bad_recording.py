# SPDX-License-Identifier: BSD-3-Clause
"""Every bad recording gets one sentence that names the file, the place and the mend."""

import gzip

import numpy as np
import pytest

from sklvalve.recording import InputError, Recording, Valve, read_recording

ROWS = 20
VALVE = {
    "recording": {
        "time": "time",
        "command": {"column": "CV", "unit": "%"},
        "p1": {"column": "P1", "unit": "kPa"},
        "p2": {"column": "P2", "unit": "kPa"},
        "flow": {"column": "F", "unit": "m3/h"},
    }
}


def table(**columns):
    """Text of a good recording, some of its columns replaced, or single cells by {row: value}."""
    good = {
        "time": [str(row) for row in range(ROWS)],
        "CV": [str(50.0 + row) for row in range(ROWS)],
        "P1": ["500.0"] * ROWS,
        "P2": ["200.0"] * ROWS,
        "F": [str(10.0 + 0.1 * row) for row in range(ROWS)],
    }
    for name, change in columns.items():
        if isinstance(change, dict):
            for row, cell in change.items():
                good[name][row - 1] = cell
        else:
            good[name] = list(change)
    lines = [",".join(good), *(",".join(cells) for cells in zip(*good.values(), strict=True))]
    return "\n".join(lines) + "\n"


def sentence_for(tmp_path, content, name="recording.csv", valve=VALVE):
    file = tmp_path / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError) as caught:
        read_recording(file, Valve.from_dict(valve, source="valve.toml"))
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence.removeprefix(f"{file}: ")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (table(F={7: "Bad"}), ["column 'F' (flow), row 7", "'Bad' is no number", "leave the cell empty"]),
        (table(F={7: "10,5"}).replace("10,5", '"10,5"'), ["row 7", "'10,5' is no number", "point"]),
        (table(F=["True"] * ROWS), ["row 1", "True is no number"]),
        (table(F={3: "inf"}), ["column 'F' (flow), row 3", "infinite"]),
        (table(F=[""] * ROWS), ["column 'F' (flow)", "only gaps"]),
        (
            table(CV=[str(0.5)] * ROWS).replace("CV", "Cv"),
            ["no column 'CV' for command", "'Cv'", "P1, P2, F"],
        ),
        (table().replace("time", "zeit"), ["no column 'time' for the time", "zeit, CV, P1, P2, F"]),
        (table(time={5: "2"}), ["column 'time', row 5", "time 2 comes after 3", "sort"]),
        (table(time={5: "3"}), ["column 'time', row 5", "stands twice"]),
        (table(time={5: ""}), ["column 'time', row 5", "missing"]),
        (table(time={5: "later"}), ["column 'time', row 5", "'later'"]),
        (table(P1=["100"] * ROWS), ["p2 lies above p1 in every row, by 100 kPa", "swap"]),
        (table(P1=["-300"] * ROWS), ["column 'P1' (p1)", "vacuum", "gauge = true"]),
        (table(CV=["4000"] * ROWS), ["column 'CV' (command)", "4000", "another range"]),
        ("time,CV,P1,P2,F\n", ["header but no row"]),
        ("\n\n", ["no column names"]),
        ("", ["empty"]),
        (table().replace(",", ";"), ["semicolons", "commas"]),
        (table().replace(",", "\t"), ["tabs"]),
        (table().replace("time,CV", "time,F", 1), ["column 'F' stands twice"]),
        (
            table().replace("12,62.0", "12,62.0,1,2"),
            ["uneven", "line 1 names 5 columns, line 14 holds 7 cells", "every row 5 cells"],
        ),
        (
            "Export of 28 June\n" + table(),
            ["no table", "line 1 names one column, the lines below it hold more", "first line"],
        ),
        (
            "Some words\nand others\n" + table(),
            ["no table", "one column, line 3 holds 5 cells", "first line"],
        ),
        ("\n".join(table().splitlines()[:6]), ["too few rows for a recording, 5", "at least 10"]),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", ["binary"]),
        (table().encode("utf-16"), ["UTF-16"]),
        (table(F={4: "12°"}).encode("latin-1"), ["line 5", "UTF-8"]),
        (gzip.compress(table().encode()), ["gzip", "name it .csv.gz"]),
        ("t" * 200_000, ["first line is no line of CSV"]),
        (b"PK\x03\x04rest", ["workbook", "CSV"]),
        (b"PAR1restPAR1", ["Parquet", "name it .parquet"]),
    ],
)
def test_bad_csv(tmp_path, content, words):
    sentence = sentence_for(tmp_path, content)
    assert all(word in sentence for word in words), sentence


def test_one_cell_too_many_in_every_row(tmp_path):
    lines = table().splitlines()
    sentence = sentence_for(tmp_path, "\n".join([lines[0], *(line + ",1" for line in lines[1:])]))
    assert "line 1 names 5 columns, the lines below it hold more; give every row 5 cells" in sentence


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("r.csv.gz", b"no gzip", ["not whole gzip"]),
        ("r.csv.gz", gzip.compress(table().encode(), mtime=0)[:-20], ["not whole gzip"]),
        ("r.csv.gz", gzip.compress(b"", mtime=0), ["empty"]),
        ("r.parquet", b"no parquet", ["not whole Parquet"]),
        ("r.parquet", b"PAR1 and then nothing of use PAR1", ["Parquet data cannot be read"]),
        ("r.xlsx", b"PK", ["expected a file named .csv, .csv.gz or .parquet"]),
    ],
)
def test_bad_container(tmp_path, name, content, words):
    sentence = sentence_for(tmp_path, content, name)
    assert all(word in sentence for word in words), sentence


def test_missing_file_and_folder(tmp_path):
    valve = Valve.from_dict(VALVE)
    with pytest.raises(InputError, match="no such file"):
        read_recording(tmp_path / "none.csv", valve)
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(InputError, match="this is a folder"):
        read_recording(tmp_path / "folder.csv", valve)


def test_valve_without_roles(tmp_path):
    (tmp_path / "r.csv").write_text(table())
    with pytest.raises(InputError, match=r"valve.toml: \[recording\] names no signal"):
        read_recording(tmp_path / "r.csv", Valve.from_dict({}, source="valve.toml"))


def test_percent_read_as_fraction(tmp_path):
    valve = {"recording": {**VALVE["recording"], "command": {"column": "CV", "unit": "1"}}}
    sentence = sentence_for(tmp_path, table(), valve=valve)
    assert all(
        word in sentence for word in ["column 'CV' (command)", "50 to 69", "unit '1'", "is the unit '%'"]
    )


def test_flows_of_two_kinds(tmp_path):
    valve = {"recording": {**VALVE["recording"], "simulated_flow": {"column": "S", "unit": "t/h"}}}
    file = tmp_path / "recording.csv"
    file.write_text(table(S=["1.0"] * ROWS))
    with pytest.raises(InputError, match="one is by mass, one by volume"):
        read_recording(file, Valve.from_dict(valve))


def test_temperature_below_zero_kelvin():
    frame = {"time": np.arange(5.0), "temperature": np.full(5, -3.0)}
    with pytest.raises(InputError, match="absolute zero"):
        Recording.from_frame(frame)


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ({"time": np.arange(5.0), "CV": np.ones(5)}, ["no column is named after a role", "give a Valve"]),
        ({"command": np.ones(5)}, ["no column 'time' for the time"]),
        ({"time": np.arange(5.0), "flow": np.ones(4)}, ["column 'flow' (flow)", "4 values, but 5 times"]),
        ({"time": np.arange(5.0), "flow": np.ones((5, 2))}, ["shape (5, 2)"]),
        ([1.0, 2.0], ["expected a data frame", "list"]),
    ],
)
def test_bad_frame(frame, words):
    with pytest.raises(InputError) as caught:
        Recording.from_frame(frame)
    assert all(word in str(caught.value) for word in words), str(caught.value)
