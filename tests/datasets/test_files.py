# SPDX-License-Identifier: BSD-3-Clause
"""Files of concealed records, the draw of many, and loaders of published recordings."""

import json
import os
import runpy
import tomllib
from pathlib import Path

import pytest

from sklvalve.datasets import (
    load_belimo,
    load_concealed,
    load_refinery_loops,
    load_watersafe,
    write_concealed,
)
from sklvalve.datasets.concealed import to_toml

pd = pytest.importorskip("pandas")
SHORT = {"n_samples": 300, "n_later": 40, "random_state": 1}
FILES = {"recording.csv.gz", "later.csv.gz", "valve.toml", "truth.json", "flow_without_noise.csv.gz"}
MAKE = Path(__file__).parents[2] / "benchmarks" / "trial" / "make.py"


@pytest.fixture
def data():
    folder = os.environ.get("SKLVALVE_DATA")
    if not folder or not Path(folder).is_dir():
        pytest.skip("SKLVALVE_DATA names no folder of recordings")
    return Path(folder)


def test_written_record_reads_back(tmp_path):
    truth = write_concealed(tmp_path / "blind", "backlash", 0.05, **SHORT)
    assert {path.name for path in (tmp_path / "blind").iterdir()} == FILES
    record = load_concealed(tmp_path, "blind")
    assert record.truth == truth
    assert record.truth["name"] == "blind"
    assert record.valve["valve"]["tag"] == "blind"
    assert record.valve["recording"]["p1"] == {"column": "P1", "unit": "kPa", "gauge": False}
    assert list(record.frame.columns[:7]) == ["time", "CV", "X", "P1", "P2", "T1", "F"]
    assert len(record.frame) == 300
    assert len(record.later) == 40
    assert len(record.flow_without_noise) == 340


def test_same_seed_writes_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        write_concealed(tmp_path / folder, "clogging", name="same", **SHORT)
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_truth_cannot_be_left_out(tmp_path):
    with pytest.raises(ValueError, match="return_truth"):
        write_concealed(tmp_path, return_truth=False)
    assert list(tmp_path.iterdir()) == []


def test_toml_round_trip():
    tables = {
        "a": {"x": 1.5, "s": 'say "so"', "b": True, "l": [1.0, 2.0], "c": {"n": 0, "m": {"k": []}}},
        "d": {},
    }
    assert tomllib.loads(to_toml(tables)) == tables


def test_draw_of_many_names_nothing_in_the_folder_and_seals_the_truth(tmp_path, monkeypatch):
    main = runpy.run_path(str(MAKE))["main"]
    main([str(tmp_path), "--seed", "3", "--healthy", "2", "--each", "1", "--effects", "backlash"])
    records = sorted(path for path in tmp_path.iterdir() if path.is_dir())
    assert [path.name for path in records] == ["record_000", "record_001", "record_002"]
    truths = [json.loads((path / "truth.json").read_text()) for path in records]
    assert sorted(truth["verdict"] for truth in truths) == ["named", "no_mismatch", "no_mismatch"]
    for path in records:
        assert "backlash" not in (path / "valve.toml").read_text()
    assert len((tmp_path / "seal.txt").read_text().splitlines()) == 3


def test_missing_files_are_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"recording\.csv in"):
        load_watersafe(tmp_path)
    with pytest.raises(FileNotFoundError, match="the records there are: none"):
        load_concealed(tmp_path, "backlash")
    write_concealed(tmp_path / "here", **SHORT)
    with pytest.raises(FileNotFoundError, match="the records there are: here"):
        load_concealed(tmp_path, "gone")
    with pytest.raises(FileNotFoundError, match=r"index\.csv"):
        load_refinery_loops(tmp_path)
    (tmp_path / "campaign_20hz.csv.gz").write_bytes((tmp_path / "here" / "later.csv.gz").read_bytes())
    with pytest.raises(ValueError, match="Expected the column timestamp"):
        load_belimo(tmp_path)


def test_published_recordings_load(data):
    watersafe = load_watersafe(data / "watersafe")
    assert len(watersafe.frame) == 9700
    assert set(watersafe.valves) == {"VA_A1", "VA_C1", "VA_C3"}
    loops = load_refinery_loops(data / "refinery_loops")
    assert len(loops.index) == 62
    assert set(loops.frame["id"]) == set(loops.index["id"])
    belimo = load_belimo(data / "belimo_actuator")
    assert belimo.frame["test_id"].nunique() == 11
    assert (belimo.frame["time"] >= 0.0).all()
    assert len(load_concealed(data / "concealed", "backlash").frame) == 5760


def test_written_records_are_read_by_the_recording_layer(tmp_path):
    recording = pytest.importorskip("sklvalve.recording")
    for i, loop in enumerate(("wide", "mixed")):
        folder = tmp_path / str(i)
        write_concealed(folder, "seat_leakage", loop=loop, **SHORT)
        read = recording.read_recording(
            folder / "recording.csv.gz", recording.read_valve(folder / "valve.toml")
        )
        table = pd.read_csv(folder / "recording.csv.gz")
        assert len(table) == 300
        assert read["p1"][0] == pytest.approx(1e3 * table["P1"].iloc[0])
