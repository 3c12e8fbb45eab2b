# SPDX-License-Identifier: BSD-3-Clause
"""What no diagnosis can follow is refused in one sentence, and a healthy recording never."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.recording import (
    InputError,
    Recording,
    Valve,
    read_recording,
    require_diagnosable,
    screen_recording,
)
from tests.recording.planted import ROLES

N = 300


def healthy(seed=0, n=N):
    """Columns of a valve that is moved in steps, with a noise of every sensor."""
    rng = np.random.default_rng(seed)
    command = np.repeat(rng.uniform(10.0, 90.0, n // 20 + 1), 20)[:n]
    late = np.concatenate([command[:3], command[:-3]])
    p1, p2 = 600.0 + rng.normal(0.0, 5.0, n), 200.0 + rng.normal(0.0, 5.0, n)
    return {
        "time": np.arange(float(n)),
        "CV": command,
        "X": late + rng.normal(0.0, 0.2, n),
        "P1": p1,
        "P2": p2,
        "T": 20.0 + rng.normal(0.0, 0.5, n),
        "F": 0.4 * late * np.sqrt((p1 - p2) / 100.0) + rng.normal(0.0, 0.1, n),
    }


def made(sheet=None, roles=None, **columns):
    """The healthy recording with some columns, roles (None takes one out) and sections changed."""
    named = {role: section for role, section in (ROLES | (roles or {})).items() if section is not None}
    valve = Valve.from_dict({"recording": named, **(sheet or {})}, source="valve.toml")
    return Recording.from_frame(healthy() | columns, valve)


def sentence_for(recording):
    with pytest.raises(InputError) as caught:
        require_diagnosable(recording)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


def rows_only(name, rows):
    values = np.full(N, np.nan)
    values[rows] = healthy()[name][rows]
    return values


@given(seed=st.integers(0, 10_000), n=st.integers(120, 400))
@settings(deadline=None, max_examples=40)
def test_healthy_recording_passes(seed, n):
    columns = healthy(seed, n)
    valve = Valve.from_dict({"recording": ROLES})
    require_diagnosable(Recording.from_frame(columns, valve))
    without = {role: section for role, section in ROLES.items() if role != "opening"}
    require_diagnosable(Recording.from_frame(columns, Valve.from_dict({"recording": without})))


SHEETS = {
    "gas by molar mass": ({"fluid": {"name": "air", "molar_mass": 29.0}}, "molar_mass says that a gas flows"),
    "gas by its ratio": ({"fluid": {"heat_capacity_ratio": 1.4}}, "heat_capacity_ratio says that a gas"),
    "gas by density": (
        {"fluid": {"name": "air", "density": 1.2}},
        "density is 1.2 kg/m3, which is that of a",
    ),
    "no positioner": ({"actuator": {"positioner": False}}, "positioner = false"),
    "other physics": ({"simulation": {"physics": ["choked_flow", "backlash"]}}, "names 'backlash', which"),
}


@pytest.mark.parametrize(("sheet", "words"), SHEETS.values(), ids=SHEETS)
def test_sheet_that_would_be_ignored(sheet, words):
    sentence = sentence_for(made(sheet))
    assert sentence.startswith("valve.toml: [")
    assert words in sentence


@pytest.mark.parametrize("role", ["simulated_flow", "simulated_opening"])
def test_simulation_of_ones_own(role):
    told = ROLES[role.removeprefix("simulated_")]
    require_diagnosable(made(roles={role: told | {"column": "SIM"}}, SIM=healthy()[told["column"]]))


def test_sheet_that_is_used_or_does_no_harm():
    sizes = {"nominal_size": 50.0, "inlet_pipe": 80.0, "outlet_pipe": 80.0, "fd": 0.46, "xt": 0.7}
    actuator = {"positioner": True, "effective_area": 290.0}
    fluid = {"name": "oil", "density": 870.0}
    sheet = {"valve": sizes, "actuator": actuator, "fluid": fluid, "simulation": {"physics": ["choked_flow"]}}
    require_diagnosable(made(sheet))


GOOD = healthy()
MISTAKEN = {
    "opening of the other sense": ({"X": 100.0 - GOOD["X"]}, ["'X' (opening) falls", 'sense = "closing"']),
    "command of the other sense": (
        {"CV": 100.0 - GOOD["CV"]},
        ["'X' (opening) falls", "[recording.command]"],
    ),
    "opening as fraction": ({"X": GOOD["X"] / 100.0}, ["'X' (opening)", 'unit = "1" in [recording.opening]']),
    "command as fraction": ({"CV": GOOD["CV"] / 100.0}, ["'CV' (command)", 'unit = "1"']),
    "negated flow": ({"F": -GOOD["F"]}, ["'F' (flow) is negative in 100 %", "although p1 lies above p2"]),
    "no flow at all": ({"F": np.zeros(N)}, ["'F' (flow) never shows any flow"]),
    "next to no flow": ({"F": GOOD["F"] * 1e-300}, ["'F' (flow) never shows any flow"]),
    "giant flow": ({"F": GOOD["F"] * 1e300}, ["'F' (flow), row 1", "far beyond any plant"]),
    "giant pressure": (
        {"P1": np.where(np.arange(N) == 7, 1e12, 600.0)},
        ["'P1' (p1), row 8: 1e+12 kPa is far beyond"],
    ),
    "steam": ({"T": np.full(N, 500.0)}, ["'T' (temperature) lies around 500 degC", "('degC')"]),
    "deep cold": ({"T": np.full(N, -200.0)}, ["'T' (temperature) lies around -200 degC"]),
    "steam under pressure": (
        {"T": np.full(N, 190.0)},
        ["'T' (temperature) lies around 190 degC, where water boils, for p1 in the middle is"],
    ),
    "no pressure drop": ({"P2": GOOD["P1"]}, ["'P1' (p1): p1 is nowhere above p2"]),
    "held command": ({"CV": np.full(N, 50.0)}, ["'CV' (command) holds one value, 50 %"]),
    "frozen opening": ({"X": np.full(N, 50.0)}, ["'X' (opening) holds one value, 50 %"]),
    "frozen flow": ({"F": np.full(N, 5.0)}, ["'F' (flow) holds one value, 5 m3/h"]),
    "few flows": (
        {"F": rows_only("F", slice(0, 300, 30))},
        ["'F' (flow): only 10 of 300 rows", "at least 40"],
    ),
    "flow in one corner": (
        {"F": rows_only("F", slice(0, 60))},
        ["'F' (flow): nearly all rows", "one quarter"],
    ),
    "never together": (
        {"X": rows_only("X", slice(0, 150)), "F": rows_only("F", slice(150, 300))},
        ["'F' (flow): only 0 of 300 rows hold it together with opening, p1, p2"],
    ),
    "pressures never together": (
        {"P1": rows_only("P1", slice(0, 150)), "P2": rows_only("P2", slice(150, 300))},
        ["'P1' (p1): no row holds it together with p2"],
    ),
}


@pytest.mark.parametrize(("columns", "words"), MISTAKEN.values(), ids=MISTAKEN)
def test_signals_that_lead_nowhere(columns, words):
    sentence = sentence_for(made(**columns))
    assert sentence.startswith("data frame: column ")
    assert all(word in sentence for word in words), sentence


def test_negated_flow_without_pressures():
    assert "is negative" in sentence_for(made(roles={"p1": None, "p2": None}, F=-GOOD["F"]))


def test_the_first_sentence_about_rows_names_what_a_diagnosis_needs():
    for rows in (20, 60, 119):
        assert sentence_for(made().slice(0, rows)).endswith(
            f"{rows} rows are too few for a diagnosis; give at least 120"
        )
    require_diagnosable(made().slice(0, 120))


def test_rows_in_which_a_signal_is_absent():
    recording = made(T=rows_only("T", slice(200, 300)))
    require_diagnosable(recording)
    assert "'T' (temperature) holds no value in the 150 rows" in sentence_for(recording.slice(0, 150))


def test_hot_liquid_with_properties_of_its_own():
    fluid = {"name": "salt", "density": 1800.0, "vapour_pressure": 0.1}
    require_diagnosable(made({"fluid": fluid}, T=np.full(N, 500.0)))


def test_vapour_pressure_above_the_inlet():
    for pressure in (2339.0, 650.0):
        with pytest.raises(InputError, match=r"^valve.toml: \[fluid\] vapour_pressure = .* p1 lies around"):
            made({"fluid": {"vapour_pressure": pressure}})
    # a few rows at start and stop do no harm, and a liquid near boiling is one
    require_diagnosable(made({"fluid": {"vapour_pressure": 580.0}}))
    require_diagnosable(made({"fluid": {"vapour_pressure": 2.0}}, P1=np.where(np.arange(N) < 90, 1.0, 600.0)))


def test_critical_pressure_below_that_of_the_liquid_at_hand():
    sentence = sentence_for(made({"fluid": {"critical_pressure": 220.64}}, T=np.full(N, 150.0)))
    assert "where water boils, for [fluid] critical_pressure is 220.6 kPa" in sentence


def test_single_glitch_of_temperature_or_flow_passes():
    require_diagnosable(
        made(T=np.where(np.arange(N) == 5, 800.0, GOOD["T"]), F=np.where(np.arange(N) == 5, -3.0, GOOD["F"]))
    )


def test_opening_half_a_period_late_is_not_of_the_other_sense():
    time = np.arange(float(N))
    command = 50.0 + 30.0 * np.sin(time / 6.0)
    opening = 50.0 + 30.0 * np.sin((time - 6.0 * np.pi) / 6.0)
    opening[:19] = 50.0
    assert np.corrcoef(command, opening)[0, 1] < -0.9
    require_diagnosable(made(CV=command, X=opening))


def test_constant_roles_are_named_by_their_section():
    roles = {"p1": {"constant": 200.0, "unit": "kPa"}, "p2": {"constant": 200.0, "unit": "kPa"}}
    assert sentence_for(made(roles=roles)).startswith("valve.toml: [recording.p1]: p1 is nowhere above p2")


@pytest.mark.parametrize("file", ["recording", "later"])
def test_concealed_recordings_pass(data_folder, file):
    folders = sorted((data_folder / "concealed").iterdir())
    assert len(folders) == 12
    for folder in folders:
        require_diagnosable(read_recording(folder / f"{file}.csv.gz", folder / "valve.toml"))


@pytest.mark.parametrize("tag", ["VA_A1", "VA_C1", "VA_C3"])
def test_water_network_passes(data_folder, tag):
    folder = data_folder / "watersafe"
    recording = read_recording(folder / "recording.csv", folder / f"{tag}.toml")
    require_diagnosable(recording)
    require_diagnosable(recording.until(6000.0))


def test_screening_goes_on_where_the_diagnosis_refuses():
    found = screen_recording(made(X=100.0 - GOOD["X"], CV=GOOD["CV"]))
    assert ("unit_suspect", "opening") in {(each["finding"], each["role"]) for each in found}
