# SPDX-License-Identifier: BSD-3-Clause
"""What is drafted from any table of tags, the reader accepts."""

import tomllib

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.recording import Recording, Valve
from sklvalve.recording.draft import draft_valve, read_recording_columns

N = 150
COURSE = np.sin(np.arange(N) / 9.0)
TAGS = (
    "FIC101", "FIC-102", "TIC7", "LIC20", "PIC33", "PT101A", "PT-101B", "TT5", "ZT101", "FV101", "XV9", "P1",
    "P2", "T1", "X", "CV", "F", "Heating Coil Valve", "AHU: Supply Air Temperature", "Druck vor Ventil",
    "Stellsignal", "Przepływ", "power", "2111FIC40102C", "LC74_20", "P74_00", "P74_01", "VA_A1", "alpha",
    "actuator pressure", "instrument air pressure", "flow simulated", "model opening", "pressure in",
)  # fmt: skip
PATHS = ("", "\\\\SRV\\PLANT\\", "Plant/Area 3/", "ns=2;s=Unit.", "Plant/Pressure reduction/")
ENDINGS = (
    "", ".PV", ".OP", ".SP", ".MODE", ".Status", "_w", " Control Signal", " Set Point", ".POS", " position",
    "CV", "X", ".OUT", " temperature", " level", ".TI", ".AUTO", " speed",
)  # fmt: skip
UNITS = (
    "", " [%]", " [1]", " [degF]", " (°C)", " [K]", " [bar]", " [kPa(g)]", " psig", " [m3/h]", " [t/h]",
    "_gpm", " [mm]", " [m]", " [Nm3/h]", " [mA]", " [s]", " [cmH2O]", " deg F",
)  # fmt: skip


@st.composite
def _values(draw):
    """Values of a column: a course, or a rest, anywhere from a trifle to far beyond a plant; some missing."""
    middle = draw(
        st.sampled_from([0.0, 0.4, 1.28, 12.0, 50.0, 67.0, 300.0, 8e5, -40.0, 27648.0, 1e13, -1e-4])
    )
    span = draw(st.sampled_from([0.0, 0.05, 0.3, 1.0, 40.0, 5000.0]))
    values = middle + span * COURSE * draw(st.sampled_from([1.0, -1.0]))
    if draw(st.booleans()):
        values[draw(st.integers(0, N - 40)) :][:30] = np.nan
    return values


@st.composite
def _tables(draw):
    """A recording's columns, the time somewhere among them."""
    name = st.tuples(*map(st.sampled_from, (PATHS, TAGS, ENDINGS, UNITS))).map("".join)
    names = draw(st.lists(name, min_size=1, max_size=7, unique=True))
    columns = {each: draw(_values()) for each in names}
    time = draw(st.sampled_from(["time", "time_s", "Timestamp", "Time [s]", "t", "elapsed_s"]))
    return dict(draw(st.permutations([(time, np.arange(float(N))), *columns.items()])))


@given(_tables())
@settings(max_examples=300, deadline=None)
def test_a_draft_is_accepted_by_the_reader(columns):
    draft = draft_valve(read_recording_columns(columns, "recording.csv"))
    valve = Valve.from_dict(tomllib.loads(draft.text))
    if valve.roles:
        recording = Recording.from_columns(columns, valve, "recording.csv", "")
        assert set(recording) == set(valve.roles)
    else:
        assert draft.to_fill_in
