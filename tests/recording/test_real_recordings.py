# SPDX-License-Identifier: BSD-3-Clause
"""Recordings from elsewhere are read, and the screening does not cry wolf on them."""

import numpy as np
import pytest

from sklvalve.recording import Recording, Valve, read_recording, read_valve, screen_recording

CONCEALED = (
    "backlash",
    "choke_and_backlash",
    "choked_flow",
    "clogging",
    "in_no_catalogue",
    "nothing_closed_loop",
    "nothing_noisy",
    "nothing_wide",
    "seat_leakage",
    "stem_sensor",
    "stiction",
    "supply_drop",
)


@pytest.mark.parametrize("name", CONCEALED)
def test_concealed(data_folder, name):
    valve = read_valve(data_folder / "concealed" / name / "valve.toml")
    assert Valve.from_dict(valve.to_dict()) == valve
    for file in ("recording", "later"):
        recording = read_recording(data_folder / "concealed" / name / f"{file}.csv.gz", valve)
        assert recording.sample_time == 1.0
        assert recording.resolution("opening") == pytest.approx(5e-4, rel=1e-6)
        assert {found["finding"] for found in screen_recording(recording)} <= {"quantised"}


@pytest.mark.parametrize("tag", ["VA_A1", "VA_C1", "VA_C3"])
def test_water_network(data_folder, tag):
    recording = read_recording(
        data_folder / "watersafe" / "recording.csv", data_folder / "watersafe" / f"{tag}.toml"
    )
    assert len(recording) == 9700
    assert recording.constants == {"p2"}
    assert np.isnan(recording["flow"][0])
    assert recording.until("6000").stamps[-1] == 6000.0
    assert recording.after(6000).stamps[0] == 6001.0
    found = {(each["finding"], each["role"]) for each in screen_recording(recording)}
    # the supply pressure rests on multiples of 10 cmH2O, with other values only between two of them
    assert found == {("gap", "flow")} | ({("quantised", "p1")} if tag == "VA_A1" else set())


def test_an_hour_of_a_sugar_plant(data_folder):
    by_role = {"p1": "P74_00_kPa", "p2": "P74_01_kPa"}
    valve = Valve.from_dict(
        {
            "recording": {
                "time": "t_s",
                "command": {"column": "LC74_20CV_pct", "unit": "%", "sense": "closing"},
                "opening": {"column": "LC74_20X_pct", "unit": "%", "sense": "closing"},
                "flow": {"column": "F74_00_tph", "unit": "t/h"},
                "temperature": {"column": "T74_00_degC", "unit": "degC"},
                **{role: {"column": column, "unit": "kPa"} for role, column in by_role.items()},
            }
        }
    )
    recording = read_recording(data_folder / "damadics" / "actuator3_real_one_hour.csv", valve)
    assert recording.mass_flow
    assert recording["opening"][0] == pytest.approx(0.317, abs=1e-12)
    found = screen_recording(recording)
    assert [(each["finding"], each["role"]) for each in found] == [("quantised", "temperature")]


def test_iso_times_with_an_offset(data_folder):
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(data_folder / "belimo_actuator" / "campaign_20hz.csv.gz")
    valve = Valve.from_dict(
        {
            "recording": {
                "time": "timestamp",
                "command": {"column": "setpoint_position_%", "unit": "%"},
                "opening": {"column": "feedback_position_%", "unit": "%"},
            }
        }
    )
    for _, run in frame.groupby("test_id"):
        recording = Recording.from_frame(run, valve)
        assert 0.04 < recording.sample_time < 0.06
        assert {found["finding"] for found in screen_recording(recording)} <= {"gap", "quantised"}
