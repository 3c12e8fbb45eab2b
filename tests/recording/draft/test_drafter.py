# SPDX-License-Identifier: BSD-3-Clause
"""Drafts are valid, say why, and leave open what neither names nor values tell."""

import tomllib

import numpy as np
import pytest

from sklvalve.recording import InputError, Recording, Valve, read_recording, read_valve, require_diagnosable
from sklvalve.recording.draft import Answers, draft_valve, read_recording_columns
from sklvalve.recording.reader import read_columns

N = 400
TRAVEL = 50.0 + 40.0 * np.sin(np.arange(N) / 15.0)


def _columns(**columns):
    return {
        "time": np.arange(float(N)),
        **{name.replace("__", " "): values for name, values in columns.items()},
    }


def _drafted(columns, **answers):
    draft = draft_valve(read_recording_columns(columns, "recording.csv"), Answers(**answers))
    return draft, Valve.from_dict(tomllib.loads(draft.text))


def _places(valve):
    return {role: signal.column for role, signal in valve.roles.items()}


@pytest.mark.parametrize(
    ("names", "sense"),
    [
        (("CV", "X", "P1", "P2", "T1", "F"), "opening"),
        (("FIC101.OP", "ZT101.PV", "PT101A inlet", "PT101B outlet", "TT101", "FIC101.PV"), "opening"),
        (("Stellgröße", "Ventilhub", "Druck vor", "Druck nach", "Temperatur", "Durchfluss"), "closing"),
        (
            ("Sterowanie", "Położenie", "Ciśnienie przed", "Ciśnienie za", "Temperatura", "Przepływ"),
            "opening",
        ),
        (("Commande", "Position", "Pression amont", "Pression aval", "Température", "Débit"), "closing"),
        (("Mando", "Apertura", "Presión entrada", "Presión salida", "Temperatura", "Caudal"), "opening"),
    ],
)
def test_signals_of_a_valve_by_names_in_five_languages(names, sense):
    shown = TRAVEL if sense == "opening" else 100.0 - TRAVEL
    columns = [shown, shown, np.full(N, 8.1), np.full(N, 3.2), np.full(N, 40.0), 0.3 * TRAVEL]
    draft, valve = _drafted(_columns(**dict(zip(names, columns, strict=True))))
    roles = ("command", "opening", "p1", "p2", "temperature", "flow")
    assert _places(valve) == dict(zip(roles, names, strict=True))
    assert {valve.roles[role].sense for role in ("command", "opening")} == {sense}
    assert valve.roles["p1"].unit == "bar"
    require_diagnosable(
        Recording.from_columns(_columns(**dict(zip(names, columns, strict=True))), valve, "r", "")
    )
    assert any("unit of" in item for item in draft.to_fill_in)


def test_every_line_that_holds_says_why():
    draft, _ = _drafted(_columns(CV=TRAVEL, F=TRAVEL, P1=np.full(N, 800.0), P9=np.full(N, 700.0)))
    for line in draft.text.splitlines():
        assert not line or line.startswith(("#", "[recording.")) or "  # " in line, line


@pytest.mark.parametrize(
    ("values", "unit"),
    [(TRAVEL, "%"), (TRAVEL / 100.0, "1"), (np.full(N, 0.4), "1"), (np.full(N, 40.0), "%")],
)
def test_percent_or_fraction_by_range(values, unit):
    draft, valve = _drafted(_columns(OP=values, F=TRAVEL))
    assert valve.roles["command"].unit == unit
    assert any("percent, or a fraction?" in item for item in draft.to_fill_in) == (values[0] == 0.4)


def test_fractions_called_percent_are_taken_as_they_are():
    draft, valve = _drafted(_columns(**{"OP [%]": TRAVEL / 100.0, "F": TRAVEL}))
    assert valve.roles["command"].unit == "1"
    assert any("although the name says percent" in item for item in draft.to_fill_in)


@pytest.mark.parametrize("name", ["OP", "OP [1]"])
def test_a_command_around_1_3_is_no_fraction(name):
    draft, valve = _drafted(_columns(**{name: 1.28 + 0.05 * np.sin(np.arange(N) / 15.0), "F": TRAVEL}))
    assert valve.roles["command"].unit == "%"
    assert any("are no fraction of travel" in item for item in draft.to_fill_in)


def test_ranks_as_scipy_has_them():
    from scipy.stats import spearmanr

    from sklvalve.recording.draft.evidence import rank_correlation

    rng = np.random.default_rng(5)
    one, other = rng.integers(0, 9, 200).astype(float), rng.normal(size=200)
    other += 0.3 * one
    gone = other.copy()
    gone[::7] = np.nan
    known = np.isfinite(gone)
    assert rank_correlation(one, other) == pytest.approx(spearmanr(one, other).statistic, abs=1e-12)
    assert rank_correlation(one, gone) == pytest.approx(spearmanr(one[known], gone[known]).statistic)
    assert rank_correlation(one, np.ones(200)) is None


@pytest.mark.parametrize(("top", "unit"), [(1.05, "1"), (1.2, "%")])
def test_overrange_of_a_fraction(top, unit):
    _, valve = _drafted(_columns(OP=top * TRAVEL / TRAVEL.max(), F=TRAVEL))
    assert valve.roles["command"].unit == unit


def test_a_command_in_a_unit_of_pressure_is_a_question():
    draft, valve = _drafted(_columns(**{"OP [bar]": 0.2 + TRAVEL / 125.0, "F": TRAVEL}))
    assert "command" not in valve.roles
    assert any("it is in bar, by its name" in item for item in draft.to_fill_in)


def test_signals_of_an_air_handler():
    _, valve = _drafted(
        _columns(
            **{
                "AHU: Heating Coil Valve Control Signal": TRAVEL / 100.0,
                "AHU: Supply Air Temperature [degF]": 67.0 + 0.1 * TRAVEL,
                "AHU: Supply Air Temperature Set Point [degF]": np.full(N, 67.0),
            }
        )
    )
    assert _places(valve)["command"] == "AHU: Heating Coil Valve Control Signal"
    assert valve.roles["temperature"].unit == "degF"
    assert valve.roles["temperature"].to_si([67.0])[0] == pytest.approx(292.594, abs=1e-3)


def test_a_tag_of_modes_and_a_wattage_play_no_role():
    columns = _columns(**{"FIC1.OP": TRAVEL, "FIC1.PV": TRAVEL, "FIC1.MODE": TRAVEL, "power_w": TRAVEL})
    _, valve = _drafted(columns)
    assert _places(valve) == {"command": "FIC1.OP", "flow": "FIC1.PV"}


def test_what_the_reader_would_refuse_is_a_question():
    columns = _columns(OP=TRAVEL, F=TRAVEL, TT7=np.full(N, -900.0), **{"P1 [%]": TRAVEL})
    draft, valve = _drafted(columns)
    assert set(valve.roles) == {"command", "flow"}
    assert any("lie below absolute zero" in item for item in draft.to_fill_in)
    assert any("it is in %, by its name" in item for item in draft.to_fill_in)


def test_raw_counts_are_left_open():
    draft, valve = _drafted(_columns(ZT1=276.48 * TRAVEL, OP=TRAVEL, F=TRAVEL))
    assert "opening" not in valve.roles
    assert "# [recording.opening]" in draft.text
    assert any("raw count" in item for item in draft.to_fill_in)


def test_sense_that_the_values_do_not_tell_is_a_question():
    rng = np.random.default_rng(0)
    draft, valve = _drafted(_columns(OP=TRAVEL, F=rng.uniform(1.0, 9.0, N)))
    assert valve.roles["command"].sense == "opening"
    assert '# sense = "closing"' in draft.text
    assert "[recording.command] sense: does a larger number shut the valve?" in draft.to_fill_in


def test_units_and_gauge_as_named():
    _, valve = _drafted(
        _columns(
            **{
                "OP [%]": TRAVEL,
                "F (t/h)": TRAVEL,
                "P1 [bar(g)]": np.full(N, 8.0),
                "P2_kPa": np.full(N, 300.0),
            }
        )
    )
    assert (valve.roles["p1"].unit, valve.roles["p1"].gauge) == ("bar", True)
    assert (valve.roles["p2"].unit, valve.roles["p2"].gauge) == ("kPa", False)
    assert valve.roles["flow"].unit == "t/h"


def test_pressures_without_a_side_are_told_by_which_is_higher():
    _, valve = _drafted(_columns(OP=TRAVEL, F=TRAVEL, PT7=np.full(N, 300.0), PT9=np.full(N, 800.0)))
    assert _places(valve)["p1"] == "PT9"
    draft, valve = _drafted(_columns(OP=TRAVEL, F=TRAVEL, PT7=np.full(N, 300.0)))
    assert "p1" not in valve.roles
    assert any("before the valve (p1) or behind it (p2)?" in item for item in draft.to_fill_in)


def test_pressures_that_contradict_their_names_are_left_open():
    draft, valve = _drafted(_columns(OP=TRAVEL, F=TRAVEL, P1=np.full(N, 300.0), P2=np.full(N, 800.0)))
    assert not {"p1", "p2"} & valve.roles.keys()
    assert any("p2 lies above p1 in every row" in item for item in draft.to_fill_in)


def test_position_in_mm_needs_the_travel():
    columns = _columns(**{"OP": TRAVEL, "Z [mm]": 0.381 * TRAVEL, "ZT1 [mm]": 0.381 * TRAVEL, "F": TRAVEL})
    draft, valve = _drafted(columns)
    assert "opening" not in valve.roles
    assert any("give the rated travel" in item for item in draft.to_fill_in)
    _, valve = _drafted(columns, travel=38.1)
    assert valve.roles["opening"].unit == "mm"


def test_one_of_several_valves_by_its_tag():
    columns = {}
    for loop in ("101", "102"):
        columns |= {f"FIC{loop}.OP": TRAVEL, f"FIC{loop}.PV": TRAVEL, f"FIC{loop}.SP": TRAVEL}
    for tag, loop in ((None, "101"), ("102", "102")):
        _, valve = _drafted(_columns(**columns), tag=tag)
        assert set(_places(valve).values()) == {f"FIC{loop}.{end}" for end in ("OP", "PV", "SP")}
    assert valve.tag == "102"


def test_loop_that_controls_no_flow():
    _, valve = _drafted(_columns(**{"LIC7.OP": TRAVEL, "LIC7.PV": TRAVEL, "LIC7.SP": TRAVEL}))
    assert set(valve.roles) == {"command", "process_value", "setpoint"}


def test_answers_go_before_guesses():
    columns = _columns(A=TRAVEL, B=0.2 * TRAVEL, FT9=TRAVEL)
    _, valve = _drafted(
        columns, roles={"A": "command", "B": "flow", "FT9": None}, units={"B": "l/min"}, tag="FV-9",
        kv_rated=25.0, characteristic="equal_percentage", rangeability=50.0,
    )  # fmt: skip
    assert _places(valve) == {"command": "A", "flow": "B"}
    assert valve.roles["flow"].unit == "l/min"
    assert (valve.tag, valve.kv_rated, valve.characteristic) == ("FV-9", 25.0, "equal_percentage")


def test_names_that_would_spoil_a_file_are_written_safely():
    name = 'F "1" \\ # [m3/h]\x7f'
    draft, valve = _drafted(_columns(OP=TRAVEL, **{name: TRAVEL}), roles={name: "flow"})
    assert _places(valve)["flow"] == name
    assert "\x7f" not in draft.text


def test_nothing_known_is_still_a_file_that_says_what_to_do():
    draft, valve = _drafted(_columns(alpha=TRAVEL, beta=TRAVEL))
    assert valve.roles == {}
    assert any("which column is the command" in item for item in draft.to_fill_in)


def test_time_column():
    columns = _columns(OP=TRAVEL, F=TRAVEL)
    times = columns.pop("time")
    assert _drafted(columns | {"t_s": times})[1].time == "t_s"
    assert _drafted(columns | {"time_s": times})[1].time == "time_s"
    assert _drafted({"stamp": times} | columns)[1].time == "stamp"
    told = read_recording_columns(columns | {"a": times, "time": times}, "recording.csv", "A")
    assert (told.time, "time" in [column.name for column in told.columns]) == ("a", True)
    with pytest.raises(InputError, match=r"--time-column b: recording.csv has no such column"):
        read_recording_columns(columns | {"time": times}, "recording.csv", "b")
    with pytest.raises(InputError, match="'time_min' does not count seconds, by its name"):
        _drafted(columns | {"time_min": times})
    with pytest.raises(InputError, match="part runs put one behind the other by sklvalve import"):
        _drafted(columns | {"time_s": np.tile(times[: N // 2], 2)})
    with pytest.raises(
        InputError, match="no column is named time, and the first, 'OP', holds no rising times"
    ):
        _drafted(columns)
    with pytest.raises(InputError, match=r"column 'time' \(time\), row 2: time 0 stands twice"):
        _drafted(columns | {"time": np.zeros(N)})
    with pytest.raises(InputError, match="no column but the time holds numbers"):
        _drafted({"time": times, "mode": np.full(N, "AUTO", dtype=object)})


@pytest.mark.parametrize(
    "name", ["backlash", "nothing_noisy", "clogging", "stiction", "in_no_catalogue", "nothing_closed_loop"]
)
def test_concealed_recordings_are_drafted_as_their_makers_wrote(data_folder, name):
    folder = data_folder / "concealed" / name
    path = folder / "recording.csv.gz"
    draft, valve = _drafted(read_columns(path).columns)
    assert {role: valve.roles[role] for role in read_valve(folder / "valve.toml").roles} == read_valve(
        folder / "valve.toml"
    ).roles
    assert valve.roles.keys() - read_valve(folder / "valve.toml").roles.keys() <= {"setpoint"}
    require_diagnosable(read_recording(path, valve))
    assert draft.to_fill_in


@pytest.mark.parametrize("tag", ["A1", "C1", "C3"])
def test_valves_of_a_water_network(data_folder, tag):
    path = data_folder / "watersafe" / "recording.csv"
    draft, valve = _drafted(read_columns(path).columns, tag=tag)
    assert _places(valve) == {"command": f"VA_{tag}", "flow": f"FS_{tag}"}
    assert (valve.time, valve.roles["command"].unit) == ("t_s", "1")
    assert any("'PS_A2'" in item for item in draft.to_fill_in)
    require_diagnosable(read_recording(path, valve))


def test_an_hour_of_a_sugar_plant(data_folder):
    path = data_folder / "damadics" / "actuator3_real_one_hour.csv"
    _, valve = _drafted(read_columns(path).columns)
    assert _places(valve)["p2"] == "P74_01_kPa"
    assert {valve.roles[role].sense for role in ("command", "opening")} == {"closing"}
    require_diagnosable(read_recording(path, valve))
