# SPDX-License-Identifier: BSD-3-Clause
import csv
import json
import os
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.cli.predict import _not_yet
from sklvalve.metrics import err_max, mape, rmse
from sklvalve.recording import Recording
from tests.cli import stand_in

MODEL = "out/corrected_model.skops"
PREDICT = ["predict", "later.csv", "--model", MODEL, "--out", "predictions.csv"]


@pytest.fixture
def later(folder):
    """Write a recording to predict, after a diagnosis, with columns changed (None: left out)."""
    assert main(["diagnose", "recording.csv", "--valve", "valve.toml", "--out", "out"]) == 0

    def write(**changes):
        table = stand_in.columns() | changes
        table = {name: values for name, values in table.items() if values is not None}
        (folder / "later.csv").write_text(stand_in.csv_text(table))

    return write


def _read():
    with open("predictions.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def test_columns_in_the_recordings_own_units_and_times(later):
    later()
    assert main(PREDICT) == 0
    table = _read()
    assert list(table) == ["time", "opening", "flow", "flow_from_command"]
    made = stand_in.columns()
    assert [float(time) for time in table["time"]] == list(made["t"])
    np.testing.assert_allclose([float(x) for x in table["opening"]], made["X"], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose([float(x) for x in table["flow"]], 0.36 * made["X"], rtol=1e-6, atol=1e-9)


def test_nominal_leaves_the_found_effects_out(later):
    later()
    assert main([*PREDICT, "--nominal"]) == 0
    assert float(_read()["flow"][-1]) == pytest.approx(28.8, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("empty", [None, np.full(40, np.nan)], ids=["absent", "empty"])
def test_file_without_flow_and_opening_is_predicted_in_the_models_units(later, empty):
    later(F=empty, X=empty)
    assert main(PREDICT) == 0
    table = _read()
    assert float(table["flow"][-1]) == pytest.approx(36.0, rel=1e-6)
    assert float(table["opening"][20]) == pytest.approx(stand_in.columns()["X"][20], rel=1e-6)


def test_file_without_command_gives_what_the_opening_allows(later):
    later(CV=None)
    assert main(PREDICT) == 0
    assert list(_read()) == ["time", "flow"]


def test_gaps_are_empty_cells(later):
    travel = stand_in.columns()["X"]
    travel[7] = np.nan
    later(X=travel)
    assert main(PREDICT) == 0
    table = _read()
    assert table["flow"][7] == ""
    assert table["flow_from_command"][7] != ""


def test_iso_times_are_kept_as_they_are(later):
    stamps = [f"2024-06-28T14:35:{second:02d}" for second in range(40)]
    later(t=stamps)
    assert main(PREDICT) == 0
    assert _read()["time"] == stamps


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "words"),
    [({"P1": None}, "'P1' for p1"), ({"CV": None, "X": None}, "'CV' for command"), ({"t": None}, "the time")],
)
def test_needed_columns_are_asked_for(later, capsys, changes, words):
    later(**changes)
    capsys.readouterr()
    assert main(PREDICT) == 2
    shown = capsys.readouterr().err
    assert words in shown
    assert shown.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["later.csv", "out/../later.csv"])
def test_inputs_are_not_overwritten(later, folder, capsys, name):
    later()
    before = (folder / "later.csv").read_text()
    assert main([*PREDICT[:-1], name]) == 2
    assert "an input of the same command" in capsys.readouterr().err
    assert (folder / "later.csv").read_text() == before


def test_flow_by_mass_stays_by_mass(folder):
    valve = stand_in.VALVE.replace('"m3/h"', '"kg/h"')
    (folder / "valve.toml").write_text(valve)
    assert main(["diagnose", "recording.csv", "--valve", "valve.toml", "--out", "out"]) == 0
    table = stand_in.columns()
    del table["F"]
    (folder / "later.csv").write_text(stand_in.csv_text(table))
    assert main(PREDICT) == 0
    assert float(_read()["flow"][-1]) == pytest.approx(36.0, rel=1e-6)  # 0.01 kg/s at full travel


@pytest.mark.parametrize(
    ("pressure", "words"),
    [(1e300, "'P1' (p1), row 1: 1e+300 kPa is far beyond any plant"), (50.0, "p2 lies above p1")],
)
def test_pressures_of_no_plant(later, capsys, pressure, words):
    later(P1=np.full(40, pressure))
    capsys.readouterr()
    assert main(PREDICT) == 2
    assert words in capsys.readouterr().err
    assert not os.path.exists("predictions.csv")


def test_water_that_boils_is_not_predicted(later, capsys):
    valve = stand_in.VALVE + '[recording.temperature]\ncolumn = "T"\nunit = "degC"\n'
    with open("valve.toml", "w", encoding="utf-8") as file:
        file.write(valve)
    with open("recording.csv", "w", encoding="utf-8") as file:
        file.write(stand_in.csv_text(stand_in.columns(160) | {"T": np.full(160, 20.0)}))
    assert main(["diagnose", "recording.csv", "--valve", "valve.toml", "--out", "out"]) == 0
    later(T=np.full(40, 20.0))
    assert main(PREDICT) == 0
    later(T=np.full(40, 190.0))
    capsys.readouterr()
    assert main(PREDICT) == 2
    assert "where water boils, for p1" in capsys.readouterr().err


def test_the_error_against_the_recorded_flow_is_printed(later, capsys):
    flow = 0.36 * stand_in.columns()["X"] + np.where(np.arange(40) % 2, 0.36, 0.0)
    flow[3] = np.nan
    later(F=flow)
    capsys.readouterr()
    assert main(PREDICT) == 0
    words = capsys.readouterr().out.splitlines()[1]
    made = np.array([float(value) for value in _read()["flow"]])
    rows = np.isfinite(flow)
    figures = [f"{metric(flow[rows], made[rows]):.3g}" for metric in (rmse, mape, err_max)]
    assert words.startswith(
        f"Against the recorded flow (39 rows): RMSE {figures[0]} m3/h, MAPE {figures[1]} %, "
        f"Err_max {figures[2]} % of the recorded value; "
    )
    span = np.quantile(flow[rows], 0.995)
    figures = [f"{metric(flow[rows], made[rows], span=span):.3g} %" for metric in (rmse, mape, err_max)]
    assert words.endswith(f"; {', '.join(figures)} of the span of {span:.3g} m3/h.")


def test_the_error_in_json(later, capsys):
    later(F=0.36 * stand_in.columns()["X"])
    capsys.readouterr()
    assert main([*PREDICT, "--nominal", "--json"]) == 0
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["rows"] == 40
    assert error["unit"] == "m3/h"
    assert error["mape"] == pytest.approx(20.0)
    assert error["err_max"] == pytest.approx(20.0)
    assert error["of_span"]["err_max"] == pytest.approx(20.0, rel=0.02)


@pytest.mark.parametrize("empty", [None, np.full(40, np.nan)], ids=["absent", "empty"])
def test_without_a_recorded_flow_no_error_is_told(later, capsys, empty):
    later(F=empty)
    capsys.readouterr()
    assert main(PREDICT) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1
    assert main([*PREDICT, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error"] is None


def test_a_flow_of_nothing_has_no_percentages(later, capsys):
    later(F=np.zeros(40))
    capsys.readouterr()
    assert main(PREDICT) == 0
    words = capsys.readouterr().out.splitlines()[1]
    assert words.startswith("Against the recorded flow (40 rows): RMSE ")
    assert words.endswith(" m3/h.")


def test_an_effect_that_is_yet_to_begin_is_told():
    recording = Recording.from_frame({"time": np.arange(50.0), "command": np.linspace(0.0, 1.0, 50)})
    effect = SimpleNamespace(key="leak", name="seat_leakage")
    told = _not_yet(SimpleNamespace(effects=[effect], onsets={"leak": 20.0}), recording)
    assert told == [
        "Seat leakage begins later: 20 of these 50 rows are before it, by the clock of the diagnosed "
        "recording."
    ]
    assert _not_yet(SimpleNamespace(effects=[effect], onsets={"leak": -5.0}), recording) == []
    assert _not_yet(SimpleNamespace(effects=[effect], onsets=None), recording) == []
