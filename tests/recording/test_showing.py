# SPDX-License-Identifier: BSD-3-Clause
"""A recording in a line, as a table, as a picture, and as a data frame in recorded units."""

import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from sklvalve.recording import InputError, Recording, Valve, join_recordings

LAYOUT = {
    "valve": {"travel": 40.0},
    "recording": {
        "command": {"column": "CV", "unit": "%", "sense": "closing"},
        "opening": {"column": "X", "unit": "mm"},
        "p1": {"column": "P1", "unit": "bar", "gauge": True},
        "p2": {"constant": 0.0, "unit": "bar", "gauge": True},
        "flow": {"column": "F", "unit": "m3/h"},
    },
}
FLOW = np.array([3.6, np.nan, 7.2, 5.4])


def recording(time=(100.0, 102.0, 104.0, 106.0), **layout):
    columns = {
        "time": list(time),
        "CV": np.array([100.0, 75.0, 50.0, 0.0]),
        "X": np.array([0.0, 10.0, 20.0, 40.0]),
        "P1": np.full(4, 3.0),
        "F": FLOW,
    }
    return Recording.from_frame(columns, Valve.from_dict(LAYOUT | layout))


DATES = [f"2024-06-28T{hour}:00:00+02:00" for hour in ("10", "11", "12", "13")]


def test_in_one_line():
    assert repr(recording()) == (
        "<Recording data frame: 4 rows, 2 s apart, from 100 s to 106 s; command [%, closing], opening [mm], "
        "p1 [bar, gauge], p2 [bar, gauge], flow [m3/h]>"
    )
    assert "1 row, from 100 s to 100 s" in repr(recording().slice(0, 1))
    assert "no rows" in repr(recording().slice(0, 0))
    assert "in 2 recordings" in repr(join_recordings([recording(), recording([0.0, 1.0, 2.0, 3.0])]))


def cells(page):
    return [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", page)[1:]]


def test_as_a_table():
    page = recording(DATES)._repr_html_()
    assert "4 rows, 3600 s apart, from 2024-06-28T10:00:00+02:00 to 2024-06-28T13:00:00+02:00" in page
    assert cells(page) == [
        ["command", "CV", "%, closing", "0", "62.5", "100", "0"],
        ["opening", "X", "mm", "0", "15", "40", "0"],
        ["p1", "P1", "bar, gauge", "3", "3", "3", "0"],
        ["p2", "constant", "bar, gauge", "0", "0", "0", "0"],
        ["flow", "F", "m3/h", "3.6", "5.4", "7.2", "1"],
    ]


def test_names_from_elsewhere_never_become_html_or_reach_the_terminal_raw():
    evil = "<script>alert(1)</script>\x1b[2J"
    made = Recording.from_frame(
        {"time": [0.0, 1.0], evil: [1.0, 2.0]},
        Valve.from_dict({"recording": {"flow": {"column": evil, "unit": "m3/h"}}}),
    )
    made = replace(made, source=f"{evil}.csv", stamps=np.array([evil, evil], dtype=object))
    page = made._repr_html_()
    assert "<script" not in page
    assert page.count("&lt;script&gt;alert(1)&lt;/script&gt;") == 4
    assert "\x1b" not in page
    assert "\x1b" not in repr(made)


def test_a_recording_without_rows_or_values_is_shown_too():
    made = recording()
    assert ["flow", "F", "m3/h", "", "", "", "0"] in cells(made.slice(0, 0)._repr_html_())
    assert ["flow", "F", "m3/h", "", "", "", "1"] in cells(made.slice(1, 2)._repr_html_())


def test_frame_in_recorded_units():
    made = recording()
    frame = made.to_frame(units="recorded")
    assert list(frame.index) == [100.0, 102.0, 104.0, 106.0]
    assert frame.index.name == "time"
    assert list(frame.columns) == ["command", "opening", "p1", "p2", "flow"]
    np.testing.assert_allclose(frame["command"], [100.0, 75.0, 50.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(frame["opening"], [0.0, 10.0, 20.0, 40.0], atol=1e-12)
    np.testing.assert_allclose(frame["p1"], 3.0)
    np.testing.assert_allclose(frame["flow"], FLOW)
    assert frame.attrs["units"] == {
        "command": "%", "opening": "mm", "p1": "bar", "p2": "bar", "flow": "m3/h",
    }  # fmt: skip
    with pytest.raises(ValueError, match='units must be "si" or "recorded"; got \'bar\''):
        made.to_frame(units="bar")


def test_frame_in_recorded_units_has_its_dates():
    index = recording(DATES).to_frame(units="recorded").index
    assert list(index) == [pd.Timestamp(date) for date in DATES]
    assert index[0].isoformat() == DATES[0]
    changed = [f"2024-10-27T{time}" for time in ("02:00+02:00", "02:00+01:00", "03:00+01:00", "03:30Z")]
    index = recording(changed).to_frame(units="recorded").index
    assert list(index) == [pd.Timestamp(date) for date in changed]
    naive = recording(["2024-06-28 10:00", "2024-06-28 10:01", "2024-06-28 10:02", "2024-06-28 10:03"])
    assert naive.to_frame(units="recorded").index[1] == pd.Timestamp("2024-06-28 10:01")


def test_a_frame_in_recorded_units_is_a_recording_again():
    plain = {"time": [0.0, 1.0, 2.0], "command": [0.0, 50.0, 100.0], "flow": [3.6, np.nan, 7.2]}
    made = Recording.from_frame(plain, units={"command": "%", "flow": "m3/h"})
    frame = made.to_frame(units="recorded")
    again = Recording.from_frame(frame, units=frame.attrs["units"])
    for role in made:
        np.testing.assert_array_equal(again[role], made[role])


class TestPlot:
    @pytest.fixture(autouse=True)
    def _no_window(self):
        matplotlib = pytest.importorskip("matplotlib", reason="needs matplotlib, of the extra `plot`")
        matplotlib.use("Agg")
        yield
        matplotlib.pyplot.close("all")

    def test_one_panel_for_each_kind_and_unit(self):
        axes = recording().plot()
        assert [ax.get_ylabel() for ax in axes] == ["[%, closing]", "[mm]", "[bar, gauge]", "[m3/h]"]
        assert axes[-1].get_xlabel() == "time [s]"
        (line,) = axes[-1].lines
        np.testing.assert_array_equal(line.get_xdata(), [100.0, 102.0, 104.0, 106.0])
        np.testing.assert_allclose(line.get_ydata(), FLOW)
        assert line.get_label() == "flow"

    def test_signals_of_one_unit_share_a_panel_and_the_measured_one_stands_before(self):
        frame = {"time": [0.0, 1.0], "command": [0.0, 100.0], "opening": [0.0, 90.0]}
        (ax,) = Recording.from_frame(frame, units={"command": "%", "opening": "%"}).plot()
        opening, command = ax.lines
        assert [opening.get_label(), command.get_label()] == ["opening", "command"]
        assert opening.get_zorder() > command.get_zorder()

    def test_dates_where_there_are_dates(self):
        (ax,) = recording(DATES).plot("flow")
        assert ax.get_xlabel() == "time (UTC+02:00)"
        shown = ax.lines[0].get_xdata().astype("datetime64[us]")
        assert list(shown) == [np.datetime64(date[:-6]) for date in DATES]
        (ax,) = recording([date[:-6] for date in DATES]).plot("flow")
        assert ax.get_xlabel() == "time"
        (ax,) = recording([f"{date[:-6]}Z" for date in DATES]).plot("flow")
        assert ax.get_xlabel() == "time (UTC)"

    def test_joined_recordings_are_lines_apart(self):
        both = join_recordings([recording(), recording([0.0, 1.0, 2.0, 3.0])])
        (ax,) = both.plot(["flow"])
        one, other, border = ax.lines
        assert len(one.get_xdata()) == len(other.get_xdata()) == 4
        assert one.get_color() == other.get_color()
        assert border.get_xdata()[0] == both.time[4]
        assert ax.get_xlabel() == "time from the first sample [s]"

    def test_many_rows_are_thinned_and_keep_their_peaks(self):
        values = np.zeros(100_000)
        values[77_777] = 1.0
        (ax,) = Recording.from_frame({"time": np.arange(100_000.0), "command": values}).plot()
        (line,) = ax.lines
        assert len(line.get_xdata()) <= 3000
        assert line.get_ydata().max() == 1.0

    def test_on_axes_of_ones_own(self):
        from matplotlib.figure import Figure

        axes = Figure().subplots(2)
        assert list(recording().plot(["flow", "p1"], ax=axes)) == list(axes)
        with pytest.raises(ValueError, match="ax must hold 2 axes, one for each kind"):
            recording().plot(["flow", "p1"], ax=axes[:1])

    def test_what_cannot_be_drawn_is_told(self):
        with pytest.raises(InputError, match="there is no temperature"):
            recording().plot("temperature")
        with pytest.raises(InputError, match="there is nothing to draw"):
            recording().plot([])
        with pytest.raises(InputError, match="there is nothing to draw"):
            recording().slice(0, 0).plot()


@pytest.mark.parametrize("roles", [5, [5], b"flow", np.array(5)])
def test_a_number_is_no_role_to_draw(roles):
    with pytest.raises(InputError, match=r"roles is .*; give one role, such as 'flow', or a list"):
        recording().plot(roles)


def test_matplotlib_is_loaded_when_something_is_drawn():
    code = "import sys, sklvalve.recording; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
