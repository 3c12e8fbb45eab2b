# SPDX-License-Identifier: BSD-3-Clause
import gzip
import hashlib
import pickle

import numpy as np
import pandas as pd
import polars as pl
import pytest

from sklvalve.recording import InputError, Recording, Valve, read_recording

N = 24
DAMADICS_LIKE = {
    "valve": {"travel": 38.1},
    "recording": {
        "time": "t",
        "command": {"column": "CV", "unit": "%", "sense": "closing"},
        "opening": {"column": "X", "unit": "mm"},
        "p1": {"column": "P1", "unit": "bar", "gauge": True},
        "p2": {"constant": 0.0, "unit": "bar", "gauge": True},
        "temperature": {"column": "T", "unit": "degC"},
        "flow": {"column": "F", "unit": "t/h"},
    },
}


@pytest.fixture
def frame():
    flow = 3.6 * np.round(np.linspace(1.0, 2.0, N), 2)
    flow[5] = np.nan
    return pd.DataFrame(
        {
            "t": np.arange(N) * 2.0 + 100.0,
            "CV": np.round(np.linspace(100.0, 10.0, N), 1),
            "X": np.round(np.linspace(0.0, 38.1, N), 1),
            "P1": np.full(N, 3.0),
            "T": np.full(N, 20.0),
            "F": flow,
            "remark": ["ok"] * N,
        }
    )


def check(recording, frame):
    assert len(recording) == N
    assert recording.sample_time == 2.0
    assert list(recording) == ["command", "opening", "p1", "p2", "temperature", "flow"]
    np.testing.assert_allclose(recording["command"], 1.0 - frame["CV"] / 100.0, atol=1e-12)
    np.testing.assert_allclose(recording["opening"], frame["X"] / 38.1, atol=1e-12)
    np.testing.assert_allclose(recording["p1"], 401325.0)
    np.testing.assert_allclose(recording["p2"], 101325.0)
    np.testing.assert_allclose(recording["temperature"], 293.15)
    np.testing.assert_allclose(recording["flow"], frame["F"] / 3.6)
    assert np.isnan(recording["flow"][5]), "a gap stays a gap"
    assert recording.mass_flow
    assert recording.constants == {"p2"}


def write(frame, file):
    if file.name.endswith(".parquet"):
        frame.to_parquet(file)
    else:
        text = frame.to_csv(index=False)
        file.write_bytes(gzip.compress(text.encode()) if file.suffix == ".gz" else text.encode())


@pytest.mark.parametrize("name", ["r.csv", "r.csv.gz", "r.parquet", "R.CSV"])
def test_files(tmp_path, frame, name):
    file = tmp_path / name
    write(frame, file)
    recording = read_recording(file, Valve.from_dict(DAMADICS_LIKE))
    check(recording, frame)
    assert recording.source == str(file)
    assert recording.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    assert recording.stamps[0] == 100.0
    assert recording.time[0] == 0.0


def test_loose_csv(tmp_path, frame):
    text = frame.to_csv(index=False, lineterminator="\r\n", na_rep="NaN")
    file = tmp_path / "r.csv"
    file.write_bytes(b"\xef\xbb\xbf" + text.replace(",", ", ").encode() + b"\r\n\r\n")
    check(read_recording(file, Valve.from_dict(DAMADICS_LIKE)), frame)


def test_valve_by_path(tmp_path, frame):
    write(frame, tmp_path / "r.csv")
    (tmp_path / "v.toml").write_text('[recording]\ntime="t"\n[recording.flow]\ncolumn="F"\nunit="m3/h"\n')
    recording = read_recording(tmp_path / "r.csv", tmp_path / "v.toml")
    assert not recording.mass_flow
    assert recording["flow"][0] == pytest.approx(1e-3)


@pytest.mark.parametrize("make", [lambda f: f, pl.from_pandas, dict], ids=["pandas", "polars", "mapping"])
def test_frames_with_a_valve(frame, make):
    check(Recording.from_frame(make(frame), Valve.from_dict(DAMADICS_LIKE)), frame)


def test_frame_round_trip(frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    table = recording.to_frame()
    assert list(table.columns) == list(recording)
    assert table.index.name == "time"
    again = Recording.from_frame(table)
    for role in recording:
        np.testing.assert_array_equal(again[role], recording[role])
    np.testing.assert_array_equal(again.time, recording.time)
    pd.testing.assert_frame_equal(again.to_frame(), table)


def test_parquet_of_a_frame_keeps_its_index(tmp_path, frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    recording.to_frame().to_parquet(tmp_path / "si.parquet")
    valve = Valve.from_dict({"recording": {"flow": {"column": "flow", "unit": "kg/s"}}})
    read = read_recording(tmp_path / "si.parquet", valve)
    np.testing.assert_array_equal(read["flow"], recording["flow"])
    np.testing.assert_array_equal(read.time, recording.time)


def test_back_to_recorded_units(frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    for role, column in {
        "command": "CV",
        "opening": "X",
        "p1": "P1",
        "temperature": "T",
        "flow": "F",
    }.items():
        np.testing.assert_allclose(
            recording.in_recorded_units(role, recording[role]), frame[column], atol=1e-9
        )
    assert [recording.unit(role) for role in ("command", "opening", "p1", "p2", "flow")] == [
        "%", "mm", "bar", "bar", "t/h",
    ]  # fmt: skip


def test_role_not_recorded_is_written_as_its_kin(frame):
    recording = Recording.from_frame(
        frame, Valve.from_dict({"recording": {"time": "t", "command": DAMADICS_LIKE["recording"]["command"]}})
    )
    assert recording.unit("opening") == "%"
    np.testing.assert_allclose(recording.in_recorded_units("opening", [0.25]), [75.0])
    assert recording.unit("flow") == "m3/s"
    assert recording.unit("p1") == "Pa"
    with pytest.raises(InputError, match="'pressure' is no role"):
        recording.unit("pressure")


def test_resolution(frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    assert recording.resolution("p1") == 0.0
    assert recording.resolution("flow") == pytest.approx(0.04, rel=1e-9)
    assert recording.resolution("opening") == pytest.approx(1.6 / 38.1, rel=1e-9)
    steps = Recording.from_frame({"time": np.arange(50.0), "p1": 1e5 + 250.0 * (np.arange(50) % 7)})
    assert steps.resolution("p1") == pytest.approx(250.0, rel=1e-9)


def test_slices(frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    part = recording.slice(3, 8)
    assert len(part) == 5
    np.testing.assert_array_equal(part["flow"], recording["flow"][3:8])
    np.testing.assert_array_equal(part.stamps, recording.stamps[3:8])
    np.testing.assert_array_equal(part.time, recording.time[3:8])
    assert part.constants == recording.constants
    assert len(recording.slice(None, None)) == N


def test_access(frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    assert "flow" in recording
    assert "setpoint" not in recording
    assert recording.get("setpoint") is None
    assert recording.get("setpoint", recording["flow"]) is recording["flow"]
    with pytest.raises(InputError, match="there is no setpoint; the recording holds command, opening"):
        recording["setpoint"]
    with pytest.raises(InputError, match="did you mean 'opening'"):
        recording["openning"]
    with pytest.raises(AttributeError):
        recording.mass_flow = False


def test_pickle(frame):
    recording = Recording.from_frame(frame, Valve.from_dict(DAMADICS_LIKE))
    again = pickle.loads(pickle.dumps(recording))
    np.testing.assert_array_equal(again["flow"], recording["flow"])
    assert again.valve == recording.valve


def test_nullable_and_object_columns_keep_gaps():
    frame = pd.DataFrame(
        {
            "time": pd.array(range(5), dtype="Int64"),
            "flow": pd.array([1.0, None, 3.0, 4.0, 5.0], dtype="Float64"),
            "p1": [2e5, None, "3e5", np.nan, " "],
        }
    )
    recording = Recording.from_frame(frame)
    np.testing.assert_array_equal(recording["flow"], [1.0, np.nan, 3.0, 4.0, 5.0])
    np.testing.assert_array_equal(recording["p1"], [2e5, np.nan, 3e5, np.nan, np.nan])
