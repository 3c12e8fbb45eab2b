# SPDX-License-Identifier: BSD-3-Clause
"""Frames of pandas, polars and arrow: their units, their time zones, their time differences."""

from datetime import timedelta

import numpy as np
import pandas as pd
import polars as pl
import pytest

from sklvalve.recording import InputError, Recording, Valve

# the clocks change in this night
ZONED = pd.date_range("2024-03-31", periods=5, freq="h", tz="Europe/Berlin")
STAMPS = [moment.isoformat() for moment in ZONED]


def _arrow():
    pa = pytest.importorskip("pyarrow", reason="needs pyarrow, of the extra `io`")
    table = pa.Table.from_pandas(pd.DataFrame({"time": ZONED, "flow": np.arange(5.0)}))
    return {"time": table["time"], "flow": table["flow"]}


FRAMES = {
    "pandas": lambda: pd.DataFrame({"time": ZONED, "flow": np.arange(5.0)}),
    "polars": lambda: pl.DataFrame({"time": ZONED, "flow": np.arange(5.0)}),
    "polars ns": lambda: pl.DataFrame({"time": ZONED, "flow": np.arange(5.0)}).cast(
        {"time": pl.Datetime("ns", "Europe/Berlin")}
    ),
    "mapping of polars": lambda: {"time": pl.Series(list(ZONED)), "flow": np.arange(5.0)},
    "pandas on arrow": lambda: pd.DataFrame({"time": ZONED, "flow": np.arange(5.0)}).convert_dtypes(
        dtype_backend="pyarrow"
    ),
    "arrow": _arrow,
}


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_time_zones_are_kept(frame):
    recording = Recording.from_frame(frame())
    assert list(recording.stamps) == STAMPS
    np.testing.assert_array_equal(recording.time, 3600.0 * np.arange(5))
    assert recording.index_until("2024-03-31T01:00Z") == 3


def test_polars_without_a_zone_stays_without():
    frame = pl.DataFrame({"time": list(ZONED.tz_localize(None)), "flow": np.arange(5.0)})
    assert Recording.from_frame(frame).stamps[0] == "2024-03-31T00:00:00"


def test_a_zone_with_a_gap_in_time_is_told():
    frame = pl.DataFrame({"time": [ZONED[0].to_pydatetime(), None], "flow": [1.0, 2.0]})
    with pytest.raises(InputError, match="row 2: the time is missing"):
        Recording.from_frame(frame)


@pytest.mark.parametrize(
    "frame",
    [
        pd.DataFrame({"flow": np.arange(3.0)}, index=pd.to_timedelta([10, 20, 40], unit="s")),
        pd.DataFrame({"flow": np.arange(3.0)}, index=pd.TimedeltaIndex([10e9, 20e9, 40e9], name="time")),
        pd.DataFrame({"flow": np.arange(3.0), "time": pd.to_timedelta([10, 20, 40], unit="s")}),
        pl.DataFrame({"flow": np.arange(3.0), "time": [timedelta(seconds=k) for k in (10, 20, 40)]}),
        {"flow": np.arange(3.0), "time": [timedelta(seconds=k) for k in (10, 20, 40)]},
    ],
    ids=["index", "named index", "column", "polars", "list"],
)
def test_time_differences_are_seconds(frame):
    recording = Recording.from_frame(frame)
    np.testing.assert_array_equal(recording.stamps, [10.0, 20.0, 40.0])
    np.testing.assert_array_equal(recording.time, [0.0, 10.0, 30.0])
    assert recording.index_until(20.0) == 2


def test_a_missing_time_difference_is_told():
    frame = pd.DataFrame({"flow": np.arange(3.0)}, index=pd.to_timedelta([10, None, 40], unit="s"))
    with pytest.raises(InputError, match="row 2: the time is missing or infinite"):
        Recording.from_frame(frame)


TABLE = {"time": [0.0, 1.0], "p1": [5.0, 6.0], "command": [50.0, 25.0], "flow": [1e-3, 2e-3], "note": "ab"}


def test_units_of_columns():
    recording = Recording.from_frame(TABLE, units={"command": "%", "p1": "bar"})
    assert list(recording) == ["p1", "command", "flow"]
    np.testing.assert_allclose(recording["p1"], [5e5, 6e5])
    np.testing.assert_allclose(recording["command"], [0.5, 0.25])
    np.testing.assert_array_equal(recording["flow"], [1e-3, 2e-3])
    assert [recording.unit(role) for role in recording] == ["bar", "%", "m3/s"]


def test_units_as_a_section_of_the_sheet():
    units = {
        "p1": {"unit": "bar", "gauge": True},
        "command": {"unit": "%", "sense": "closing"},
        "flow": {"column": "note", "unit": "t/h"},
        "p2": {"constant": 1.0, "unit": "bar"},
    }
    recording = Recording.from_frame(TABLE | {"note": [3.6, 7.2]}, units=units)
    np.testing.assert_allclose(recording["p1"], [601325.0, 701325.0])
    np.testing.assert_allclose(recording["command"], [0.5, 0.75])
    np.testing.assert_allclose(recording["flow"], [1.0, 2.0])
    np.testing.assert_allclose(recording["p2"], 1e5)
    assert recording.mass_flow
    assert recording.constants == {"p2"}


def test_units_beside_a_sheet_without_roles():
    valve = Valve.from_dict({"valve": {"travel": 40.0, "kv_rated": 10.0}})
    recording = Recording.from_frame(
        {"time": [0.0, 1.0], "opening": [10.0, 20.0]}, valve, units={"opening": "mm"}
    )
    np.testing.assert_allclose(recording["opening"], [0.25, 0.5])
    assert recording.valve.kv_rated == 10.0


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ({"flow": "m3"}, r"data frame: units: \[recording.flow\] unit = 'm3' is no known unit of this role"),
        ({"flows": "m3/h"}, "units: .*is no known role; did you mean 'flow'"),
        ({"command": "%", "p2": "bar"}, "there is no column 'p2'"),
        ({"flow": 3.6}, "that of flow must be a text like"),
        ({"opening": "mm"}, "give the rated travel"),
    ],
)
def test_units_that_cannot_be_are_told(units, words):
    with pytest.raises(InputError, match=words):
        Recording.from_frame(TABLE, units=units)


def test_units_beside_a_sheet_that_has_them_are_refused():
    valve = Valve.from_dict({"recording": {"flow": {"column": "flow", "unit": "m3/h"}}})
    with pytest.raises(InputError, match="units are given beside valve, which says the units of its roles"):
        Recording.from_frame(TABLE, valve, units={"flow": "m3/h"})


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ("m3/h", "units must name one for each role, like {'flow': 'm3/h'}; got 'm3/h'"),
        ({"flow": None}, "that of flow must be a text like 'm3/h'; got None"),
    ],
)
def test_units_that_are_none_are_told(units, words):
    with pytest.raises(InputError, match=words):
        Recording.from_frame(TABLE, units=units)
