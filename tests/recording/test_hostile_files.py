# SPDX-License-Identifier: BSD-3-Clause
"""Files that would fill the memory, hang, or end the process: each is refused in one sentence."""

import gzip
import io
import os
import struct
import tracemalloc

import numpy as np
import pytest

from sklvalve.recording import InputError, Valve, files, read_recording, read_valve
from sklvalve.recording.errors import one_line
from sklvalve.recording.historian import ImportSettings, import_export
from sklvalve.recording.historian.text import read_text
from sklvalve.recording.reader import read_columns
from sklvalve.recording.spreadsheet import freed, marked
from tests.recording.historian.exports import course, iso, moments, wide_text

pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')


def refusal(read, *arguments, **settings):
    with pytest.raises(InputError) as caught:
        read(*arguments, **settings)
    sentence = str(caught.value)
    assert sentence.isprintable()
    assert len(sentence) <= 1000
    return sentence


def parquet_bytes(columns, **settings):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    target = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), target, **settings)
    return target.getvalue()


@pytest.fixture
def small(monkeypatch):
    """Limits of a thousandth, so that no test needs the memory that it guards."""
    for module in ("files", "parquet"):
        monkeypatch.setattr(f"sklvalve.recording.{module}.MOST_BYTES", 1 << 20)
    monkeypatch.setattr(files.unpack_gzip, "__defaults__", (1 << 20,))


@pytest.mark.parametrize("read", [read_columns, read_text])
def test_gzip_is_refused_while_it_grows(tmp_path, small, read):
    path = tmp_path / "bomb.csv.gz"
    path.write_bytes(gzip.compress(b"1,1\n" * (16 << 20)))  # 64 MiB out of 64 KiB
    tracemalloc.start()
    try:
        sentence = refusal(read, path)
        assert tracemalloc.get_traced_memory()[1] < 8 << 20
    finally:
        tracemalloc.stop()
    assert "unpacks from" in sentence
    assert "to more than 1 MiB" in sentence


def test_the_limits_are_those_of_a_computer():
    assert files.MOST_BYTES == 1 << 30
    assert files.unpack_gzip.__defaults__ == (1 << 30,)


def test_a_table_of_too_many_cells(tmp_path, monkeypatch):
    monkeypatch.setattr("sklvalve.recording.reader.MOST_CELLS", 1000)
    path = tmp_path / "wide.csv"
    path.write_text(",".join("abcdefghij") + "\n" + (",".join("1" * 10) + "\n") * 200)
    assert "more than 1000; split" in refusal(read_columns, path)


def test_parquet_is_refused_by_what_it_declares(tmp_path, small):
    path = tmp_path / "bomb.parquet"
    content = parquet_bytes({"x": np.zeros(400_000)}, use_dictionary=False, compression="zstd")
    assert len(content) < 100_000
    path.write_bytes(content)
    assert "unpacks to 3.0" in refusal(read_columns, path)


def test_parquet_of_too_many_rows(tmp_path, monkeypatch):
    monkeypatch.setattr("sklvalve.recording.parquet.MOST_CELLS", 1000)
    path = tmp_path / "long.parquet"
    path.write_bytes(parquet_bytes({"x": np.zeros(2000)}))
    assert "declares 2000 rows of 1 columns, more than 1000 cells" in refusal(read_columns, path)


def test_one_long_text_in_every_row_stays_one_text(tmp_path):
    path = tmp_path / "text.parquet"
    text = "x" * 500_000
    pyarrow = pytest.importorskip("pyarrow")
    notes = pyarrow.DictionaryArray.from_arrays(np.zeros(10_000, dtype=np.int32), [text])
    # 5 GB where each row has its own
    path.write_bytes(parquet_bytes({"t": np.arange(10_000.0), "note": notes}, store_schema=False))
    assert path.stat().st_size < 2_000_000
    cells = read_columns(path).columns["note"]
    assert cells[0] == text
    assert all(cell is cells[0] for cell in cells)


def test_parquet_columns_of_every_kind_come_as_before(tmp_path):
    import pandas

    frame = pandas.DataFrame(
        {
            "when": pandas.date_range("2024-01-01", periods=3, freq="s"),
            "zoned": pandas.date_range("2024-01-01", periods=3, freq="s", tz="Europe/Warsaw"),
            "text": ["a", None, "b"],
            "category": pandas.Categorical(["on", "off", "on"]),
            "int": [1, 2, 3],
            "gaps": pandas.array([1, None, 3], dtype="Int64"),
            "flag": [True, False, True],
            "list": [[1], [2], [3]],
        }
    ).set_index(pandas.RangeIndex(5, 11, 2, name="t"))
    path = tmp_path / "kinds.parquet"
    frame.to_parquet(path)
    columns = read_columns(path).columns
    assert list(columns) == ["t", *frame.columns]
    assert columns["t"].tolist() == [5, 7, 9]
    assert columns["when"].dtype.kind == "M"
    assert columns["zoned"][0].isoformat() == "2024-01-01T00:00:00+01:00"
    assert columns["text"].tolist() == ["a", None, "b"]
    assert columns["category"].tolist() == ["on", "off", "on"]
    assert columns["flag"].tolist() == [True, False, True]
    np.testing.assert_array_equal(columns["gaps"].astype(float), [1.0, np.nan, 3.0])
    assert "list" in columns["list"][0]


def _thrift_histogram(content):
    """A file whose size statistics contradict its schema: asked about them, pyarrow ends the process."""
    length = struct.unpack("<I", content[-8:-4])[0]
    footer = content[-8 - length : -8]
    return content[: -8 - length], footer


@pytest.mark.parametrize("place", range(0, 600, 7))
def test_a_damaged_footer_ends_no_process(tmp_path, place):
    content = bytearray(parquet_bytes({"t": np.arange(50.0), "F": [None, 1.0] * 25, "s": ["a"] * 50}))
    body, footer = _thrift_histogram(bytes(content))
    content[len(body) + place % len(footer)] ^= 1 << (place % 8)
    path = tmp_path / "damaged.parquet"
    path.write_bytes(content)
    try:
        columns = read_columns(path).columns
    except InputError:
        return
    assert {len(values) for values in columns.values()} == {50}


@pytest.mark.parametrize("notes", [b"", b"[]", b"{}", b'{"index_columns": [{"kind": "range"}]}', b"[" * 9999])
def test_damaged_notes_of_pandas_are_not_needed(tmp_path, notes):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    table = pyarrow.table({"t": [0.0, 1.0]}).replace_schema_metadata({b"pandas": notes})
    parquet.write_table(table, tmp_path / "r.parquet")
    assert read_columns(tmp_path / "r.parquet").columns["t"].tolist() == [0.0, 1.0]


@pytest.mark.parametrize("reader", [read_columns, read_text, read_valve])
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path, reader):
    path = tmp_path / "pipe.csv" if reader is not read_valve else tmp_path / "valve.toml"
    os.mkfifo(path)
    assert "is a pipe or a device" in refusal(reader, path)


def test_a_cell_of_a_million_letters(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time,F\n" + f'0,"{"=" * 200_000}"\n' + "".join(f"{k},1\n" for k in range(1, 20)))
    assert "is no line of a table" in refusal(import_export, [path])
    valve = Valve.from_dict({"recording": {"flow": {"column": "F", "unit": "m3/h"}}})
    assert "'===" in refusal(read_recording, path, valve)
    path.write_text("x" * 2_000_000)
    assert "longer than 1000000 letters" in refusal(import_export, [path])


@pytest.mark.slow
@pytest.mark.parametrize(
    "cell", ["1" * 100_000, "9" * 60_000 + "mm" * 30_000 + "7" + "x" * 9 + "7", "a" * 90_000]
)
def test_a_long_cell_takes_no_minutes(tmp_path, cell):
    path = tmp_path / "r.csv"
    rows = wide_text(["F"], iso(moments("2024-01-01 00:00:00", 20, 1)), [[cell, *["1"] * 19]])
    path.write_text(rows)
    assert import_export([path]).account["tags"]["F"]["reports"] == 20


@pytest.mark.parametrize("content", [";", ";;;\n;;;\n", ",\n,,\n", "\t\t\n", "sep=;\n;;\n"])
def test_separators_and_nothing_else(tmp_path, content):
    path = tmp_path / "r.csv"
    path.write_text(content)
    refusal(import_export, [path])
    refusal(read_columns, path)


@pytest.mark.parametrize("mark", ['"', "a", " ", "'"])
def test_a_first_line_that_names_no_separator(tmp_path, mark):
    path = tmp_path / "r.csv"
    path.write_text(
        f"sep={mark}\n" + wide_text(["F"], iso(moments("2024-01-01 00:00:00", 20, 1)), [course(20)])
    )
    assert len(import_export([path]).stamps) == 20


@pytest.mark.parametrize("far", ["1e13", "1e300", "-1e17", "9" * 30])
def test_a_time_that_no_calendar_holds(tmp_path, far):
    path = tmp_path / "r.csv"
    path.write_text("time,F\n" + "".join(f"{k},1.5\n" for k in range(20)) + f"{far},2\n")
    assert "beyond the years that a calendar holds" in refusal(import_export, [path])


def test_two_far_times_have_no_row_for_each_second(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time,F\n-6e10,1\n-59999999999,1\n2e11,2\n")
    assert "more than 5000000" in refusal(import_export, [path])


@pytest.mark.parametrize("stamp", ["9999-12-31 23:59:59", "0001-01-01 00:00:00", "0000-00-00 00:00:00"])
@pytest.mark.parametrize("zone", [None, "Europe/Warsaw", "+14:00"])
def test_the_ends_of_the_calendar(tmp_path, stamp, zone):
    path = tmp_path / "r.csv"
    path.write_text("time,F\n" + f"{stamp},1.5\n" * 20)
    refusal(import_export, [path], ImportSettings(zone=zone))


def test_dates_that_no_order_reads(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time,F\n" + "00/00/2024 10:00:00,1.5\n" * 3)
    assert "is no time" in refusal(import_export, [path])


@pytest.mark.parametrize("gap", [1e308, 1e7, float("inf"), float("nan"), -1.0])
def test_a_foolish_gap(tmp_path, gap):
    assert "--gap" in refusal(import_export, [tmp_path / "r.csv"], ImportSettings(gap=gap))


@pytest.mark.parametrize(
    "name", ["zip", "idna", "punycode", "undefined", "unicode_escape", "rot13", "no\0such", "x" * 500]
)
def test_a_foolish_encoding(tmp_path, name):
    path = tmp_path / "r.csv"
    path.write_bytes(b"time;F\xb3\n1;2\n")
    assert "no such encoding" in refusal(import_export, [path], ImportSettings(encoding=name))


@pytest.mark.parametrize(("unit", "value"), [("MPa", "1e308"), ("kPa", "-1e306"), ("bar", "1e307")])
def test_a_number_that_is_none_in_si(tmp_path, unit, value):
    path = tmp_path / "r.csv"
    path.write_text("time,P\n" + "".join(f"{k},{value if k == 7 else 5}\n" for k in range(20)))
    data = {"recording": {"p1": {"column": "P", "unit": unit}}}
    assert "row 8" in refusal(read_recording, path, Valve.from_dict(data))
    data = {
        "recording": {"p1": {"column": "P", "unit": "Pa"}, "p2": {"constant": float(value), "unit": unit}}
    }
    assert "beyond all numbers in Pa" in refusal(read_recording, path, Valve.from_dict(data))


@pytest.mark.parametrize(
    ("section", "key"),
    [
        ("fluid", "critical_pressure"),
        ("fluid", "vapour_pressure"),
        ("fluid", "density"),
        ("fluid", "kinematic_viscosity"),
        ("fluid", "molar_mass"),
        ("fluid", "heat_capacity_ratio"),
        ("valve", "travel"),
        ("valve", "rangeability"),
        ("actuator", "effective_area"),
    ],
)
def test_a_sheet_without_bounds(section, key):
    for value in (1e308, 1e12):
        assert f"[{section}] {key} must be" in refusal(Valve.from_dict, {section: {key: value}})


@pytest.mark.parametrize("times", [["0", "1e308", "1.5e308"], ["-1e308", "0", "1e308"]])
def test_seconds_that_no_difference_holds(tmp_path, times):
    path = tmp_path / "r.csv"
    rows = [*times, *(f"{1.5 + k / 100}e308" for k in range(1, 20))]
    path.write_text("time,F\n" + "".join(f"{time},1\n" for time in rows))
    valve = Valve.from_dict({"recording": {"flow": {"column": "F", "unit": "m3/h"}}})
    assert "s from the first" in refusal(read_recording, path, valve)


def test_a_vapour_pressure_of_nought_is_none():
    # the choked flow of a simulation would ask for one above it in the midst of its work
    assert "vapour_pressure must be above 0" in refusal(Valve.from_dict, {"fluid": {"vapour_pressure": 0.0}})


HOSTILE = "\x1b]0;owned\x07\x1b[2J‮\x85"


def test_a_message_holds_nothing_that_a_terminal_obeys(tmp_path):
    sentence = str(InputError(f"{HOSTILE}: no\nsuch column"))
    assert sentence == one_line(sentence)
    assert sentence == "\\x1b]0;owned\\x07\\x1b[2J\\u202e\\x85: no\\nsuch column"
    path = tmp_path / "r.csv"
    path.write_text(f"time,{HOSTILE}\n" + "0,1\n" * 20, encoding="utf-8")
    refusal(read_recording, path, Valve.from_dict({"recording": {"flow": {"column": "F", "unit": "m3/h"}}}))


def test_long_names_are_cut(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(",".join(f"{'n' * 5000}{k}" for k in range(500)) + "\n" + ",".join("1" * 500) + "\n")
    valve = Valve.from_dict({"recording": {"time": "t" * 9000, "flow": {"column": "F", "unit": "m3/h"}}})
    path.write_text(path.read_text() + (",".join("1" * 500) + "\n") * 20)
    sentence = refusal(read_recording, path, valve)
    assert "correct time in [recording]" in sentence
    assert len(max(sentence.split(), key=len)) < 150


@pytest.mark.parametrize(
    "name", ["=1+1", "+A1", "-5", "@SUM(A1)", "'=x", "''=x", "'quoted'", "FIC-1.PV", "plain"]
)
def test_a_name_that_a_spreadsheet_would_compute_comes_back(tmp_path, name):
    from sklvalve.recording.historian.write import write_recording

    assert freed(marked(name)) == name
    assert not marked(name).startswith(("=", "+", "-", "@"))
    path = tmp_path / "r.csv"
    write_recording(path, np.arange(12.0), {name: np.arange(12.0), "x": np.ones(12)})
    head = path.read_text().splitlines()[0].split(",")[1].strip('"')
    assert not head.startswith(("=", "+", "-", "@"))
    assert name in read_columns(path).columns
    # and by the import, which reads what it wrote
    assert name in import_export([path]).columns


def test_a_line_of_a_hundred_thousand_columns(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(",".join(f"c{k}" for k in range(100_000)) + "\n")
    assert "more than 20000; export fewer" in refusal(read_columns, path)
    assert "more than 20000; export fewer" in refusal(import_export, [path])
