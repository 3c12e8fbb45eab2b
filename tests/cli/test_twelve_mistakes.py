# SPDX-License-Identifier: BSD-3-Clause
"""Mistakes that people make, each through the command line: one sentence says what came and what to do.

All but two are refused, and leave nothing behind; those of a unit that only the physics shows end with a
report, whose finding is that sentence.
"""

import json
import shlex
import sys
from typing import NamedTuple

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.datasets import make_valve_recording
from sklvalve.datasets.concealed import to_toml
from tests.cli import stand_in
from tests.cli.refusal import refused

VALVE = stand_in.VALVE
ROWS = 160


def _table(**changes):
    table = stand_in.columns(ROWS)
    for name, change in changes.items():
        table[name] = [change(value) for value in table[name]]
    return stand_in.csv_text(table)


CSV = _table()


class Mistake(NamedTuple):
    """What stands in the files, the words after ``sklvalve``, and what the sentence must hold."""

    told: str
    words: str = "diagnose recording.csv"
    recording: str | bytes = CSV
    valve: str | None = VALVE
    name: str = "recording.csv"


def _without_time(text):
    return "\n".join(line.split(",", 1)[1] for line in text.splitlines())


MISTAKES = {
    "wrong path": Mistake(
        "recordng.csv: no such file; did you mean 'recording.csv'?", "diagnose recordng.csv"
    ),
    "a folder for a file": Mistake(".: this is a folder; give the file of the recording", "diagnose ."),
    "an Excel workbook": Mistake(
        "the file is a workbook or zip archive, not text; export the table as CSV",
        recording=b"PK\x03\x04rest",
    ),
    "no time column": Mistake(
        "there is no column 't' for the time; correct time in [recording]: the columns are CV, X, F, P1",
        recording=_without_time(CSV),
    ),
    "no time column and no valve.toml": Mistake(
        "no column is named time, and the first, 'CV', holds no rising times; make it a recording by",
        recording=_without_time(CSV),
        valve=None,
    ),
    "unknown column in valve.toml": Mistake(
        "there is no column 'FLOW' for flow; correct column in [recording.flow]: the columns are t, CV, X, F",
        valve=VALVE.replace('column = "F"', 'column = "FLOW"'),
    ),
    "pressure of kPa called Pa": Mistake(
        "p2 lies above p1 in every row, by 99.5 kPa in the middle; swap [recording.p1] and [recording.p2], "
        "or check their units and gauge",
        valve=VALVE.replace('column = "P1"\nunit = "kPa"', 'column = "P1"\nunit = "Pa"'),
    ),
    "fraction called percent": Mistake(
        "column 'X' (opening) runs from 0 to 1 in unit '%', by which the valve would hardly move; write "
        'unit = "1" in [recording.opening]',
        recording=_table(X=lambda x: 0.01 * x),
    ),
    "percent called fraction": Mistake(
        "values from 0 to 100 are no opening in unit '1'; is the unit '%', or the column another one?",
        valve=VALVE.replace('column = "X"\nunit = "%"', 'column = "X"\nunit = "1"'),
    ),
    "decimal commas and semicolons": Mistake(
        "the columns are separated by semicolons; separate them by commas, decimals by points, or run "
        "sklvalve import",
        recording=CSV.replace(",", ";").replace(".", ","),
    ),
    "decimal commas among commas": Mistake(
        "the table is uneven: line 1 names 5 columns, the lines below it hold more; give every row 5 cells, "
        "and write decimals with a point",
        recording=CSV.replace(".", ","),
    ),
    "decimal commas in quotes": Mistake(
        "column 'F' (flow), row 1: '0,0' is no number; write decimals with a point, or run sklvalve import",
        recording=_table(F=lambda f: f'"{f}"'.replace(".", ",")),
    ),
    "lines above the names": Mistake(
        "put the names of the columns into the first line, separated by commas, with nothing above them, or "
        "run sklvalve import",
        recording="Export of June\n" + CSV,
    ),
    "a historian's export as it is": Mistake(
        "or run sklvalve import, which reads such files",
        recording="Tag;Time;Value\nFIC1.PV;28.06.2024 14:35:01;1,5\nFIC1.PV;28.06.2024 14:35:02;1,5\n",
        valve=None,
    ),
    "percent of closing": Mistake(
        'falls where the command rises (correlation -1.00); write sense = "closing" in [recording.opening]',
        recording=_table(X=lambda x: 100.0 - x),
    ),
    "no valve.toml and no names that tell": Mistake(
        "there is no valve.toml, and the columns' names ('a', 'b', 'c', 'd') tell neither command, opening "
        "nor flow; run sklvalve init recording.csv, which asks",
        recording=CSV.replace("t,CV,X,F,P1", "time,a,b,c,d"),
        valve=None,
    ),
    "valve.toml not there": Mistake("valve.tml: no such file", "diagnose recording.csv --valve valve.tml"),
    "p2 above p1": Mistake("p2 lies above p1 in every row", recording=_table(P1=lambda p: 50.0)),
    "too few rows": Mistake(
        "59 rows are too few for a diagnosis; give at least 120", recording="\n".join(CSV.splitlines()[:60])
    ),
    "misspelt key": Mistake(
        "[valve] knows no key 'kv_rate'; did you mean 'kv_rated'?",
        valve=VALVE.replace("tag =", "kv_rate = 9\ntag ="),
    ),
    "misspelt section": Mistake(
        "[valv] is no known section; did you mean 'valve'?", valve=VALVE.replace("[valve]", "[valv]")
    ),
    "misspelt unit": Mistake(
        "unit = 'm3/hr' is no known unit of this role; did you mean 'm3/h'?",
        valve=VALVE.replace("m3/h", "m3/hr"),
    ),
    "no quotes in valve.toml": Mistake(
        "no valid TOML (Invalid value); correct that line: texts stand in quotes",
        valve=VALVE.replace('"m3/h"', "m3/h"),
    ),
    "damaged Parquet": Mistake(
        "the file is not whole Parquet data; write or copy it again",
        "diagnose recording.parquet",
        b"PAR1xxxx",
        name="recording.parquet",
    ),
    "time runs backwards": Mistake(
        "column 't', row 2: time 258 comes after 259; sort the rows by time",
        recording=_table(t=lambda t: 359.0 - t),
    ),
    "day before month": Mistake(
        "'28/06/2024 10:00' is no time; write seconds, or ISO 8601 such as 2024-06-28T14:35:00",
        recording=_table(t=lambda t: "28/06/2024 10:00"),
    ),
    "nothing but gaps": Mistake(
        "column 'F' (flow): there is no value in it, only gaps; name another column or leave the role out",
        recording=_table(F=lambda f: np.nan),
    ),
    "texts among the numbers": Mistake(
        "column 'F' (flow), row 1: 'Bad' is no number; correct it, leave the cell empty",
        recording=_table(F=lambda f: f or "Bad"),
    ),
    "model file that is no model": Mistake(
        "valve.toml: this is no model file of sklvalve; give the corrected_model.skops that a diagnosis",
        "predict recording.csv --model valve.toml --out predictions.csv",
    ),
    "output folder is a file": Mistake(
        "--out valve.toml: valve.toml is a file; name a folder", "diagnose recording.csv --out valve.toml"
    ),
    "recording and valve.toml exchanged": Mistake(
        "recording.csv: this is named as a recording is; give the valve.toml",
        "diagnose valve.toml --valve recording.csv",
    ),
    "misspelt command": Mistake("invalid choice: 'diagnos' (choose from", "diagnos recording.csv"),
    "misspelt option": Mistake("unrecognized arguments: --vavle", "diagnose recording.csv --vavle v.toml"),
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, the current one; what a diagnosis needs is installed."""
    for module in ("pandas", "jinja2", "matplotlib", "skops"):
        pytest.importorskip(module, reason='needs pip install "sklvalve[all]"')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")  # a fault of the package fails a test as what it is
    return tmp_path


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES)
def test_one_sentence_and_nothing_written(here, capsys, mistake):
    content = mistake.recording
    (here / mistake.name).write_bytes(content if isinstance(content, bytes) else content.encode())
    if mistake.valve is not None:
        (here / "valve.toml").write_text(mistake.valve)
    refused(shlex.split(mistake.words), mistake.told, capsys)


def test_parquet_without_pyarrow(here, capsys, monkeypatch):
    (here / "recording.parquet").write_bytes(b"PAR1 and more PAR1")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    words = 'reading .parquet needs pyarrow: pip install "sklvalve[io]"'
    refused(["diagnose", "recording.parquet"], words, capsys)


@pytest.fixture(scope="module")
def recorded():
    """A recording of a valve whose data sheet is known."""
    return make_valve_recording(None, loop="wide", n_samples=1500, n_later=0, random_state=2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (('"kPa"', '"MPa"'), "times what the sheet's trim passes at every opening"),
        (('"m3/h"', '"m3/s"'), "times the rated capacity"),
    ],
    ids=["pressures wrong by 1000", "flow wrong by 3600"],
)
def test_unit_that_only_the_physics_shows_is_the_finding(here, capsys, recorded, wrong, told):
    recorded.frame.to_csv("recording.csv", index=False)
    (here / "valve.toml").write_text(to_toml(recorded.valve).replace(*wrong))
    assert main(["diagnose", "recording.csv", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] == "cannot_tell"
    assert found["effects"] == []
    assert told in found["next_test"]
    assert "check the units of flow and pressures" in found["next_test"]
    assert "Correct the columns in valve.toml first" in (here / "results/report.html").read_text()
